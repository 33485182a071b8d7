// The gates of a track: where it looked for its detections at a scan, as curves in the plane.

import type { Gates } from "../api/types";
import { ellipse, type Point } from "./curves";

/** Rows of the gates at a time; one for each sensor that scanned then. */
export function gatesAt(gates: Gates | undefined, track: string | null, time: number): number[] {
  if (!gates || gates.threshold === null || gates.threshold === undefined) return [];
  const { time_s, track_id } = gates.columns;
  return time_s.flatMap((when, row) =>
    Math.abs(when - time) <= 1e-9 && track_id[row] === track ? [row] : [],
  );
}

/**
 * The edge of a gate: an ellipse over places; over ranges and bearings what that is in the plane.
 */
export function outline(gates: Gates, row: number): Point[] {
  const { columns } = gates;
  const sigma = Math.sqrt(gates.threshold ?? 0);
  const known = (column: (number | null)[]) => column[row] ?? 0;
  if (columns.s_xx[row] !== null)
    return ellipse(
      known(columns.x_m),
      known(columns.y_m),
      [known(columns.s_xx), known(columns.s_xy), known(columns.s_yy)],
      sigma,
    );
  const edge = ellipse(
    known(columns.range_m),
    known(columns.bearing_deg),
    [known(columns.s_rr), known(columns.s_rb), known(columns.s_bb)],
    sigma,
  );
  return edge.map(([range, bearing]) => {
    const [length, angle] = [Math.max(range, 0), (bearing * Math.PI) / 180];
    return [
      known(columns.sensor_x_m) + length * Math.sin(angle),
      known(columns.sensor_y_m) + length * Math.cos(angle),
    ];
  });
}

/** Standard deviations of the innovation, with their units. */
export function innovationWords(
  { columns }: Gates,
  row: number,
  length: (value: number) => string,
): string {
  const root = (column: (number | null)[]) => Math.sqrt(column[row] ?? 0);
  if (columns.s_xx[row] !== null)
    return `${length(root(columns.s_xx))}, ${length(root(columns.s_yy))} m`;
  return `${length(root(columns.s_rr))} m, ${Number(root(columns.s_bb).toPrecision(3))}°`;
}

/** How far a place is from what was expected, and how probable that was. */
export interface Fit {
  squaredDistance: number;
  likelihood: number;
  /** Of the likelihood. */
  unit: string;
}

/** νᵀ S⁻¹ ν and the density N(ν; 0, S) of an innovation of two numbers. */
function fitOf(
  [a, b]: [number, number],
  [aa, ab, bb]: [number, number, number],
  unit: string,
): Fit | undefined {
  const determinant = aa * bb - ab * ab;
  if (!(determinant > 0)) return undefined;
  const squaredDistance = (bb * a * a - 2 * ab * a * b + aa * b * b) / determinant;
  const likelihood = Math.exp(-squaredDistance / 2) / (2 * Math.PI * Math.sqrt(determinant));
  return { squaredDistance, likelihood, unit };
}

/** How a detection at a place fits to what a gate expected. */
export function fitIn({ columns }: Gates, row: number, place: { x: number; y: number }) {
  const known = (column: (number | null)[]) => column[row] ?? 0;
  if (columns.s_xx[row] !== null)
    return fitOf(
      [place.x - known(columns.x_m), place.y - known(columns.y_m)],
      [known(columns.s_xx), known(columns.s_xy), known(columns.s_yy)],
      "1/m²",
    );
  const [east, north] = [place.x - known(columns.sensor_x_m), place.y - known(columns.sensor_y_m)];
  const range = Math.hypot(east, north);
  const bearing = (Math.atan2(east, north) * 180) / Math.PI;
  const turn = bearing - known(columns.bearing_deg);
  const around = turn - 360 * Math.round(turn / 360);
  return fitOf(
    [range - known(columns.range_m), around],
    [known(columns.s_rr), known(columns.s_rb), known(columns.s_bb)],
    "1/(m·deg)",
  );
}
