// Whether the service lets this page in. Most services ask for no key; then nothing of this shows.

import { signal } from "@preact/signals";

const STORAGE_KEY = "trackloom.signedIn";

/** An answer said that a key is needed. */
export const isShut = signal(false);
/** A key was given on this page: it lies in a cookie that no script reads. */
export const isSignedIn = signal(wasSignedIn());

function wasSignedIn(): boolean {
  try {
    return localStorage.getItem(STORAGE_KEY) !== null;
  } catch {
    return false;
  }
}

export function noteSignedIn(isIn: boolean): void {
  isSignedIn.value = isIn;
  isShut.value = !isIn;
  try {
    if (isIn) localStorage.setItem(STORAGE_KEY, "yes");
    else localStorage.removeItem(STORAGE_KEY);
  } catch {
    // Without storage only the button to sign out is missing.
  }
}
