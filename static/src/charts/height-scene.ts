// The heights of a job sorted out for drawing: one line a truth and a track, one cloud a sensor.
// Points without a height are left out.

import type { Plan } from "../api/types";

export interface HeightLine {
  id: string;
  time: number[];
  height: number[];
}

export interface HeightCloud {
  sensor: string;
  points: { id: string; time: number; height: number }[];
}

export interface HeightScene {
  truths: Map<string, HeightLine>;
  tracks: Map<string, HeightLine>;
  clouds: HeightCloud[];
}

type Heights = (number | null)[] | undefined;

function linesOf(ids: string[], times: number[], heights: Heights): Map<string, HeightLine> {
  const lines = new Map<string, HeightLine>();
  heights?.forEach((height, row) => {
    const [id, time] = [ids[row], times[row]];
    if (height === null || id === undefined || time === undefined) return;
    const line = lines.get(id) ?? { id, time: [], height: [] };
    lines.set(id, line);
    line.time.push(time);
    line.height.push(height);
  });
  return lines;
}

/** In the order that the plan has its sensors in, so that colours are the same. */
function cloudsOf({ columns }: Plan["detections"]): HeightCloud[] {
  const names = [...new Set(columns.sensor_id)].sort((a, b) => (a < b ? -1 : 1));
  const clouds = names.map((sensor): HeightCloud => ({ sensor, points: [] }));
  columns.height_m?.forEach((height, row) => {
    const cloud = clouds.find(({ sensor }) => sensor === columns.sensor_id[row]);
    const time = columns.time_s[row];
    if (height === null || time === undefined) return;
    cloud?.points.push({ id: columns.detection_id[row] ?? "", time, height });
  });
  return clouds;
}

/** `undefined` where nothing has a height. */
export function heightScene(plan: Plan): HeightScene | undefined {
  const { truth, tracks, detections } = plan;
  const parts = [truth.columns, tracks.columns, detections.columns];
  if (parts.every((columns) => columns.height_m === undefined)) return undefined;
  return {
    truths: linesOf(truth.columns.truth_id, truth.columns.time_s, truth.columns.height_m),
    tracks: linesOf(tracks.columns.track_id, tracks.columns.time_s, tracks.columns.height_m),
    clouds: cloudsOf(detections),
  };
}
