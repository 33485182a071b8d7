// The temporal automaton of a job and a target's way through it, read from the job's files.

import { ApiError, getArtifactText } from "../api/client";
import { parseCsv, reader } from "../components/csv";

interface Transition {
  from: number;
  to: number;
  scan: number | null;
  time_s: number | null;
  symbol: string;
  weight?: number;
}

interface AutomatonFile {
  minimised: boolean;
  start_state: number;
  states: number;
  final_states: number[];
  transitions: Transition[];
}

export interface Automaton {
  start: number;
  final: Set<number>;
  minimised: boolean;
  /** Transitions out of each state. */
  out: Map<number, Transition[]>;
}

/** What the target has at a scan, and how probable that was to the track that speaks for it. */
export interface Expected {
  scan: number;
  time: number;
  symbol: string;
  track: string;
  probability: number | null;
}

export interface TfaFiles {
  /** Absent where it was too large for a file. */
  automaton: Automaton | undefined;
  expected: Map<string, Expected[]>;
}

export const EPSILON = "ε";

/** A file that a large job does not leave. */
async function optional(id: string, name: string): Promise<string | undefined> {
  try {
    return await getArtifactText(id, name);
  } catch (error) {
    if (error instanceof ApiError && error.problem.status === 404) return undefined;
    throw error;
  }
}

export async function readTfaFiles(jobId: string): Promise<TfaFiles> {
  const [automaton, probabilities] = await Promise.all([
    optional(jobId, "automaton.json"),
    optional(jobId, "truth_probability.csv"),
  ]);
  return {
    automaton:
      automaton === undefined ? undefined : automatonOf(JSON.parse(automaton) as AutomatonFile),
    expected: expectedOf(probabilities ?? ""),
  };
}

function automatonOf(file: AutomatonFile): Automaton {
  const out = new Map<number, Transition[]>();
  for (const transition of file.transitions) {
    const known = out.get(transition.from);
    if (known) known.push(transition);
    else out.set(transition.from, [transition]);
  }
  return {
    start: file.start_state,
    final: new Set(file.final_states),
    minimised: file.minimised,
    out,
  };
}

function expectedOf(text: string): Map<string, Expected[]> {
  const table = parseCsv(text);
  const field = (name: string) => reader(table, name);
  const [truth, time, scan, symbol, track, probability] = [
    field("truth_id"),
    field("time_s"),
    field("scan"),
    field("expected"),
    field("track_id"),
    field("probability"),
  ];
  const all = new Map<string, Expected[]>();
  for (const row of table.rows) {
    const of = truth(row);
    const entry = {
      scan: Number(scan(row)),
      time: Number(time(row)),
      symbol: symbol(row),
      track: track(row),
      probability: probability(row) === "" ? null : Number(probability(row)),
    };
    const known = all.get(of);
    if (known) known.push(entry);
    else all.set(of, [entry]);
  }
  return all;
}

/** One scan of a target's way. */
export interface Step extends Expected {
  /**
   * The state that the automaton is in after the scan; undefined where it accepts the symbol no
   * more.
   */
  state: number | undefined;
  isFinal: boolean;
  /** What else the automaton would have accepted there. */
  others: string[];
}

export interface Way {
  steps: Step[];
  /** Index of the first scan that the automaton does not accept. */
  break_: number | undefined;
  /** What the track has from the break on, by scan. */
  taken: { scan: number; time: number; symbol: string }[];
}

/**
 * Runs the automaton over a target's string. A string that is over begins again at the start with
 * its next symbol.
 */
export function wayOf(automaton: Automaton, expected: Expected[]): Way {
  let state: number | undefined = automaton.start;
  const steps: Step[] = [];
  let broken: number | undefined;
  let last = automaton.start;
  for (const entry of expected) {
    if (state !== undefined) last = state;
    const choices: Transition[] = state === undefined ? [] : at(automaton, state, entry.scan);
    let next: Transition | undefined = choices.find(
      (transition) => transition.symbol === entry.symbol,
    );
    if (!next && state !== undefined && automaton.final.has(state))
      next = at(automaton, automaton.start, entry.scan).find(
        (transition) => transition.symbol === entry.symbol,
      );
    if (!next && state !== undefined && broken === undefined) broken = steps.length;
    state = next?.to;
    steps.push({
      ...entry,
      state,
      isFinal: state !== undefined && automaton.final.has(state),
      others: choices
        .filter((transition) => transition !== next)
        .map((transition) => transition.symbol),
    });
  }
  return {
    steps,
    break_: broken,
    taken: broken === undefined ? [] : goingOn(automaton, last, steps[broken]?.scan ?? 0),
  };
}

function at(automaton: Automaton, state: number, scan: number): Transition[] {
  return (automaton.out.get(state) ?? []).filter((transition) => transition.scan === scan);
}

/** The way on from a state: the heaviest transition at each. */
function goingOn(automaton: Automaton, from: number, scan: number): Way["taken"] {
  if (from === automaton.start) return [];
  const taken: Way["taken"] = [];
  let state = from;
  for (let guard = 0; guard < 100_000; guard++) {
    const choices = (automaton.out.get(state) ?? []).filter(
      (transition) => (transition.scan ?? -1) >= scan,
    );
    const next = choices.reduce<Transition | undefined>(
      (best, transition) => ((transition.weight ?? 0) > (best?.weight ?? -1) ? transition : best),
      undefined,
    );
    if (!next) break;
    taken.push({ scan: next.scan ?? 0, time: next.time_s ?? 0, symbol: next.symbol });
    state = next.to;
  }
  return taken;
}
