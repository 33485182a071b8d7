// What is kept, where old jobs make room for new ones.

import { useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { getUsage } from "../api/client";
import type { Usage } from "../api/types";
import { bytes, count } from "../format";
import { poll } from "../state/live";

const AGAIN_MS = 5000;

/** Nothing of a service that keeps everything. */
function told(usage: Usage): string[] {
  const { max_data_bytes: most, keep_jobs: jobs, pinned_jobs: pinned } = usage;
  const parts: string[] = [];
  if (most) parts.push(`${bytes(usage.files_bytes + usage.tables_bytes)} of ${bytes(most)} kept`);
  if (jobs !== undefined) parts.push(`${count(usage.ended_jobs)} of ${count(jobs)} ended jobs`);
  if (parts.length) parts.push(`${count(pinned)} pinned`);
  return parts;
}

export function UsageLine(): JSX.Element | null {
  const parts = useSignal<string[]>([]);
  const look = async (): Promise<number | null> => {
    try {
      parts.value = told(await getUsage());
      return parts.value.length ? AGAIN_MS : null;
    } catch {
      // The list says what is wrong.
      return AGAIN_MS;
    }
  };
  useEffect(() => poll(look), []);
  return parts.value.length ? <p class="muted small usage">{parts.value.join(", ")}</p> : null;
}
