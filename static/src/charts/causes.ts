// Why things happened, read from the file in which a job explains its events: each stretch of
// breaks, misses, switches, false, redundant and diverging tracks, with its sentence.

import { type CsvTable, parseCsv, reader } from "../components/csv";

export interface Cause {
  event: string;
  cause: string;
  from: number;
  to: number;
  truth: string;
  track: string;
  otherTrack: string;
  otherTruth: string;
  sentence: string;
}

const MOST_CAUSES = 300_000;

export const readCauses = (text: string): Cause[] => causesOf(parseCsv(text, MOST_CAUSES));

function causesOf(table: CsvTable): Cause[] {
  const column = (name: string) => reader(table, name);
  const [event, cause, from, to] = [
    column("event"),
    column("cause"),
    column("from_s"),
    column("to_s"),
  ];
  const [truth, track, otherTruth, otherTrack, sentence] = [
    column("truth_id"),
    column("track_id"),
    column("other_truth_id"),
    column("other_track_id"),
    column("sentence"),
  ];
  return table.rows.map((row) => ({
    event: event(row),
    cause: cause(row),
    from: Number(from(row)),
    to: Number(to(row)),
    truth: truth(row),
    track: track(row),
    otherTruth: otherTruth(row),
    otherTrack: otherTrack(row),
    sentence: sentence(row),
  }));
}

const ROUNDING_S = 1e-6;

/** Whether it concerns a track, or the target that a track is of. */
export function concerns(cause: Cause, track: string | null, truth: string | null): boolean {
  const ofTrack = track !== null && (cause.track === track || cause.otherTrack === track);
  return ofTrack || (truth !== null && cause.truth === truth);
}

/** What happened at a time to a track or a target. */
export function causesAt(
  causes: Cause[],
  time: number,
  track: string | null,
  truth: string | null,
): Cause[] {
  return causes.filter(
    (cause) =>
      cause.from <= time + ROUNDING_S &&
      cause.to >= time - ROUNDING_S &&
      concerns(cause, track, truth),
  );
}
