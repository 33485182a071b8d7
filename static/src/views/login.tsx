// The way in, where the service asks for a key.

import { useSignal } from "@preact/signals";
import type { JSX, TargetedEvent } from "preact";
import { logIn } from "../api/door";
import { ProblemBox } from "../components/basics";
import { noteSignedIn } from "../state/door";

export function Login(): JSX.Element {
  const error = useSignal<unknown>(undefined);
  const isBusy = useSignal(false);
  const go = async (event: TargetedEvent<HTMLFormElement>) => {
    event.preventDefault();
    const key = new FormData(event.currentTarget).get("key");
    isBusy.value = true;
    try {
      await logIn(String(key));
      noteSignedIn(true);
    } catch (failure) {
      error.value = failure;
    }
    isBusy.value = false;
  };
  return (
    <form class="panel login" onSubmit={(event) => void go(event)}>
      <h1>Sign in</h1>
      <p>This service asks for a key. Whoever runs it makes one with</p>
      <pre class="mono">trackloom keys add NAME --allow read,jobs</pre>
      <label>
        Key
        <input name="key" type="password" autocomplete="current-password" required />
      </label>
      {error.value ? <ProblemBox error={error.value} /> : null}
      <button type="submit" class="primary" disabled={isBusy.value}>
        Sign in
      </button>
    </form>
  );
}
