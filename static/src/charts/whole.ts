// Of a job that is too large to be drawn whole the plan holds a part of the points. What is
// selected and the scans about the clock are fetched whole and put into it.

import type { Cell, Columns, Plan } from "../api/types";

export interface LayerPart {
  columns: Columns;
  source_points: number;
  returned_points: number;
}

export const isWhole = (plan: Plan): boolean =>
  [plan.truth, plan.detections, plan.tracks].every(
    (layer) => layer.returned_points === layer.source_points,
  );

const NAMES = { truth: "truth_id", detections: "detection_id", tracks: "track_id" } as const;

/** The rows of `more` that are new, behind those of `columns`; a row is its time and its name. */
function joined(columns: Columns, more: Columns[], name: string): Columns {
  const key = (of: Columns, row: number) =>
    `${of.time_s?.[row]} ${of.sensor_id?.[row] ?? ""} ${of[name]?.[row]}`;
  const seen = new Set<string>();
  const sources = [columns, ...more].map((of) => {
    const rows: number[] = [];
    for (let row = 0; row < (of.time_s?.length ?? 0); row++) {
      const own = key(of, row);
      if (seen.has(own)) continue;
      seen.add(own);
      rows.push(row);
    }
    return { of, rows };
  });
  const column = (each: string): Cell[] =>
    sources.flatMap(({ of, rows }) => rows.map((row) => of[each]?.[row] ?? null));
  return Object.fromEntries(Object.keys(columns).map((each) => [each, column(each)]));
}

/** The plan with the points of the others in it; its counts stay those of the part. */
export function withMore(plan: Plan, parts: (Plan | undefined)[]): Plan {
  const more = parts.filter((part) => part !== undefined);
  if (!more.length) return plan;
  const layer = (which: keyof typeof NAMES) => ({
    ...plan[which],
    columns: joined(
      plan[which].columns as unknown as Columns,
      more.map((part) => part[which].columns as unknown as Columns),
      NAMES[which],
    ),
  });
  const layers = {
    truth: layer("truth"),
    detections: layer("detections"),
    tracks: layer("tracks"),
  };
  return { ...plan, ...layers } as unknown as Plan;
}
