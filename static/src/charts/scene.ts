// The plan of a job, sorted out for drawing: one line a truth and a track, one cloud a sensor, in
// order of time.

import type { Cell, Columns, Plan } from "../api/types";
import { originOf } from "../times";

export interface Line {
  id: string;
  time: number[];
  x: number[];
  y: number[];
}

export interface TrackLine extends Line {
  status: string[];
  detection: (string | null)[];
  covariance: ([number, number, number] | null)[];
}

export interface Cloud {
  sensor: string;
  time: number[];
  x: number[];
  y: number[];
  id: string[];
  truth: (string | null)[];
}

/** The tracks of one sensor before they were put together. */
export interface LocalTracks {
  sensor: string;
  lines: Line[];
}

export interface Extent {
  xMin: number;
  xMax: number;
  yMin: number;
  yMax: number;
}

export interface Scene {
  truths: Map<string, Line>;
  tracks: Map<string, TrackLine>;
  clouds: Cloud[];
  /** Of jobs that put tracks together; else empty. */
  locals: LocalTracks[];
  /** The local tracks of a system track, as `sensor track`. */
  members: Map<string, Set<string>>;
  extent: Extent;
  /** Times of the scans, each once, in order. */
  times: number[];
  /** Where these count from. */
  origin: number;
  /** A truth whose last point is longer ago than this has ended: a scan and a half. */
  silence_s: number;
  /** The same of a track: living ones have a point at each scan, unless points were left out. */
  trackSilence_s: number;
  /** Number of the (last) scan at each time. */
  numbers: number[];
}

const column = (columns: Columns, name: string): Cell[] => columns[name] ?? [];
const text = (cell: Cell | undefined): string | null =>
  cell === null || cell === undefined || cell === "" ? null : String(cell);

function rowsInTime(columns: Columns): number[] {
  const times = column(columns, "time_s") as number[];
  return times.map((_, row) => row).sort((a, b) => (times[a] ?? 0) - (times[b] ?? 0) || a - b);
}

function entry<V>(map: Map<string, V>, key: string, create: () => V): V {
  const known = map.get(key);
  if (known) return known;
  const fresh = create();
  map.set(key, fresh);
  return fresh;
}

function addPoint(line: Line, columns: Columns, row: number): void {
  line.time.push(Number(columns.time_s?.[row]));
  line.x.push(Number(columns.x_m?.[row]));
  line.y.push(Number(columns.y_m?.[row]));
}

function truthLines(columns: Columns): Map<string, Line> {
  const lines = new Map<string, Line>();
  for (const row of rowsInTime(columns)) {
    const id = String(column(columns, "truth_id")[row]);
    addPoint(
      entry(lines, id, () => ({ id, time: [], x: [], y: [] })),
      columns,
      row,
    );
  }
  return lines;
}

function trackLines(columns: Columns): Map<string, TrackLine> {
  const lines = new Map<string, TrackLine>();
  const part = (name: string, row: number) => column(columns, name)[row];
  for (const row of rowsInTime(columns)) {
    const id = String(part("track_id", row));
    const line = entry(
      lines,
      id,
      (): TrackLine => ({ id, time: [], x: [], y: [], status: [], detection: [], covariance: [] }),
    );
    addPoint(line, columns, row);
    line.status.push(text(part("status", row)) ?? "confirmed");
    line.detection.push(text(part("detection_id", row)));
    const known = typeof part("p_xx", row) === "number" && typeof part("p_yy", row) === "number";
    line.covariance.push(
      known
        ? [Number(part("p_xx", row)), Number(part("p_xy", row) ?? 0), Number(part("p_yy", row))]
        : null,
    );
  }
  return lines;
}

function clouds(columns: Columns): Cloud[] {
  const bySensor = new Map<string, Cloud>();
  for (const row of rowsInTime(columns)) {
    // A bearing alone has no place in the plan.
    if (typeof column(columns, "x_m")[row] !== "number") continue;
    const sensor = String(column(columns, "sensor_id")[row]);
    const cloud = entry(
      bySensor,
      sensor,
      (): Cloud => ({ sensor, time: [], x: [], y: [], id: [], truth: [] }),
    );
    cloud.time.push(Number(column(columns, "time_s")[row]));
    cloud.x.push(Number(column(columns, "x_m")[row]));
    cloud.y.push(Number(column(columns, "y_m")[row]));
    cloud.id.push(String(column(columns, "detection_id")[row] ?? ""));
    cloud.truth.push(text(column(columns, "truth_id")[row]));
  }
  return [...bySensor.values()].sort((a, b) => (a.sensor < b.sensor ? -1 : 1));
}

function extentOf(plan: Plan): Extent {
  const given = plan.extent;
  return {
    xMin: given.x_min_m ?? -1,
    xMax: given.x_max_m ?? 1,
    yMin: given.y_min_m ?? -1,
    yMax: given.y_max_m ?? 1,
  };
}

/** A row of the file of local tracks. */
export interface LocalPoint {
  time: number;
  sensor: string;
  track: string;
  x: number;
  y: number;
}

function localTracks(points: LocalPoint[]): LocalTracks[] {
  const bySensor = new Map<string, Map<string, Line>>();
  for (const { time, sensor, track, x, y } of points) {
    const lines = entry(bySensor, sensor, () => new Map<string, Line>());
    const line = entry(lines, track, (): Line => ({ id: track, time: [], x: [], y: [] }));
    line.time.push(time);
    line.x.push(x);
    line.y.push(y);
  }
  return [...bySensor].map(([sensor, lines]) => ({ sensor, lines: [...lines.values()] }));
}

export const memberName = (sensor: string, track: string): string => `${sensor}\u0000${track}`;

export function sceneOf(
  plan: Plan,
  locals: LocalPoint[] = [],
  members = new Map<string, Set<string>>(),
): Scene {
  const truths = truthLines(plan.truth.columns);
  const tracks = trackLines(plan.tracks.columns);
  const numberAt = new Map(plan.scans.map((scan) => [scan.time_s, scan.number]));
  const known = numberAt.size
    ? [...numberAt.keys()]
    : [...truths.values(), ...tracks.values()].flatMap((line) => line.time);
  const times = [...new Set(known)].sort((a, b) => a - b);
  const numbers = times.map((time, index) => numberAt.get(time) ?? index + 1);
  const lines = {
    truths,
    tracks,
    clouds: clouds(plan.detections.columns),
    locals: localTracks(locals),
    members,
  };
  const silence_s = silence(plan.truth, times);
  const isWhole =
    plan.scans.length > 0 && plan.tracks.returned_points === plan.tracks.source_points;
  const trackSilence_s = isWhole ? 0 : silence(plan.tracks, times);
  return {
    ...lines,
    extent: extentOf(plan),
    times,
    numbers,
    origin: originOf(times[0]),
    silence_s,
    trackSilence_s,
  };
}

/** A scan and a half, more where points were left out. */
function silence(
  { source_points, returned_points }: { source_points: number; returned_points: number },
  times: number[],
): number {
  const period = ((times.at(-1) ?? 0) - (times[0] ?? 0)) / Math.max(times.length - 1, 1);
  return 1.5 * period * Math.max(1, Math.ceil(source_points / Math.max(returned_points, 1)));
}

const ROUNDING_S = 1e-9;

const isSilent = (line: Line, now: number, silence_s: number): boolean =>
  (line.time.at(-1) ?? -Infinity) < now - silence_s - ROUNDING_S;

/** Whether a track has no point any more at a time. */
export function hasEnded(scene: Scene, track: TrackLine, now: number): boolean {
  return isSilent(track, now, scene.trackSilence_s);
}

/** Whether a truth or a track has begun and not ended at a time. */
export function isAlive(scene: Scene, line: Line | TrackLine, now: number): boolean {
  const silence_s = "status" in line ? scene.trackSilence_s : scene.silence_s;
  return (line.time[0] ?? Infinity) <= now + ROUNDING_S && !isSilent(line, now, silence_s);
}

/** Points at the end of a track that had no detection. */
export function missesAtEnd(track: TrackLine): number {
  return track.status.length - 1 - track.status.findLastIndex((status) => status !== "coasted");
}

/** The half-open range of a line's points from `from` to `to`, both included. */
export function within(time: number[], from: number, to: number): [number, number] {
  return [firstAfter(time, from - 1e-9), firstAfter(time, to + 1e-9)];
}

function firstAfter(time: number[], limit: number): number {
  let low = 0;
  let high = time.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((time[middle] ?? 0) <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Where a line is at a time: its last point not after it, or its first. */
export function at(line: Line, time: number): { x: number; y: number; index: number } | undefined {
  if (!line.time.length) return undefined;
  const index = Math.max(0, firstAfter(line.time, time + 1e-9) - 1);
  return { x: line.x[index] ?? 0, y: line.y[index] ?? 0, index };
}
