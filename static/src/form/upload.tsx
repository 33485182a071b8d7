// Uploading a file: what it holds, and what its columns are called. The service judges; its faults
// stand at the column they are of.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { uploadDataset } from "../api/client";
import type { Dataset, Fault } from "../api/types";
import { asProblem, FaultText, Icon, ProblemBox } from "../components/basics";
import { type CsvTable, parseCsv } from "../components/csv";
import { HeadRow, TableScroll } from "../components/table-parts";

const KINDS = ["", "detections", "truth", "tracks", "bearing_time"];
const FORMATS = ["", "csv", "json", "autoferry", "mot", "npy"];
const COLUMNS = [
  "time_s",
  "scan",
  "sensor_id",
  "detection_id",
  "truth_id",
  "track_id",
  "x_m",
  "y_m",
  "z_m",
  "range_m",
  "bearing_deg",
  "range_rate_mps",
  "vx_mps",
  "vy_mps",
  "vz_mps",
  "amplitude",
  "probability",
  "status",
  "p_xx",
  "p_xy",
  "p_yy",
];
/** As much of a file as its header and a few rows need. */
const HEAD_BYTES = 65_536;
const HEAD_ROWS = 3;
const MOST_COLUMNS = 60;

interface Props {
  id: string;
  expected: Dataset["kind"] | undefined;
  done: (dataset: Dataset) => void;
}

/** Header and first rows of what looks like a table in text. */
async function headOf(file: File): Promise<CsvTable | undefined> {
  if (!/\.(csv|txt)$/i.test(file.name)) return undefined;
  const text = await file.slice(0, HEAD_BYTES).text();
  const table = parseCsv(text, HEAD_ROWS);
  return table.columns.length > 1 && table.columns.length <= MOST_COLUMNS ? table : undefined;
}

function metaOf(file: File, kind: string, format: string, renamed: Record<string, string>): object {
  const columns = Object.fromEntries(
    Object.entries(renamed).filter(([name, to]) => to !== "" && to !== name),
  );
  const texts = Object.entries({ name: file.name, kind, format }).filter(
    ([, value]) => value !== "",
  );
  return { ...Object.fromEntries(texts), ...(Object.keys(columns).length ? { columns } : {}) };
}

const unescaped = (token: string): string => token.replaceAll("~1", "/").replaceAll("~0", "~");

/**
 * The column of the file that a fault is of: the one it names, or the one that is read as what it
 * names.
 */
function columnOf(
  fault: Fault,
  head: CsvTable | undefined,
  renamed: Record<string, string>,
): string | undefined {
  const named = /^\/meta\/columns\/(.*)$/.exec(fault.pointer)?.[1];
  const column = named === undefined ? fault.column : unescaped(named);
  if (!head || !column) return undefined;
  return head.columns.includes(column)
    ? column
    : head.columns.find((name) => renamed[name] === column);
}

/** The faults by the column that they are of. */
function placedFaults(
  faults: Fault[],
  head: CsvTable | undefined,
  renamed: Record<string, string>,
): Map<string, Fault[]> {
  const placed = new Map<string, Fault[]>();
  for (const fault of faults) {
    const column = columnOf(fault, head, renamed);
    if (column) placed.set(column, [...(placed.get(column) ?? []), fault]);
  }
  return placed;
}

export function Upload({ id, expected, done }: Props): JSX.Element {
  const [file, setFile] = useState<File>();
  const [head, setHead] = useState<CsvTable>();
  const [kind, setKind] = useState<string>(expected ?? "");
  const [format, setFormat] = useState("");
  const [renamed, setRenamed] = useState<Record<string, string>>({});
  const [error, setError] = useState<unknown>();
  const [busy, setBusy] = useState(false);
  const choose = (chosen: File | undefined) => {
    setFile(chosen);
    setRenamed({});
    setError(undefined);
    setHead(undefined);
    if (chosen) void headOf(chosen).then(setHead);
  };
  const send = async () => {
    if (!file) return;
    setBusy(true);
    setError(undefined);
    try {
      done(await uploadDataset(metaOf(file, kind, format, renamed), file));
    } catch (failure) {
      setError(failure);
    } finally {
      setBusy(false);
    }
  };
  const faults = error ? (asProblem(error).errors ?? []) : [];
  const placed = placedFaults(faults, head, renamed);
  const placedAll = faults.length > 0 && faults.every((fault) => columnOf(fault, head, renamed));
  return (
    <div class="upload">
      <label>
        <span>File</span>
        <input
          type="file"
          data-upload={id}
          accept=".csv,.json,.txt,.npy"
          onChange={(event) => choose(event.currentTarget.files?.[0])}
        />
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
      {head ? (
        <Mapping id={id} head={head} renamed={renamed} faults={placed} change={setRenamed} />
      ) : null}
      {error && !placedAll ? <ProblemBox error={error} /> : null}
      {placedAll ? (
        <p class="field-fault" role="alert">
          {faults.length === 1
            ? "One column needs a look."
            : `${faults.length} faults in the columns need a look.`}
        </p>
      ) : null}
    </div>
  );
}

function options(values: string[]): JSX.Element[] {
  return values.map((value) => <option value={value}>{value || "from the file"}</option>);
}

interface MappingProps {
  id: string;
  head: CsvTable;
  renamed: Record<string, string>;
  faults: Map<string, Fault[]>;
  change: (renamed: Record<string, string>) => void;
}

function Mapping({ id, head, renamed, faults, change }: MappingProps): JSX.Element {
  return (
    <TableScroll label="Columns of the file" class="mapping table-scroll">
      <table class="data">
        <HeadRow heads={["Column", "First values", "Read as"]} />
        <tbody>
          {head.columns.map((name, index) => (
            <tr class={faults.has(name) ? "faulty" : undefined}>
              <th scope="row" class="mono">
                {name}
              </th>
              <td class="mono muted">{head.rows.map((row) => row[index] ?? "").join(", ")}</td>
              <td>
                <ColumnInput
                  id={`${id}-column-${index}`}
                  name={name}
                  value={renamed[name] ?? ""}
                  faults={faults.get(name) ?? []}
                  change={(to) => change({ ...renamed, [name]: to })}
                />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <datalist id={`${id}-names`}>
        {COLUMNS.map((name) => (
          <option value={name} />
        ))}
      </datalist>
    </TableScroll>
  );
}

interface ColumnProps {
  id: string;
  name: string;
  value: string;
  faults: Fault[];
  change: (to: string) => void;
}

function ColumnInput({ id, name, value, faults, change }: ColumnProps): JSX.Element {
  return (
    <>
      <input
        id={id}
        type="text"
        list={`${id.replace(/-column-\d+$/, "")}-names`}
        data-column={name}
        aria-label={`Column ${name} is read as`}
        aria-invalid={faults.length > 0 || undefined}
        aria-describedby={faults.length ? `${id}-fault` : undefined}
        autocomplete="off"
        value={value}
        placeholder={name}
        onInput={(event) => change(event.currentTarget.value.trim())}
      />
      {faults.length ? (
        <p class="field-fault" id={`${id}-fault`}>
          {faults.map((fault) => (
            <span>
              <FaultText fault={fault} />
            </span>
          ))}
        </p>
      ) : null}
    </>
  );
}
