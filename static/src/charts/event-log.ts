// The events of an evaluation, read from its file: what happened to each target and track at each
// step.

import { getArtifactText } from "../api/client";
import { type CsvTable, parseCsv, reader } from "../components/csv";

export interface LogEntry {
  sequence: string;
  step: number;
  time: number;
  kind: string;
  truth: string;
  track: string;
  distance: number | null;
  /** Of a switch: the track that followed the target before. */
  before: string;
  /** Why, as a sentence; empty where nothing is to be explained. */
  why: string;
}

export interface EventLog {
  entries: LogEntry[];
  /** Not all of the file was read. */
  isCut: boolean;
}

const MOST_ENTRIES = 300_000;

/** With `areExplained` the job has a file of causes, too. */
export async function readEvents(jobId: string, areExplained: boolean): Promise<EventLog> {
  const [events, causes] = await Promise.all([
    getArtifactText(jobId, "events.csv"),
    areExplained ? getArtifactText(jobId, "causes.csv") : "",
  ]);
  const table = parseCsv(events, MOST_ENTRIES);
  const field = (name: string) => reader(table, name);
  const names = ["sequence", "step", "time_s", "event", "truth_id", "track_id", "distance"];
  const [sequence, step, time, kind, truth, track, distance] = names.map(field) as [
    Field,
    Field,
    Field,
    Field,
    Field,
    Field,
    Field,
  ];
  const entry = (row: string[]): LogEntry => ({
    sequence: sequence(row),
    step: Number(step(row)),
    time: Number(time(row)),
    kind: kind(row),
    truth: truth(row),
    track: track(row),
    distance: distance(row) === "" ? null : Number(distance(row)),
    before: "",
    why: "",
  });
  const entries = table.rows.map(entry);
  noteFormerTracks(entries);
  noteCauses(entries, parseCsv(causes, MOST_ENTRIES));
  return { entries, isCut: table.rows.length === MOST_ENTRIES };
}

/** A switch is from the track that followed the target at its last match before that step. */
function noteFormerTracks(entries: LogEntry[]): void {
  const of = ({ sequence, truth }: LogEntry) => `${sequence}\u0000${truth}`;
  const last = new Map<string, string>();
  const former = new Map<string, string>();
  for (const entry of entries.filter(({ kind }) => kind === "match")) {
    former.set(`${of(entry)}\u0000${entry.step}`, last.get(of(entry)) ?? "");
    last.set(of(entry), entry.track);
  }
  for (const entry of entries)
    if (entry.kind === "switch") entry.before = former.get(`${of(entry)}\u0000${entry.step}`) ?? "";
}

/** Whom an event is of: a target, or a track that follows none. */
const subjectOf = (sequence: string, kind: string, truth: string, track: string): string =>
  [sequence, kind, ["miss", "break", "switch"].includes(kind) ? truth : track].join("\u0000");

/** Of each kind and target or track the stretches stand in order; the events of one do, too. */
function noteCauses(entries: LogEntry[], causes: CsvTable): void {
  if (!causes.rows.length) return;
  const names = ["sequence", "event", "truth_id", "track_id", "to_step", "sentence"];
  const [sequence, event, truth, track, to, sentence] = names.map((name) =>
    reader(causes, name),
  ) as [Field, Field, Field, Field, Field, Field];
  const stretches = new Map<string, { to: number; why: string }[]>();
  for (const row of causes.rows) {
    const key = subjectOf(sequence(row), event(row), truth(row), track(row));
    const of = stretches.get(key) ?? [];
    stretches.set(key, of);
    of.push({ to: Number(to(row)), why: sentence(row) });
  }
  const next = new Map<string, number>();
  for (const entry of entries) {
    const key = subjectOf(entry.sequence, entry.kind, entry.truth, entry.track);
    const of = stretches.get(key);
    if (!of) continue;
    let at = next.get(key) ?? 0;
    while (at < of.length - 1 && (of[at]?.to ?? 0) < entry.step) at += 1;
    next.set(key, at);
    entry.why = of[at]?.why ?? "";
  }
}

type Field = (row: string[]) => string;

/** A stretch in which one track followed a target. */
export interface Run {
  track: string;
  from: number;
  to: number;
}

/** What became of one target. */
export interface Lane {
  truth: string;
  sequence: string;
  from: number;
  to: number;
  runs: Run[];
  marks: {
    kind: "switch" | "break" | "reacquisition";
    time: number;
    track: string;
    before: string;
    why: string;
  }[];
}

/**
 * One lane a target, in the order in which targets appear; `sequence` keeps those of one sequence.
 */
export function lanesOf(entries: LogEntry[], sequence: string): Lane[] {
  const lanes = new Map<string, Lane>();
  for (const { truth, sequence: of, time, kind, track, before, why } of entries) {
    if (truth === "" || of !== sequence) continue;
    const fresh: Lane = { truth, sequence, from: time, to: time, runs: [], marks: [] };
    const lane = lanes.get(truth) ?? fresh;
    lanes.set(truth, lane);
    if (kind === "match" || kind === "miss") lane.to = Math.max(lane.to, time);
    if (kind === "match") follow(lane, track, time);
    if (kind === "miss") lane.runs.push({ track: "", from: time, to: time });
    if (kind === "switch" || kind === "break" || kind === "reacquisition")
      lane.marks.push({ kind, time, track, before, why });
  }
  for (const lane of lanes.values()) lane.runs = lane.runs.filter((run) => run.track !== "");
  return [...lanes.values()];
}

function follow(lane: Lane, track: string, time: number): void {
  const last = lane.runs.at(-1);
  if (last && last.track === track) last.to = time;
  else lane.runs.push({ track, from: time, to: time });
}
