// What the plan view draws at one moment: rings, truth, detections, tracks, the selected one with
// its ellipses.

import type { Gates, SensorSettings } from "../api/types";
import type { Palette } from "../state/theme";
import { circle, ellipse, type Point } from "./curves";
import type { SeriesOption } from "./echarts";
import { gatesAt, outline } from "./gates";
import {
  at,
  type Cloud,
  hasEnded,
  isAlive,
  type Line,
  memberName,
  type Scene,
  type TrackLine,
  within,
} from "./scene";

export const SHAPES = ["circle", "rect", "triangle", "diamond", "pin"];
const LABELS_UP_TO = 12;
const ONE_BY_ONE_UP_TO = 2000;

export interface Moment {
  /** Data from `from` to `now` is drawn. */
  from: number;
  now: number;
  hidden: Set<string>;
  truth: string | null;
  track: string | null;
}

const BREAK = [NaN, NaN] as Point;

function points(line: Line, from: number, to: number): Point[] {
  const [first, end] = within(line.time, from, to);
  return line.x.slice(first, end).map((x, offset) => [x, line.y[first + offset] ?? 0]);
}

/** Many lines as one series: a gap stands between them. */
function joined(lines: Point[][]): Point[] {
  return lines.filter((line) => line.length).flatMap((line) => [...line, BREAK]);
}

/**
 * Points one after the other: the chart copies such a list in one go, and a list of lists piece by
 * piece. Its types know lists only.
 */
function packed(rows: readonly (readonly number[])[]): number[][] {
  const width = rows[0]?.length ?? 0;
  const values = new Float64Array(rows.length * width);
  for (const [index, row] of rows.entries()) values.set(row, index * width);
  return values as unknown as number[][];
}

function lineSeries(
  id: string,
  data: Point[],
  color: string,
  style: { width: number; type?: "solid" | "dashed" | "dotted"; opacity?: number; z?: number },
): SeriesOption {
  const { width, type = "solid", opacity = 1, z = 2 } = style;
  return {
    type: "line",
    id,
    dimensions: ["x", "y"],
    data: packed(data),
    showSymbol: false,
    silent: true,
    animation: false,
    z,
    lineStyle: { color, width, type, opacity },
  };
}

/** The runs of a track that have one status; each begins where the one before ended. */
function runs(track: TrackLine, from: number, to: number): { status: string; points: Point[] }[] {
  const [first, end] = within(track.time, from, to);
  const result: { status: string; points: Point[] }[] = [];
  for (let row = first; row < end; row++) {
    const point: Point = [track.x[row] ?? 0, track.y[row] ?? 0];
    const status = track.status[row] ?? "confirmed";
    const last = result.at(-1);
    if (last?.status === status) last.points.push(point);
    else
      result.push({
        status,
        points: row > first ? [[track.x[row - 1] ?? 0, track.y[row - 1] ?? 0], point] : [point],
      });
  }
  return result;
}

function rings(sensors: SensorSettings[], palette: Palette): SeriesOption[] {
  const placed = sensors.filter(
    (sensor) => typeof sensor.x_m === "number" && typeof sensor.y_m === "number",
  );
  const ranges = placed.filter((sensor) => sensor.max_range_m);
  const curves = ranges.flatMap((sensor) =>
    [1, 0.5].map((part) =>
      circle(sensor.x_m ?? 0, sensor.y_m ?? 0, (sensor.max_range_m ?? 0) * part),
    ),
  );
  return [
    lineSeries("rings", joined(curves), palette.muted, {
      width: 1,
      type: "dotted",
      opacity: 0.6,
      z: 1,
    }),
    {
      type: "scatter",
      id: "sensors",
      data: placed.map((sensor) => ({
        name: sensor.sensor_id,
        value: [sensor.x_m ?? 0, sensor.y_m ?? 0],
      })),
      symbol: "path://M0 -6V6M-6 0H6",
      symbolSize: 11,
      itemStyle: { color: "transparent", borderColor: palette.text, borderWidth: 1.5 },
      animation: false,
      z: 3,
    },
  ];
}

/** The shape of a sensor's detections; of very many the chart draws small squares. */
export function detectionSymbol(count: number, order: number): string {
  return count > ONE_BY_ONE_UP_TO ? "rect" : (SHAPES[order % SHAPES.length] ?? "circle");
}

/** How many detections of a sensor are drawn. */
export function drawnDetections(cloud: Cloud, moment: Moment): number {
  const [first, end] = within(cloud.time, moment.from, moment.now);
  return end - first;
}

function detections(cloud: Cloud, order: number, moment: Moment, palette: Palette): SeriesOption {
  const [first, end] = within(cloud.time, moment.from, moment.now);
  const data: [number, number, number][] = [];
  for (let row = first; row < end; row++) data.push([cloud.x[row] ?? 0, cloud.y[row] ?? 0, row]);
  const isLarge = data.length > ONE_BY_ONE_UP_TO;
  return {
    type: "scatter",
    id: `detections:${cloud.sensor}`,
    dimensions: ["x", "y", "row"],
    data: packed(data),
    symbol: detectionSymbol(data.length, order),
    symbolSize: isLarge ? 3 : 4.5,
    // Beyond that the whole cloud is one shape: a shape a point takes seconds to draw.
    large: isLarge,
    largeThreshold: ONE_BY_ONE_UP_TO,
    itemStyle: {
      color: palette.sensors[order % palette.sensors.length] ?? palette.text,
      opacity: 0.75,
    },
    progressive: 0,
    animation: false,
    z: 2,
  };
}

function tracks(scene: Scene, moment: Moment, palette: Palette): SeriesOption[] {
  const byStatus: Record<string, Point[][]> = { confirmed: [], coasted: [], tentative: [] };
  for (const track of scene.tracks.values()) {
    for (const run of runs(track, moment.from, moment.now))
      (byStatus[run.status] ?? byStatus.confirmed)?.push(run.points);
  }
  return [
    lineSeries("tracks:tentative", joined(byStatus.tentative ?? []), palette.tentative, {
      width: 1,
      z: 3,
    }),
    lineSeries("tracks:confirmed", joined(byStatus.confirmed ?? []), palette.track, {
      width: 1.6,
      z: 4,
    }),
    lineSeries("tracks:coasted", joined(byStatus.coasted ?? []), palette.track, {
      width: 1.6,
      type: "dashed",
      z: 4,
    }),
    heads(scene, moment, palette),
  ];
}

/** A marker on each track that lives now; a hollow one while it coasts. */
function heads(scene: Scene, moment: Moment, palette: Palette): SeriesOption {
  const alive = [...scene.tracks.values()].filter((track) => isAlive(scene, track, moment.now));
  const data = alive.map((track) => {
    const here = at(track, moment.now);
    const status = track.status[here?.index ?? 0];
    return {
      name: track.id,
      value: [here?.x ?? 0, here?.y ?? 0],
      symbolSize: status === "tentative" ? 5 : 8,
      itemStyle: { color: status === "confirmed" ? palette.track : palette.surface },
    };
  });
  return {
    type: "scatter",
    id: "heads",
    data,
    symbol: "circle",
    itemStyle: { borderColor: palette.track, borderWidth: 1.5 },
    label: {
      show: data.length <= LABELS_UP_TO,
      formatter: "{b}",
      position: "right",
      color: palette.track,
      fontSize: 11,
    },
    progressive: 0,
    animation: false,
    z: 5,
  };
}

/**
 * The chosen truth and track; what has ended has no place now, and so no ring and no ellipses:
 * grey, with a cross at its end.
 */
function selection(
  scene: Scene,
  gates: Gates | undefined,
  moment: Moment,
  palette: Palette,
): SeriesOption[] {
  const { from, now } = moment;
  const truth = moment.hidden.has("truth") ? undefined : scene.truths.get(moment.truth ?? "");
  const track = scene.tracks.get(moment.track ?? "");
  const here = track && isAlive(scene, track, now) ? at(track, now) : undefined;
  const covariance = here && track?.covariance[here.index];
  const curves =
    here && covariance ? [1, 2, 3].map((sigma) => ellipse(here.x, here.y, covariance, sigma)) : [];
  const edges =
    gates && !moment.hidden.has("gate")
      ? gatesAt(gates, moment.track, now).map((row) => outline(gates, row))
      : [];
  const chosen = [truth, track].filter((line) => line !== undefined);
  const placeOf = (line: Line): Point => [line.x.at(-1) ?? 0, line.y.at(-1) ?? 0];
  const rings = chosen
    .filter((line) => isAlive(scene, line, now))
    .flatMap((line) => at(line, now) ?? []);
  const color = track && hasEnded(scene, track, now) ? palette.muted : palette.selected;
  return [
    lineSeries("selected:truth", truth ? points(truth, from, now) : [], palette.truth, {
      width: 3,
      z: 6,
    }),
    lineSeries("selected:track", track ? points(track, from, now) : [], color, {
      width: 2.6,
      z: 7,
    }),
    lineSeries("selected:ellipses", joined(curves), palette.selected, { width: 1.2, z: 7 }),
    lineSeries("selected:gate", joined(edges), palette.text, { width: 1.2, type: "dashed", z: 7 }),
    spots(
      "selected:now",
      rings.map(({ x, y }): Point => [x, y]),
      "circle",
      16,
      palette.selected,
    ),
    spots(
      "selected:end",
      track && hasEnded(scene, track, now) ? [placeOf(track)] : [],
      CROSS,
      9,
      palette.muted,
    ),
  ];
}

const CROSS = "path://M-5 -5L5 5M5 -5L-5 5";

function spots(
  id: string,
  data: Point[],
  symbol: string,
  symbolSize: number,
  borderColor: string,
): SeriesOption {
  const itemStyle = { color: "transparent", borderColor, borderWidth: 2 };
  return {
    type: "scatter",
    id,
    data,
    symbol,
    symbolSize,
    silent: true,
    itemStyle,
    animation: false,
    z: 8,
  };
}

const DASHES = ["dashed", "dotted", "solid"] as const;

/** The tracks of each sensor, thin; those of the selected system track bold. */
function localTracks(scene: Scene, moment: Moment, palette: Palette): SeriesOption[] {
  const members = scene.members.get(moment.track ?? "");
  return scene.locals.flatMap(({ sensor, lines }, order) => {
    if (moment.hidden.has(`l:${sensor}`)) return [];
    const color = palette.sensors[order % palette.sensors.length] ?? palette.text;
    const type = DASHES[order % DASHES.length] ?? "solid";
    const isChosen = (line: Line) => members?.has(memberName(sensor, line.id)) ?? false;
    const drawn = (chosen: boolean) =>
      joined(
        lines
          .filter((line) => isChosen(line) === chosen)
          .map((line) => points(line, moment.from, moment.now)),
      );
    return [
      lineSeries(`local:${sensor}`, drawn(false), color, {
        width: 1,
        type,
        opacity: members ? 0.45 : 0.85,
        z: 3,
      }),
      lineSeries(`local:${sensor}:chosen`, drawn(true), color, { width: 2.6, type, z: 6 }),
    ];
  });
}

/** What belongs to the whole picture, whatever the moment. */
export interface Surroundings {
  scene: Scene;
  sensors: SensorSettings[];
  gates: Gates | undefined;
  /** False where a density stands for the detections. */
  dots: boolean;
}

export function planSeries(
  { scene, sensors, gates, dots }: Surroundings,
  moment: Moment,
  palette: Palette,
): SeriesOption[] {
  const shown = (layer: string) => !moment.hidden.has(layer);
  const truth = joined(
    [...scene.truths.values()].map((line) => points(line, moment.from, moment.now)),
  );
  return [
    ...(shown("rings") ? rings(sensors, palette) : []),
    ...(shown("truth")
      ? [lineSeries("truth", truth, palette.truth, { width: 1.4, opacity: 0.65 })]
      : []),
    ...scene.clouds.flatMap((cloud, order) =>
      dots && shown(`d:${cloud.sensor}`) ? [detections(cloud, order, moment, palette)] : [],
    ),
    ...localTracks(scene, moment, palette),
    ...(shown("tracks") ? tracks(scene, moment, palette) : []),
    ...selection(scene, gates, moment, palette),
  ];
}

/**
 * The truth or track drawn nearest to a point, if one is within `reach` metres. Tracks win over
 * truth.
 */
export function nearest(
  scene: Scene,
  moment: Moment,
  x: number,
  y: number,
  reach: number,
): { track: string } | { truth: string } | undefined {
  const closest = (lines: Iterable<Line>): { id: string; distance: number } | undefined => {
    let best: { id: string; distance: number } | undefined;
    for (const line of lines) {
      const [first, end] = within(line.time, moment.from, moment.now);
      for (let row = first; row < end; row++) {
        const distance = toSegment(line, Math.max(row - 1, first), row, x, y);
        if (distance <= reach && (!best || distance < best.distance))
          best = { id: line.id, distance };
      }
    }
    return best;
  };
  const track = moment.hidden.has("tracks") ? undefined : closest(scene.tracks.values());
  const truth = moment.hidden.has("truth") ? undefined : closest(scene.truths.values());
  if (track && (!truth || track.distance <= truth.distance + reach / 2)) return { track: track.id };
  return truth ? { truth: truth.id } : undefined;
}

function toSegment(line: Line, from: number, to: number, x: number, y: number): number {
  const [x0, y0, x1, y1] = [line.x[from] ?? 0, line.y[from] ?? 0, line.x[to] ?? 0, line.y[to] ?? 0];
  const length = (x1 - x0) ** 2 + (y1 - y0) ** 2;
  const along =
    length === 0
      ? 0
      : Math.min(1, Math.max(0, ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length));
  return Math.hypot(x - (x0 + along * (x1 - x0)), y - (y0 + along * (y1 - y0)));
}
