// What a search wrote down: the costs of its iterations, and where it is a clustering the
// memberships and centres of each.

import { type CsvTable, parseCsv, reader } from "../components/csv";

export interface Iteration {
  number: number;
  best: number | null;
  mean: number | null;
  /** The least cost that there is, where the job knows it. */
  optimal: number | null;
  /** By detection and group; the group "" is noise. */
  memberships: Map<string, Map<string, number>>;
  centres: Map<string, number[]>;
}

/** One problem that was searched: a cluster of tracks at an occasion, or an instant of reports. */
export interface Problem {
  name: string;
  /** Of a grouping: the instant of its reports. */
  time_s?: number;
  iterations: Iteration[];
}

type Field = (row: string[]) => string;
const MOST_ROWS = 200_000;
const orNull = (text: string): number | null => (text === "" ? null : Number(text));

function problemsBy(
  table: CsvTable,
  name: Field,
  iteration: Field,
  add: (iteration: Iteration, row: string[]) => void,
): Problem[] {
  const problems = new Map<string, Map<number, Iteration>>();
  for (const row of table.rows) {
    const key = name(row);
    const iterations = problems.get(key) ?? new Map<number, Iteration>();
    problems.set(key, iterations);
    const number = Number(iteration(row));
    const entry = iterations.get(number) ?? {
      number,
      best: null,
      mean: null,
      optimal: null,
      memberships: new Map(),
      centres: new Map(),
    };
    iterations.set(number, entry);
    add(entry, row);
  }
  return [...problems].map(([key, iterations]) => ({
    name: key,
    iterations: [...iterations.values()].sort((a, b) => a.number - b.number),
  }));
}

/**
 * A trace of the bat algorithm, of fuzzy c-means over tracks, or of a grouper; told apart by their
 * columns.
 */
export function readTrace(text: string): { problems: Problem[]; isCut: boolean } {
  const table = parseCsv(text, MOST_ROWS);
  const field = (name: string) => reader(table, name);
  const isCut = table.rows.length === MOST_ROWS;
  const iteration = field("iteration");
  if (table.columns.includes("best_j")) {
    const [best, mean, optimal] = [field("best_j"), field("mean_j"), field("optimal_j")];
    const add = (entry: Iteration, row: string[]) =>
      Object.assign(entry, {
        best: orNull(best(row)),
        mean: orNull(mean(row)),
        optimal: orNull(optimal(row)),
      });
    return { problems: problemsBy(table, occasionOf(table), iteration, add), isCut };
  }
  const ofGroups = table.columns.includes("group");
  const name = ofGroups ? (row: string[]) => `${field("time_s")(row)} s` : occasionOf(table);
  const problems = problemsBy(table, name, iteration, adderOf(field, ofGroups));
  return {
    problems: ofGroups
      ? problems.map((problem) => ({ ...problem, time_s: parseFloat(problem.name) }))
      : problems,
    isCut,
  };
}

function occasionOf(table: CsvTable): Field {
  const [occasion, cluster] = [reader(table, "occasion"), reader(table, "cluster")];
  return (row) => `occasion ${occasion(row)}, cluster ${cluster(row)}`;
}

const CENTRES: Record<string, number> = { centre_x_m: 0, centre_y_m: 1, v1: 0, v2: 1 };

function adderOf(
  field: (name: string) => Field,
  ofGroups: boolean,
): (entry: Iteration, row: string[]) => void {
  const [quantity, value] = [field("quantity"), field("value")];
  const [group, detection] = ofGroups
    ? [field("group"), field("detection_id")]
    : [field("track"), field("detection")];
  return (entry, row) => {
    const [name, number] = [quantity(row), Number(value(row))];
    const place = CENTRES[name];
    if (name === "J" || name === "j" || name === "cost") entry.best = number;
    else if (name === "u" || name === "membership")
      at(entry.memberships, detection(row), () => new Map<string, number>()).set(
        group(row),
        number,
      );
    else if (place !== undefined) at(entry.centres, group(row), (): number[] => [])[place] = number;
  };
}

function at<V>(map: Map<string, V>, key: string, create: () => V): V {
  const known = map.get(key);
  if (known !== undefined) return known;
  const fresh = create();
  map.set(key, fresh);
  return fresh;
}
