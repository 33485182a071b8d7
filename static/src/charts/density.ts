// All detections of a scene too large to send point by point: how many lie in each square of a
// grid, as shades.

import type { Plan } from "../api/types";

export type Density = NonNullable<Plan["density"]>;

/** Pixels of the picture along a cell, so that its edges stay sharp when it is stretched. */
const PIXELS_A_CELL = 4;
/**
 * Shade of the emptiest tenth of the cells that hold anything, so that a lone detection is seen,
 * and of the fullest.
 */
const [PALEST, DARKEST] = [40, 230];
const EMPTIEST = 0.1;

const drawn = new WeakMap<Density, { color: string; image: HTMLCanvasElement }>();

export function sides({ columns }: Density): { east: number; north: number } {
  const most = (cells: number[]) =>
    cells.reduce((greatest, cell) => Math.max(greatest, cell), 0) + 1;
  return { east: most(columns.east), north: most(columns.north) };
}

/**
 * Shades of one colour by the logarithm of the count, from that of the usual clutter; north is up.
 */
export function picture(density: Density, color: string): HTMLCanvasElement {
  const before = drawn.get(density);
  if (before?.color === color) return before.image;
  const { columns } = density;
  const { east, north } = sides(density);
  const image = document.createElement("canvas");
  [image.width, image.height] = [east * PIXELS_A_CELL, north * PIXELS_A_CELL];
  const pen = image.getContext("2d");
  const sorted = [...columns.count].sort((a, b) => a - b);
  const [low, high] = [sorted[Math.floor(EMPTIEST * (sorted.length - 1))], sorted.at(-1)].map(
    (count) => Math.log(count ?? 1),
  ) as [number, number];
  if (pen) {
    pen.fillStyle = color;
    columns.count.forEach((count, index) => {
      const share = high > low ? Math.max((Math.log(count) - low) / (high - low), 0) : 1;
      pen.globalAlpha = (PALEST + share * (DARKEST - PALEST)) / 255;
      pen.fillRect(
        (columns.east[index] ?? 0) * PIXELS_A_CELL,
        (north - 1 - (columns.north[index] ?? 0)) * PIXELS_A_CELL,
        PIXELS_A_CELL,
        PIXELS_A_CELL,
      );
    });
  }
  drawn.set(density, { color, image });
  return image;
}

interface Pens {
  coord(point: [number, number]): [number, number];
  coordSys: { x: number; y: number; width: number; height: number };
}

export function densitySeries(density: Density | undefined, color: string): object[] {
  if (!density) return [];
  const { x_min_m, y_min_m, cell_m } = density;
  const { east, north } = sides(density);
  const draw = (_: unknown, pens: Pens) => {
    const [left, top] = pens.coord([x_min_m, y_min_m + north * cell_m]);
    const [right, bottom] = pens.coord([x_min_m + east * cell_m, y_min_m]);
    return {
      type: "image",
      style: {
        image: picture(density, color),
        x: left,
        y: top,
        width: right - left,
        height: bottom - top,
      },
    };
  };
  return [
    {
      type: "custom",
      id: "density",
      renderItem: draw,
      data: [[x_min_m, y_min_m]],
      clip: true,
      silent: true,
      animation: false,
      z: 1,
    },
  ];
}
