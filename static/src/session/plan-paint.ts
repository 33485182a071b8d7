// The plan of a live session, drawn by ourselves: detections that fade with their age, the ways of
// the tracks, and each track with its ellipse, velocity, existence and name.

import { bounds, type Camera, metresPerPixel, type Size } from "../charts/camera";
import { circle, ellipse } from "../charts/curves";
import type { Painting, Pen } from "../charts/pen";
import { paintScale } from "../charts/plan-paint";
import { type Ruler, rulerWords } from "../charts/ruler";
import type { Extent } from "../charts/scene";
import { niceStep, ticks } from "../charts/ticks";
import type { Palette } from "../state/theme";
import type { Picture } from "./api";
import type { Belief, Memory, Moment, Seen } from "./memory";
import { type Box, placed } from "./plan-labels";

/** Scans of each sensor whose detections are still seen. */
const FADE_SCANS = 12;
const MOST_FADING = 60;
const DOT_PX = 3.5;
const LONGEST_ARROW_PX = 45;
const LEAST_ARROW_PX = 6;
const LEAST_ELLIPSE_PX = 7;
const SIGMAS = 2;
const THIN_PX = 3;
const SPOT_M = 500;
const RING_PX = 7;

type Point = [number, number];
type Sensors = Picture["sensors"];

export interface LivePlan {
  memory: Memory;
  moment: Moment | undefined;
  sensors: Sensors;
  selected: string | null;
  /** Points of a way that are drawn; all when absent. */
  trail: number | undefined;
  camera: Camera;
  size: Size;
  ruler: Ruler | undefined;
  palette: Palette;
}

interface Sheet extends LivePlan {
  pen: Pen;
  place(x: number, y: number): Point;
  pixels: number;
}

/** A colour laid over another. */
function mixed(color: string, under: string, share: number): string {
  const part = (of: string, at: number) => Number.parseInt(of.slice(at, at + 2), 16);
  const channel = (at: number) =>
    Math.round(part(color, at) * share + part(under, at) * (1 - share))
      .toString(16)
      .padStart(2, "0");
  return `#${channel(1)}${channel(3)}${channel(5)}`;
}

/** Of each sensor its own, in the order in which the session lists them. */
export function sensorColor(sensors: Sensors, sensor: string, palette: Palette): string {
  const order = sensors.findIndex((each) => each.sensor_id === sensor);
  return palette.sensors[Math.max(order, 0) % palette.sensors.length] ?? palette.text;
}

/** The scans whose detections are seen at a time, oldest first. */
export function fading({ memory, moment, sensors }: LivePlan): Seen[] {
  const now = moment?.time ?? Infinity;
  const past = memory.scans.filter((scan) => scan.time <= now);
  return past.slice(-Math.min(FADE_SCANS * Math.max(sensors.length, 1), MOST_FADING));
}

/** Everything that is drawn. */
export function extentOf(plan: LivePlan): Extent | undefined {
  const points: Point[] = plan.sensors.flatMap(({ x_m, y_m }) =>
    x_m === undefined || y_m === undefined ? [] : [[x_m, y_m] as Point],
  );
  for (const scan of fading(plan))
    for (const [at, x] of scan.x.entries()) points.push([x, scan.y[at] ?? 0]);
  for (const track of plan.moment?.tracks ?? [])
    if (track.x !== undefined && track.y !== undefined) points.push([track.x, track.y]);
  if (!points.length) return undefined;
  const extent = { xMin: Infinity, xMax: -Infinity, yMin: Infinity, yMax: -Infinity };
  for (const [x, y] of points) {
    extent.xMin = Math.min(extent.xMin, x);
    extent.xMax = Math.max(extent.xMax, x);
    extent.yMin = Math.min(extent.yMin, y);
    extent.yMax = Math.max(extent.yMax, y);
  }
  const isSpot = extent.xMax - extent.xMin < 1 && extent.yMax - extent.yMin < 1;
  return isSpot ? around(extent.xMin, extent.yMin) : extent;
}

/** Of directions alone nobody knows how far away they are. */
function around(x: number, y: number): Extent {
  return { xMin: x - SPOT_M, xMax: x + SPOT_M, yMin: y - SPOT_M, yMax: y + SPOT_M };
}

function paintGrid({ pen, camera, size, palette, place }: Sheet): void {
  const view = bounds(camera, size);
  const isFar = camera.span >= 10_000;
  const text = (value: number) => String(Number((isFar ? value / 1000 : value).toPrecision(6)));
  const look = { color: palette.line, opacity: 0.5 };
  const label = { color: palette.muted, size: 10.5 };
  for (const x of ticks(view.xMin, view.xMax, size.width / 110)) {
    const [at] = place(x, 0);
    pen.line(
      [
        [at, 0],
        [at, size.height],
      ],
      look,
    );
    if (at > 40 && at < size.width - 60) pen.text(text(x), at + 3, 9, label);
  }
  for (const y of ticks(view.yMin, view.yMax, size.height / 90)) {
    const [, at] = place(0, y);
    pen.line(
      [
        [0, at],
        [size.width, at],
      ],
      look,
    );
    if (at > 24 && at < size.height - 44) pen.text(text(y), 4, at - 7, label);
  }
  pen.text(isFar ? "km" : "m", 4, 9, label);
}

function paintSensors({ pen, sensors, palette, place, size }: Sheet): void {
  for (const { sensor_id, x_m, y_m, max_range_m } of sensors) {
    if (x_m === undefined || y_m === undefined) continue;
    const [x, y] = place(x_m, y_m);
    const look = { color: palette.text, width: 1.5 };
    pen.line(
      [
        [x - 6, y],
        [x + 6, y],
      ],
      look,
    );
    pen.line(
      [
        [x, y - 6],
        [x, y + 6],
      ],
      look,
    );
    const isAtEdge = x > size.width - 90;
    const anchor = isAtEdge ? "end" : "start";
    pen.text(sensor_id, x + (isAtEdge ? -9 : 9), y + 10, { color: palette.muted, anchor });
    if (!max_range_m) continue;
    const ring = circle(x_m, y_m, max_range_m).map(([east, north]) => place(east, north));
    pen.line(ring, { color: palette.muted, dashes: [2, 3], opacity: 0.6 });
  }
}

function paintDetections(sheet: Sheet): void {
  const { pen, place, palette, sensors, size } = sheet;
  const scans = fading(sheet);
  const far = size.width + size.height;
  for (const [order, scan] of scans.entries()) {
    const share = 0.15 + (0.8 * (order + 1)) / scans.length;
    const color = mixed(sensorColor(sensors, scan.sensor, palette), palette.surface, share);
    for (const [at, east] of scan.x.entries()) {
      const [x, y] = place(east, scan.y[at] ?? 0);
      if (x > -DOT_PX && y > -DOT_PX && x < size.width && y < size.height)
        pen.rect(x - DOT_PX / 2, y - DOT_PX / 2, DOT_PX, DOT_PX, color);
    }
    const from = place(...(scan.from ?? [0, 0]));
    for (const bearing of scan.bearing) pen.line(ray(from, bearing, far), { color });
  }
}

function ray([x, y]: Point, bearing: number, length: number): Point[] {
  const angle = (bearing * Math.PI) / 180;
  return [
    [x, y],
    [x + length * Math.sin(angle), y - length * Math.cos(angle)],
  ];
}

/** A way up to the moment, without points that lie on each other on the screen. */
function wayPoints({ memory, moment, trail, place }: Sheet, id: string): Point[] {
  const way = memory.ways.get(id);
  if (!way) return [];
  const now = moment?.time ?? Infinity;
  const end = way.time.findLastIndex((time) => time <= now) + 1;
  const points: Point[] = [];
  for (let row = trail === undefined ? 0 : Math.max(end - trail, 0); row < end; row++) {
    const point = place(way.x[row] ?? 0, way.y[row] ?? 0);
    const last = points.at(-1);
    if (last && row < end - 1 && Math.hypot(point[0] - last[0], point[1] - last[1]) < THIN_PX)
      continue;
    points.push(point);
  }
  return points;
}

function colorOf({ selected, palette }: LivePlan, { id, status }: Belief): string {
  if (id === selected) return palette.selected;
  return status === "tentative" ? palette.tentative : palette.track;
}

function paintWays(sheet: Sheet): void {
  const { pen, moment, selected, palette } = sheet;
  for (const track of moment?.tracks ?? []) {
    const width = track.id === selected ? 2.6 : track.status === "tentative" ? 1 : 1.5;
    // A colour of its own is drawn faster than one that lets others through.
    const color = mixed(colorOf(sheet, track), palette.surface, 0.8);
    pen.line(wayPoints(sheet, track.id), { color, width });
  }
  if (!selected || moment?.tracks.some((track) => track.id === selected)) return;
  // One that has ended has no place any more.
  const points = wayPoints(sheet, selected);
  const end = points.at(-1);
  if (!end) return;
  pen.line(points, { color: palette.muted, width: 2.6 });
  pen.shape("M-5 -5L5 5M5 -5L-5 5", ...end, { stroke: palette.muted });
}

/** How many seconds the arrows show: a round number, so that the longest is not too long. */
export function arrowSeconds({ moment }: LivePlan, pixels: number): number | undefined {
  const confirmed = (moment?.tracks ?? []).filter((track) => track.status !== "tentative");
  const fastest = Math.max(0, ...confirmed.map(({ vx, vy }) => Math.hypot(vx, vy)));
  if (fastest === 0) return undefined;
  const most = LONGEST_ARROW_PX / (fastest * pixels);
  const next = niceStep(most, 1);
  // The round number below, not above.
  return next > most ? niceStep(most / 2.5, 1) : next;
}

/** Where the arrow of a track ends on the screen; none where it would not be seen. */
function arrowTip({ pixels }: Sheet, track: Belief, [x, y]: Point, seconds: number | undefined) {
  if (!seconds || track.status === "tentative") return undefined;
  const [dx, dy] = [track.vx * seconds * pixels, -track.vy * seconds * pixels];
  return Math.hypot(dx, dy) < LEAST_ARROW_PX ? undefined : ([x + dx, y + dy] as Point);
}

function paintArrow({ pen, palette }: Sheet, [x, y]: Point, tip: Point): void {
  const [dx, dy] = [tip[0] - x, tip[1] - y];
  const length = Math.hypot(dx, dy);
  const [ux, uy] = [dx / length, dy / length];
  const side = (by: number): Point => [tip[0] - 5 * ux - by * uy, tip[1] - 5 * uy + by * ux];
  const look = { color: palette.text, width: 1.2 };
  pen.line([[x, y], tip], look);
  pen.line([side(2.5), tip, side(-2.5)], look);
}

/** What an arrow covers, for names that keep off it. */
function arrowBoxes([x, y]: Point, tip: Point): Box[] {
  const steps = Math.ceil(Math.hypot(tip[0] - x, tip[1] - y) / 6);
  return Array.from({ length: steps }, (_, step): Box => {
    const share = (step + 1) / steps;
    const [at, down] = [x + (tip[0] - x) * share, y + (tip[1] - y) * share];
    return { x: at - 2, y: down - 2, width: 4, height: 4 };
  });
}

/** How sure it is that there is a target: so much of a ring. */
function paintExistence(pen: Pen, [x, y]: Point, share: number, color: string): void {
  const steps = Math.max(2, Math.ceil(24 * share));
  const points = Array.from({ length: steps + 1 }, (_, step): Point => {
    const angle = (step / steps) * share * 2 * Math.PI;
    return [x + RING_PX * Math.sin(angle), y - RING_PX * Math.cos(angle)];
  });
  pen.line(points, { color, width: 1.5 });
}

function paintEllipse({ pen, pixels, place }: Sheet, track: Belief, color: string): void {
  const { x, y, covariance } = track;
  if (x === undefined || y === undefined || !covariance) return;
  const radius = SIGMAS * Math.sqrt(Math.max(covariance[0], covariance[2])) * pixels;
  if (!(radius > LEAST_ELLIPSE_PX)) return;
  const points = ellipse(x, y, covariance, SIGMAS).filter((_, step) => step % 3 === 0);
  pen.line(
    points.map(([east, north]) => place(east, north)),
    { color, opacity: 0.55 },
  );
}

/** The place of a track on the screen; of one that is a direction, on its ray. */
function headOf({ place, sensors, size }: Sheet, track: Belief): Point | undefined {
  if (track.x !== undefined && track.y !== undefined) return place(track.x, track.y);
  if (track.bearing === undefined) return undefined;
  const site = sensors.find((sensor) => sensor.x_m !== undefined);
  const from = place(site?.x_m ?? 0, site?.y_m ?? 0);
  return ray(from, track.bearing, 0.38 * Math.min(size.width, size.height))[1];
}

const RANKS = ["confirmed", "coasted", "tentative"];

/** The selected one first, then what is believed most. */
export function ranked(tracks: Belief[], selected: string | null): Belief[] {
  const rank = ({ id, status }: Belief) => (id === selected ? -1 : RANKS.indexOf(status));
  return tracks.toSorted((a, b) => rank(a) - rank(b) || Number(a.id) - Number(b.id));
}

function paintTracks(sheet: Sheet): void {
  const { pen, moment, selected, palette, pixels, size } = sheet;
  const heads = ranked(moment?.tracks ?? [], selected).flatMap((track) => {
    const head = headOf(sheet, track);
    const isSeen =
      head &&
      head[0] > -20 &&
      head[1] > -20 &&
      head[0] < size.width + 20 &&
      head[1] < size.height + 20;
    return head && isSeen ? [{ track, head }] : [];
  });
  const seconds = arrowSeconds(sheet, pixels);
  for (const { track, head } of heads.toReversed()) {
    const color = colorOf(sheet, track);
    const isTentative = track.status === "tentative";
    if (track.bearing !== undefined) {
      const site = sheet.sensors.find((sensor) => sensor.x_m !== undefined);
      const from = sheet.place(site?.x_m ?? 0, site?.y_m ?? 0);
      pen.line(ray(from, track.bearing, size.width + size.height), { color, width: 1.5 });
    }
    paintEllipse(sheet, track, color);
    const tip = arrowTip(sheet, track, head, seconds);
    if (tip) paintArrow(sheet, head, tip);
    if (track.existence !== undefined) paintExistence(pen, head, track.existence, color);
    pen.circle(...head, isTentative ? 2.5 : 4, palette.surface);
    pen.circle(...head, isTentative ? 2.5 : 4, color, track.status !== "confirmed");
    if (track.id === selected) pen.circle(...head, 10, palette.selected, true);
  }
  paintNames(sheet, heads, seconds);
}

function paintNames(
  sheet: Sheet,
  heads: { track: Belief; head: Point }[],
  seconds: number | undefined,
): void {
  const marks = heads.flatMap(({ track, head }): Box[] => {
    const tip = arrowTip(sheet, track, head, seconds);
    const [x, y] = head;
    const mark = { x: x - 4, y: y - 4, width: 8, height: 8 };
    return tip ? [mark, ...arrowBoxes(head, tip)] : [mark];
  });
  const names = heads.map(({ track, head: [x, y] }) => ({ name: track.id, x, y }));
  const tracks = new Map(heads.map(({ track }) => [track.id, track]));
  for (const { name, x, y, anchor } of placed(names, marks)) {
    const track = tracks.get(name);
    const isTentative = track?.status === "tentative" && name !== sheet.selected;
    const color = isTentative || !track ? sheet.palette.muted : colorOf(sheet, track);
    sheet.pen.text(name, x, y, { color, anchor, weight: name === sheet.selected ? 600 : 400 });
  }
}

function paintRuler({ pen, ruler, palette, place }: Sheet): void {
  const ends = [ruler?.from, ruler?.to].flatMap((spot) => (spot ? [place(spot.x, spot.y)] : []));
  pen.line(ends, { color: palette.text, width: 1.6 });
  for (const [x, y] of ends) pen.rect(x - 3, y - 3, 6, 6, palette.text);
  const [from, to] = ends;
  const words = rulerWords(ruler ?? {});
  if (!from || !to || !words) return;
  const [x, y] = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2 - 14];
  pen.rect(x - words.length * 3.6, y - 9, words.length * 7.2, 18, palette.surface);
  pen.text(words, x, y, { color: palette.text, size: 12, anchor: "middle" });
}

export function livePainting(plan: LivePlan): Painting {
  const { camera, size, palette } = plan;
  const pixels = 1 / metresPerPixel(camera, size);
  const view = bounds(camera, size);
  const place = (x: number, y: number): Point => [
    (x - view.xMin) * pixels,
    (view.yMax - y) * pixels,
  ];
  return {
    ...size,
    paint: (pen) => {
      const sheet = { ...plan, pen, place, pixels };
      pen.rect(0, 0, size.width, size.height, palette.surface);
      pen.within([0, 0, size.width, size.height], () => {
        paintGrid(sheet);
        paintScale(pen, size, pixels, palette);
        paintSensors(sheet);
        paintDetections(sheet);
        paintWays(sheet);
        paintTracks(sheet);
        paintRuler(sheet);
      });
    },
  };
}

/** The track whose mark or way lies nearest to a point of the screen, within reach. */
export function trackNear(plan: LivePlan, x: number, y: number, reach: number): string | undefined {
  const pixels = 1 / metresPerPixel(plan.camera, plan.size);
  const view = bounds(plan.camera, plan.size);
  const place = (east: number, north: number): Point => [
    (east - view.xMin) * pixels,
    (view.yMax - north) * pixels,
  ];
  const sheet = { ...plan, place, pixels } as Sheet;
  let best: { id: string; distance: number } | undefined;
  for (const track of plan.moment?.tracks ?? []) {
    const head = headOf(sheet, track);
    const points = head ? [head, ...wayPoints(sheet, track.id)] : [];
    for (const [order, [px, py]] of points.entries()) {
      // A mark goes before a way that passes it.
      const distance = Math.hypot(px - x, py - y) + (order ? reach / 2 : 0);
      if (distance <= reach && distance < (best?.distance ?? Infinity))
        best = { id: track.id, distance };
    }
  }
  return best?.id;
}
