// A button that puts a text on the clipboard, where the browser allows that.

import { useSignal } from "@preact/signals";
import type { JSX } from "preact";

export function CopyButton({ text }: { text: string }): JSX.Element {
  const label = useSignal("Copy");
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(text);
      label.value = "Copied";
    } catch {
      label.value = "Copying is not allowed here";
    }
  };
  return (
    <button type="button" class="quiet" onClick={() => void copy()}>
      {label.value}
    </button>
  );
}
