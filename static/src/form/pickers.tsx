// Choosing what a job reads: a data set (or a file uploaded on the spot), or the output of another job.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { getDataset, listDatasets, listJobs, uploadDataset } from "../api/client";
import type { Dataset } from "../api/types";
import { Icon, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { count, moment } from "../format";
import type { FieldProps } from "./context";
import { useAria } from "./inputs";
import { fieldId } from "./schema";

const KINDS = ["", "detections", "truth", "tracks", "bearing_time"];
/** What a field of a request reads, by the name of the field. */
const ROLES: Record<string, Dataset["kind"]> = { input: "detections", detections: "detections", truth: "truth", tracks: "tracks" };
const FORMATS = ["", "csv", "json", "autoferry", "mot"];

function describe(dataset: Dataset): string {
  return `${dataset.name} · ${dataset.kind} · ${count(dataset.rows)} rows, ${count(dataset.scans)} scans`;
}

export function DatasetPicker({ value, pointer, change }: FieldProps): JSX.Element {
  const role = ROLES[pointer.split("/").at(-2) ?? ""];
  const sets = useResource(() => listDatasets(role), [role]);
  const [uploading, setUploading] = useState(false);
  const known = sets.data ?? [];
  const chosen = typeof value === "string" ? value : "";
  const listed = known.some((set) => set.id === chosen);
  // The list holds the newest ones; an older one that is chosen is asked for by itself.
  const older = useResource(() => (sets.data && chosen && !listed ? getDataset(chosen) : Promise.resolve(undefined)), [chosen, listed, Boolean(sets.data)]);
  const uploaded = (dataset: Dataset) => {
    setUploading(false);
    sets.reload();
    change(dataset.id);
  };
  return (
    <div class="picker">
      <div class="picker-row">
        <select {...useAria(pointer)} value={chosen} onChange={(event) => change(event.currentTarget.value)}>
          {listed ? null : <option value={chosen}>{older.data ? describe(older.data) : chosen || (sets.data && !known.length ? "no data sets yet" : "choose…")}</option>}
          <Group label="Uploaded" sets={known.filter((set) => set.origin.kind === "upload")} />
          <Group label="Made by jobs" sets={known.filter((set) => set.origin.kind === "job")} />
        </select>
        <button type="button" aria-expanded={uploading} onClick={() => setUploading(!uploading)}>
          Upload a file
        </button>
      </div>
      {uploading ? <Upload id={fieldId(pointer)} role={role} done={uploaded} /> : null}
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

function options(values: string[]): JSX.Element[] {
  return values.map((value) => <option value={value}>{value || "from the file"}</option>);
}

function Upload({ id, role, done }: { id: string; role: Dataset["kind"] | undefined; done: (dataset: Dataset) => void }): JSX.Element {
  const [file, setFile] = useState<File>();
  const [kind, setKind] = useState<string>(role ?? "");
  const [format, setFormat] = useState("");
  const [error, setError] = useState<unknown>();
  const [busy, setBusy] = useState(false);
  const send = async () => {
    if (!file) return;
    setBusy(true);
    setError(undefined);
    try {
      const meta = Object.fromEntries(Object.entries({ name: file.name, kind, format }).filter(([, value]) => value !== ""));
      done(await uploadDataset(meta, file));
    } catch (failure) {
      setError(failure);
    } finally {
      setBusy(false);
    }
  };
  return (
    <div class="upload">
      <label>
        <span>File</span>
        <input type="file" data-upload={id} accept=".csv,.json" onChange={(event) => setFile(event.currentTarget.files?.[0])} />
      </label>
      <label>
        <span>Kind</span>
        <select value={kind} onChange={(event) => setKind(event.currentTarget.value)}>
          {options(KINDS)}
        </select>
      </label>
      <label>
        <span>Format</span>
        <select value={format} onChange={(event) => setFormat(event.currentTarget.value)}>
          {options(FORMATS)}
        </select>
      </label>
      <button type="button" class="primary" disabled={!file || busy} onClick={() => void send()}>
        <Icon name={busy ? "running" : "plus"} /> {busy ? "Uploading…" : "Upload"}
      </button>
      {error ? <ProblemBox error={error} /> : null}
    </div>
  );
}

export function JobPicker({ value, pointer, change }: FieldProps): JSX.Element {
  const jobs = useResource(() => listJobs({ state: "queued,running,succeeded", limit: 100 }), []);
  const known = jobs.data?.items ?? [];
  const chosen = typeof value === "string" ? value : "";
  return (
    <select {...useAria(pointer)} value={chosen} onChange={(event) => change(event.currentTarget.value)}>
      {known.some((job) => job.id === chosen) ? null : <option value={chosen}>{chosen || "choose…"}</option>}
      {known.map((job) => (
        <option value={job.id}>
          {job.name || job.id.slice(-12)} · {job.kind} · {moment(job.created_at)}
        </option>
      ))}
    </select>
  );
}
