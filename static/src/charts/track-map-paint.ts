// The drawing of the map of all tracks: first an image of a pixel a track and scan, then stretched.

import type { AssociationMap, AssociationMapRow } from "../api/types";
import type { Palette } from "../state/theme";
import type { Painting, Pen } from "./pen";
import { AXIS_PX, type Band, paintAxis, paintNow, periodOf } from "./time-band";

export const MAP_TOP = 6;
/** Rows of this height and more have their name beside them. */
const NAMED_PX = 11;

export const rowPixels = (count: number): number =>
  Math.min(Math.max(Math.floor(300 / count), 3), 14);

export function rowAt(y: number, count: number): number {
  return Math.min(Math.max(Math.floor((y - MAP_TOP) / rowPixels(count)), 0), count - 1);
}

type Rgb = [number, number, number];

function rgb(color: string): Rgb {
  const part = (at: number) => Number.parseInt(color.slice(at, at + 2), 16);
  return [part(1), part(3), part(5)];
}

interface Shades {
  own: Rgb;
  other: Rgb;
  clutter: Rgb;
  none: Rgb;
}

/** A cell is as its own target says, and the more went elsewhere the more as where most went. */
function shade(row: AssociationMapRow, at: number, { own, other, clutter, none }: Shades): Rgb {
  const shares = [row.other[at] ?? 0, row.clutter[at] ?? 0];
  const share = row.own[at] ?? 0;
  const rest: [number, Rgb][] = [
    [shares[0] ?? 0, other],
    [shares[1] ?? 0, clutter],
    [Math.max(1000 - share - (shares[0] ?? 0) - (shares[1] ?? 0), 0), none],
  ];
  const [, hue] = rest.reduce((best, each) => (each[0] > best[0] ? each : best));
  const by = 1 - share / 1000;
  return own.map((value, channel) =>
    Math.round(value + (hue[channel as 0 | 1 | 2] - value) * by),
  ) as Rgb;
}

export interface MapProps {
  map: AssociationMap;
  rows: AssociationMapRow[];
  band: Band;
  width: number;
  now: number;
  origin: number;
  chosen: string | null;
  palette: Palette;
}

let made:
  | { key: string; map: AssociationMap; rows: AssociationMapRow[]; image: HTMLCanvasElement }
  | undefined;

/** A pixel a column of the screen and track; the last is kept, since the clock moves over it. */
function imageOf({ map, rows, band, palette }: MapProps): HTMLCanvasElement {
  const columns = Math.max(Math.round(band.right - band.left), 1);
  const key = [columns, band.from, band.to, palette.surface].join(" ");
  if (
    made?.key === key &&
    made.map === map &&
    made.rows.length === rows.length &&
    made.rows[0] === rows[0]
  )
    return made.image;
  const image = document.createElement("canvas");
  [image.width, image.height] = [columns, rows.length];
  const pen = image.getContext("2d");
  if (!pen) return image;
  const pixels = pen.createImageData(columns, rows.length);
  for (const [line, row] of rows.entries())
    paintRow(pixels, row, line, map.time_s, band, shadesOf(palette));
  pen.putImageData(pixels, 0, 0);
  made = { key, map, rows, image };
  return image;
}

function shadesOf(palette: Palette): Shades {
  return {
    own: rgb(palette.tentative),
    other: rgb(palette.selected),
    clutter: rgb(palette.sensors[0] ?? palette.text),
    none: rgb(palette.strongLine),
  };
}

function paintRow(
  pixels: ImageData,
  row: AssociationMapRow,
  line: number,
  times: number[],
  band: Band,
  shades: Shades,
): void {
  const own = row.at.map((place) => times[place] ?? 0);
  const reach = 0.75 * periodOf(own);
  own.forEach((time, at) => {
    const after = own[at + 1] ?? time + 2 * reach;
    const before = own[at - 1] ?? time - 2 * reach;
    const from = band.x(time - Math.min((time - before) / 2, reach)) - band.left;
    const to = band.x(time + Math.min((after - time) / 2, reach)) - band.left;
    const color = shade(row, at, shades);
    const [begin, end] = [Math.max(Math.round(from), 0), Math.min(Math.round(to), pixels.width)];
    for (let x = begin; x < Math.max(end, Math.min(begin + 1, pixels.width)); x++)
      pixels.data.set([...color, 255], 4 * (line * pixels.width + x));
  });
}

function paintNames(pen: Pen, { rows, band, palette, chosen }: MapProps, height: number): void {
  const most = Math.max(Math.floor((band.left - 14) / 6.3), 4);
  rows.forEach((row, at) => {
    const isChosen = row.track_id === chosen;
    if (height < NAMED_PX && !isChosen) return;
    const name = row.track_id.length > most ? `${row.track_id.slice(0, most - 1)}…` : row.track_id;
    const look = { color: isChosen ? palette.text : palette.muted, weight: isChosen ? 600 : 400 };
    const y = MAP_TOP + (at + 0.5) * height;
    pen.text(name, band.left - 8, y, { ...look, size: 10.5, anchor: "end" });
    if (isChosen) pen.rect(band.left - 5, y - height / 2, 3, height, palette.selected);
  });
}

export function mapPainting(props: MapProps): Painting {
  const { rows, band, width, palette, now, origin } = props;
  const height = rowPixels(rows.length);
  const bottom = MAP_TOP + height * rows.length;
  return {
    width,
    height: bottom + 4 + AXIS_PX,
    paint: (pen) => {
      pen.image(imageOf(props), band.left, MAP_TOP, band.right - band.left, bottom - MAP_TOP);
      paintNames(pen, props, height);
      paintAxis(pen, band, bottom + 4, origin, palette);
      paintNow(pen, band, now, [MAP_TOP - 4, bottom + 4], palette.selected);
    },
  };
}
