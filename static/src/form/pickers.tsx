// Choosing what a job reads: a data set (or a file uploaded on the spot), or the output of another
// job.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { getDataset, listDatasets, listJobs } from "../api/client";
import type { Dataset } from "../api/types";
import { ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { count, moment } from "../format";
import type { FieldProps } from "./context";
import { useAria } from "./inputs";
import { fieldId } from "./schema";
import { Upload } from "./upload";

/** What a field of a request reads, by the name of the field. */
const ROLES: Record<string, Dataset["kind"]> = {
  input: "detections",
  detections: "detections",
  truth: "truth",
  tracks: "tracks",
};

function describe(dataset: Dataset): string {
  const { name, kind, rows, scans } = dataset;
  return `${name} · ${kind} · ${count(rows)} rows, ${count(scans)} scans`;
}

export function DatasetPicker({ value, pointer, change }: FieldProps): JSX.Element {
  const role = ROLES[pointer.split("/").at(-2) ?? ""];
  const sets = useResource(() => listDatasets(role), [role]);
  const [uploading, setUploading] = useState(false);
  const known = sets.data ?? [];
  const chosen = typeof value === "string" ? value : "";
  const listed = known.some((set) => set.id === chosen);
  // The list holds the newest ones; an older one that is chosen is asked for by itself.
  const older = useResource(
    () => (sets.data && chosen && !listed ? getDataset(chosen) : Promise.resolve(undefined)),
    [chosen, listed, Boolean(sets.data)],
  );
  const uploaded = (dataset: Dataset) => {
    setUploading(false);
    sets.reload();
    change(dataset.id);
  };
  return (
    <div class="picker">
      <div class="picker-row">
        <select
          {...useAria(pointer)}
          value={chosen}
          onChange={(event) => change(event.currentTarget.value)}
        >
          {listed ? null : (
            <option value={chosen}>
              {older.data
                ? describe(older.data)
                : chosen || (sets.data && !known.length ? "no data sets yet" : "choose…")}
            </option>
          )}
          <Group label="Uploaded" sets={known.filter((set) => set.origin.kind === "upload")} />
          <Group label="Made by jobs" sets={known.filter((set) => set.origin.kind === "job")} />
        </select>
        <button type="button" aria-expanded={uploading} onClick={() => setUploading(!uploading)}>
          Upload a file
        </button>
      </div>
      {uploading ? (
        <Upload id={fieldId(pointer)} expected={role} dropped={null} done={uploaded} />
      ) : null}
      {sets.error ? <ProblemBox error={sets.error} retry={sets.reload} /> : null}
    </div>
  );
}

function Group({ label, sets }: { label: string; sets: Dataset[] }): JSX.Element | null {
  if (!sets.length) return null;
  return (
    <optgroup label={label}>
      {sets.map((set) => (
        <option key={set.id} value={set.id}>
          {describe(set)}
        </option>
      ))}
    </optgroup>
  );
}

export function JobPicker({ value, pointer, change }: FieldProps): JSX.Element {
  const jobs = useResource(() => listJobs({ state: "queued,running,succeeded", limit: 100 }), []);
  const known = jobs.data?.items ?? [];
  const chosen = typeof value === "string" ? value : "";
  return (
    <select
      {...useAria(pointer)}
      value={chosen}
      onChange={(event) => change(event.currentTarget.value)}
    >
      {known.some((job) => job.id === chosen) ? null : (
        <option value={chosen}>{chosen || "choose…"}</option>
      )}
      {known.map((job) => (
        <option value={job.id}>
          {job.name || job.id.slice(-12)} · {job.kind} · {moment(job.created_at)}
        </option>
      ))}
    </select>
  );
}
