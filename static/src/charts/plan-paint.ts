// The plan drawn by ourselves: truth, detections and tracks up to a moment, with a scale bar. Pages
// without the chart library show it.

import type { Palette } from "../state/theme";
import { bounds, fit, type Size } from "./camera";
import type { Painting, Pen } from "./pen";
import { at, isAlive, type Line, type Scene, within } from "./scene";
import { niceStep } from "./ticks";

interface PlanProps {
  scene: Scene;
  size: Size;
  /** Data from `from` to `now` are drawn. */
  from: number;
  now: number;
  track: string | null;
  truth: string | null;
  palette: Palette;
}

type Place = (x: number, y: number) => [number, number];

function placeIn(scene: Scene, size: Size): { place: Place; pixels: number } {
  const view = bounds(fit(scene.extent, size), size);
  const pixels = size.width / (view.xMax - view.xMin);
  return { place: (x, y) => [(x - view.xMin) * pixels, (view.yMax - y) * pixels], pixels };
}

const pointsOf = (line: Line, { from, now }: PlanProps, place: Place): [number, number][] => {
  const [first, end] = within(line.time, from, now);
  return line.x.slice(first, end).map((x, row) => place(x, line.y[first + row] ?? 0));
};

function paintDetections(pen: Pen, { scene, from, now, palette }: PlanProps, place: Place): void {
  scene.clouds.forEach((cloud, order) => {
    const color = palette.sensors[order % palette.sensors.length] ?? palette.text;
    const [first, end] = within(cloud.time, from, now);
    for (let row = first; row < end; row++) {
      const [x, y] = place(cloud.x[row] ?? 0, cloud.y[row] ?? 0);
      pen.rect(x - 1, y - 1, 2, 2, color);
    }
  });
}

function paintHeads(pen: Pen, { scene, now, palette, track }: PlanProps, place: Place): void {
  const alive = [...scene.tracks.values()].filter((line) => isAlive(scene, line, now));
  for (const line of alive) {
    const here = at(line, now);
    if (!here) continue;
    const [x, y] = place(here.x, here.y);
    const color = line.id === track ? palette.selected : palette.track;
    pen.circle(x, y, 3.5, color, line.status[here.index] !== "confirmed");
    if (alive.length <= 12 || line.id === track) pen.text(line.id, x + 7, y, { color });
  }
}

/** A length that is round, about a fifth of the width. */
export function paintScale(pen: Pen, size: Size, pixels: number, palette: Palette): void {
  const metres = niceStep(size.width / pixels, 5);
  const [x, y, length] = [14, size.height - 14, metres * pixels];
  for (const [from, to] of [
    [
      [x, y],
      [x + length, y],
    ],
    [
      [x, y - 4],
      [x, y + 4],
    ],
    [
      [x + length, y - 4],
      [x + length, y + 4],
    ],
  ] as [[number, number], [number, number]][])
    pen.line([from, to], { color: palette.text, width: 1.5 });
  const text = metres >= 1000 ? `${metres / 1000} km` : `${metres} m`;
  pen.text(text, x + length / 2, y - 10, { color: palette.text, anchor: "middle" });
}

export function planPainting(props: PlanProps): Painting {
  const { scene, size, palette, track, truth } = props;
  const { place, pixels } = placeIn(scene, size);
  return {
    ...size,
    paint: (pen) => {
      pen.rect(0, 0, size.width, size.height, palette.surface);
      paintDetections(pen, props, place);
      for (const line of scene.truths.values()) {
        const width = line.id === truth ? 3 : 1.4;
        pen.line(pointsOf(line, props, place), { color: palette.truth, width, opacity: 0.7 });
      }
      for (const line of scene.tracks.values()) {
        const look =
          line.id === track
            ? { color: palette.selected, width: 2.6 }
            : { color: palette.track, width: 1.5 };
        pen.line(pointsOf(line, props, place), look);
      }
      paintHeads(pen, props, place);
      paintScale(pen, size, pixels, palette);
    },
  };
}
