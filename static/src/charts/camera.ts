// Where the plan view looks: a centre and the metres across its shorter side. One metre east is
// always as many pixels as one metre north.

import type { Extent, Scene } from "./scene";
import { at } from "./scene";

export interface Camera {
  x: number;
  y: number;
  /** Metres across the shorter side of the drawing area. */
  span: number;
}

export interface Size {
  width: number;
  height: number;
}

const LEAST_SPAN_M = 1;
const GREATEST_SPAN_M = 1e8;
const AROUND_SCANS = 6;

export function metresPerPixel(camera: Camera, size: Size): number {
  return camera.span / Math.max(Math.min(size.width, size.height), 1);
}

/** Everything in view, with a small margin. */
export function fit(extent: Extent, size: Size, margin = 1.06): Camera {
  const width = Math.max(extent.xMax - extent.xMin, LEAST_SPAN_M);
  const height = Math.max(extent.yMax - extent.yMin, LEAST_SPAN_M);
  const shorter = Math.max(Math.min(size.width, size.height), 1);
  const scale = Math.max(width / Math.max(size.width, 1), height / Math.max(size.height, 1));
  return {
    x: (extent.xMin + extent.xMax) / 2,
    y: (extent.yMin + extent.yMax) / 2,
    span: scale * shorter * margin,
  };
}

export function bounds(camera: Camera, size: Size): Extent {
  const scale = metresPerPixel(camera, size);
  const halfWidth = (size.width * scale) / 2;
  const halfHeight = (size.height * scale) / 2;
  return {
    xMin: camera.x - halfWidth,
    xMax: camera.x + halfWidth,
    yMin: camera.y - halfHeight,
    yMax: camera.y + halfHeight,
  };
}

/** Zooms by `factor` so that the point (x, y) stays under the pointer. */
export function zoomed(camera: Camera, factor: number, x = camera.x, y = camera.y): Camera {
  const span = Math.min(Math.max(camera.span * factor, LEAST_SPAN_M), GREATEST_SPAN_M);
  const real = span / camera.span;
  return { x: x + (camera.x - x) * real, y: y + (camera.y - y) * real, span };
}

/**
 * Looks at the selected truth and track: near `time` when there is one, at their whole way
 * otherwise.
 */
export function lookAt(
  scene: Scene,
  selected: { truth: string | null; track: string | null },
  time: number | null,
  size: Size,
): Camera | undefined {
  const lines = [
    scene.truths.get(selected.truth ?? ""),
    scene.tracks.get(selected.track ?? ""),
  ].filter((line) => line !== undefined);
  const period =
    ((scene.times.at(-1) ?? 0) - (scene.times[0] ?? 0)) / Math.max(scene.times.length - 1, 1);
  const reach = time === null ? Infinity : AROUND_SCANS * period + 1e-9;
  const near = lines.flatMap((line) =>
    line.time.flatMap((when, row) =>
      Math.abs(when - (time ?? 0)) <= reach || time === null
        ? [[line.x[row] ?? 0, line.y[row] ?? 0] as const]
        : [],
    ),
  );
  if (!near.length) return undefined;
  const xs = near.map(([x]) => x);
  const ys = near.map(([, y]) => y);
  const box = {
    xMin: Math.min(...xs),
    xMax: Math.max(...xs),
    yMin: Math.min(...ys),
    yMax: Math.max(...ys),
  };
  const camera = fit(box, size, 1.5);
  const middle = time === null ? undefined : lines[0] && at(lines[0], time);
  return middle ? { x: middle.x, y: middle.y, span: camera.span * 1.2 } : camera;
}

export function toText(camera: Camera): { centre: string; span: string } {
  const digits = Math.max(0, 3 - Math.floor(Math.log10(camera.span)));
  const round = (value: number) => String(Number(value.toFixed(Math.min(digits, 6))));
  return { centre: `${round(camera.x)},${round(camera.y)}`, span: round(camera.span) };
}

export function fromText(centre: string | null, span: string | null): Camera | undefined {
  const [x, y] = (centre ?? "").split(",").map(Number);
  const metres = Number(span);
  if (x === undefined || y === undefined || ![x, y, metres].every(Number.isFinite) || metres <= 0)
    return undefined;
  return { x, y, span: metres };
}
