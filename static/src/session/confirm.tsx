// A button that asks once more before it does what cannot be undone.

import { useSignal } from "@preact/signals";
import type { ComponentChildren, JSX } from "preact";
import { useRef } from "preact/hooks";

interface Props {
  name: string;
  question: ComponentChildren;
  /** What the second press is called. */
  doIt: string;
  press: () => Promise<unknown>;
  failed: (error: unknown) => void;
}

const takeFocus = (button: HTMLElement | null) => button?.focus();

export function Confirm({ name, question, doIt, press, failed }: Props): JSX.Element {
  const isAsked = useSignal(false);
  const isBusy = useSignal(false);
  const first = useRef<HTMLButtonElement>(null);
  if (!isAsked.value)
    return (
      <button ref={first} type="button" onClick={() => (isAsked.value = true)}>
        {name}
      </button>
    );
  const leave = () => {
    isAsked.value = false;
    isBusy.value = false;
    window.setTimeout(() => first.current?.focus());
  };
  const go = () => {
    isBusy.value = true;
    void press().catch(failed).then(leave);
  };
  return (
    <div
      class="confirm"
      role="group"
      aria-label={name}
      onKeyDown={(event) => event.key === "Escape" && leave()}
    >
      <span>{question}</span>
      <button ref={takeFocus} type="button" class="primary" disabled={isBusy.value} onClick={go}>
        {doIt}
      </button>
      <button type="button" onClick={leave}>
        Cancel
      </button>
    </div>
  );
}
