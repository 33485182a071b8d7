// A command to copy.

import type { JSX } from "preact";
import { CopyButton } from "./copy";

export function Code({ text }: { text: string }): JSX.Element {
  return (
    <div class="command">
      <pre tabIndex={0}>{text}</pre>
      <CopyButton text={text} />
    </div>
  );
}
