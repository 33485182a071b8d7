// The bearings of a job sorted out for drawing: one line a truth and a track, one cloud of
// detections.

import type { BearingTime } from "../api/types";

export interface BearingLine {
  id: string;
  time: number[];
  bearing: number[];
  rate: (number | null)[];
  sigma: (number | null)[];
  detection: (string | null)[];
}

export interface BearingScene {
  truths: Map<string, BearingLine>;
  tracks: Map<string, BearingLine>;
  detections: { id: string; time: number; bearing: number }[];
}

export function bearingScene(series: BearingTime): BearingScene {
  const scene: BearingScene = { truths: new Map(), tracks: new Map(), detections: [] };
  const { time_s, layer, id, bearing_deg, bearing_rate_degps, sigma_bearing_deg, detection_id } =
    series.columns;
  time_s.forEach((time, row) => {
    const name = id[row] ?? "";
    const bearing = bearing_deg[row] ?? 0;
    if (layer[row] === "detection") {
      scene.detections.push({ id: name, time, bearing });
      return;
    }
    const lines = layer[row] === "truth" ? scene.truths : scene.tracks;
    const line = lines.get(name) ?? {
      id: name,
      time: [],
      bearing: [],
      rate: [],
      sigma: [],
      detection: [],
    };
    lines.set(name, line);
    line.time.push(time);
    line.bearing.push(bearing);
    line.rate.push(bearing_rate_degps[row] ?? null);
    line.sigma.push(sigma_bearing_deg[row] ?? null);
    line.detection.push(detection_id[row] ?? null);
  });
  return scene;
}

export type Spot = [number, number];
const BREAK: Spot = [NaN, NaN];

/** Bearing over time, cut where it goes through north: no line runs across the picture. */
export function unwrapped(line: BearingLine, from: number, to: number, origin: number): Spot[] {
  const spots: Spot[] = [];
  let before: number | undefined;
  line.time.forEach((time, row) => {
    const bearing = line.bearing[row] ?? 0;
    if (time < from - 1e-9 || time > to + 1e-9) return;
    if (before !== undefined && Math.abs(bearing - before) > 180) spots.push(BREAK);
    spots.push([bearing, time - origin]);
    before = bearing;
  });
  return spots.length ? [...spots, BREAK] : [];
}
