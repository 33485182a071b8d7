// Where the probability of a track went at each scan: to detections of its own target, of other
// targets, of none, or to no detection at all.

import type { Cell, TrackProbability } from "../api/types";

export interface Candidate {
  /** None is "no detection". */
  detection: string | null;
  /** The target it came from, where that is known. */
  truth: string | null;
  probability: number;
}

export interface Step {
  time: number;
  status: string;
  nis: number | null;
  existence: number | null;
  /** The most probable first. */
  candidates: Candidate[];
}

export interface Story {
  track: string;
  /** The target whose detections got most of its probability. */
  own: string | null;
  originsKnown: boolean;
  steps: Step[];
}

const text = (cell: Cell | undefined): string | null =>
  cell === null || cell === undefined || cell === "" ? null : String(cell);
const value = (cell: Cell | undefined): number | null => (typeof cell === "number" ? cell : null);

function stepsOf(columns: Record<string, Cell[]>): Step[] {
  const steps: Step[] = [];
  const part = (name: string, row: number) => columns[name]?.[row];
  (columns.time_s ?? []).forEach((cell, row) => {
    const time = Number(cell);
    if (steps.at(-1)?.time !== time)
      steps.push({
        time,
        status: text(part("status", row)) ?? "",
        nis: value(part("nis", row)),
        existence: value(part("existence", row)),
        candidates: [],
      });
    steps.at(-1)?.candidates.push({
      detection: text(part("detection_id", row)),
      truth: text(part("truth_id", row)),
      probability: value(part("probability", row)) ?? 0,
    });
  });
  return steps;
}

/** Two sensors may scan at one time: then each has its share of the column. */
function shareOut(step: Step): void {
  const sum = step.candidates.reduce((total, entry) => total + entry.probability, 0);
  const points = Math.round(sum);
  if (points > 1) for (const entry of step.candidates) entry.probability /= points;
  step.candidates.sort((a, b) => b.probability - a.probability);
}

/** The first target of those that got most. */
function ownOf(steps: Step[]): string | null {
  const sums = new Map<string, number>();
  for (const { truth, probability } of steps.flatMap((step) => step.candidates))
    if (truth !== null) sums.set(truth, (sums.get(truth) ?? 0) + probability);
  let best: [string | null, number] = [null, 0];
  for (const [truth, sum] of sums) if (sum > best[1]) best = [truth, sum];
  return best[0];
}

export function storyOf(track: string, series: TrackProbability): Story {
  const steps = stepsOf(series.columns as unknown as Record<string, Cell[]>);
  const originsKnown = series.origins_known;
  // As in the file, since of equal targets the first one counts.
  const own = originsKnown ? ownOf(steps) : null;
  for (const step of steps) shareOut(step);
  return { track, own, originsKnown, steps };
}

/** A piece of the column of a scan. */
export interface Part {
  kind: "own" | "target" | "clutter" | "none" | "chosen" | "others";
  truth: string | null;
  share: number;
}

const ORDER: Part["kind"][] = ["own", "chosen", "target", "others", "clutter", "none"];

function kindOf(story: Story, { detection, truth }: Candidate, isFirst: boolean): Part["kind"] {
  if (detection === null) return "none";
  if (!story.originsKnown) return isFirst ? "chosen" : "others";
  if (truth === null) return "clutter";
  return truth === story.own ? "own" : "target";
}

/** The pieces of a scan from below; those of one kind and target together. */
export function partsOf(story: Story, step: Step): Part[] {
  const parts: Part[] = [];
  const first = step.candidates.find((entry) => entry.detection !== null);
  for (const entry of step.candidates) {
    const kind = kindOf(story, entry, entry === first);
    const truth = kind === "target" ? entry.truth : null;
    const known = parts.find((part) => part.kind === kind && part.truth === truth);
    if (known) known.share += entry.probability;
    else parts.push({ kind, truth, share: entry.probability });
  }
  return parts.sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind));
}

/** What a candidate is, in words. */
export function originWords(story: Story, entry: Candidate): string {
  if (entry.detection === null) return "no detection";
  if (!story.originsKnown) return "origin not known";
  if (entry.truth === null) return "clutter";
  return entry.truth === story.own ? `own target ${entry.truth}` : `target ${entry.truth}`;
}

/** Targets that got any probability, in the order of their share: they get the colours. */
export function otherTargets(stories: Story[]): string[] {
  const sums = new Map<string, number>();
  const own = new Set(stories.map((story) => story.own));
  for (const { truth, probability } of stories.flatMap((story) =>
    story.steps.flatMap((step) => step.candidates),
  ))
    if (truth !== null && !own.has(truth)) sums.set(truth, (sums.get(truth) ?? 0) + probability);
  return [...sums].sort((a, b) => b[1] - a[1]).map(([truth]) => truth);
}
