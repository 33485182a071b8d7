// The address is the state: view, job, clock, selection, filters and theme are query parameters, so
// that a copied link shows what its sender saw. Nothing here knows what the parameters mean.

import { signal } from "@preact/signals";

type Patch = Record<string, string | number | null | undefined>;

/** Job objects link to `/jobs/{id}`; here that is the job page. */
function atStart(): URLSearchParams {
  const start = new URLSearchParams(location.search);
  const job = /^\/jobs\/([^/]+)\/?$/.exec(location.pathname)?.[1];
  if (!job) return start;
  start.set("view", "job");
  start.set("job", decodeURIComponent(job));
  history.replaceState(null, "", `/?${start.toString()}`);
  return start;
}

export const params = signal(atStart());

window.addEventListener("popstate", () => {
  params.value = new URLSearchParams(location.search);
});

export function param(name: string): string | null {
  return params.value.get(name);
}

function patched(base: URLSearchParams, patch: Patch): URLSearchParams {
  const next = new URLSearchParams(base);
  for (const [name, value] of Object.entries(patch)) {
    if (value === null || value === undefined || value === "") next.delete(name);
    else next.set(name, String(value));
  }
  return next;
}

function search(of: URLSearchParams): string {
  const text = of.toString();
  return text === "" ? location.pathname : `?${text}`;
}

/**
 * Changes some parameters. "push" makes a step that the back button undoes; "replace" is for clocks
 * and sliders.
 */
export function setParams(patch: Patch, history: "push" | "replace" = "replace"): void {
  const next = patched(params.peek(), patch);
  if (next.toString() === params.peek().toString()) return;
  write(search(next), history);
  params.value = next;
}

/** A page that is a file of its own may have no address to write. */
function write(address: string, history: "push" | "replace"): void {
  try {
    if (history === "push") window.history.pushState(null, "", address);
    else window.history.replaceState(null, "", address);
  } catch {
    // what is shown follows the parameters, not the address
  }
}

/** The address of another page: only what `patch` says, and the theme. */
export function pageHref(patch: Patch): string {
  return search(patched(new URLSearchParams(), { theme: params.value.get("theme"), ...patch }));
}

/** The address of this page with some parameters changed. */
export function hereHref(patch: Patch): string {
  return search(patched(params.value, patch));
}

export function go(href: string): void {
  window.history.pushState(null, "", href);
  params.value = new URLSearchParams(location.search);
  window.scrollTo(0, 0);
}
