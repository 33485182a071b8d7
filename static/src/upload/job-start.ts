// The job to start from, as the service proposes it for a file: with the data set in place of the
// file once that is uploaded.

import type { Inspection } from "../api/types";
import { isObject, type JsonObject } from "../form/schema";
import { pageHref } from "../state/url";

/** A source of the file as one of the data set; of another file, a data set to be chosen. */
function asDataset(source: JsonObject, path: string, id: string): JsonObject {
  return { source: "dataset", ...(source.path === path ? { dataset_id: id } : {}) };
}

/** The address of New job with this job in its form, which reads the data set. */
export function jobHref(job: Inspection["job"], path: string, id: string): string {
  const { kind, ...parts } = job;
  const body = Object.entries(parts).map(([name, part]) => [
    name,
    isObject(part) && part.source === "file" ? asDataset(part, path, id) : part,
  ]);
  return pageHref({ view: "new", kind, body: JSON.stringify(Object.fromEntries(body)) });
}
