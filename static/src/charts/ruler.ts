// The ruler of the plan view: two points, how far the second is from the first, and in which
// direction. It stands in the address.

import { metres } from "../format";
import type { Palette } from "../state/theme";
import type { SeriesOption } from "./echarts";

export interface Spot {
  x: number;
  y: number;
}

export interface Ruler {
  from?: Spot;
  to?: Spot;
}

const KILOMETRES_FROM_M = 1000;

/** The ruler of the address: "on" before it has points, then `x,y` or `x,y,x,y` in metres. */
export function rulerOf(text: string | null): Ruler | undefined {
  if (text === null) return undefined;
  const values = text.split(",").map(Number);
  if (!values.every(Number.isFinite)) return {};
  const [x0, y0, x1, y1] = values;
  if (x0 === undefined || y0 === undefined) return {};
  const from = { x: x0, y: y0 };
  return x1 === undefined || y1 === undefined ? { from } : { from, to: { x: x1, y: y1 } };
}

export function rulerText({ from, to }: Ruler): string {
  const round = (value: number) => String(Number(value.toFixed(2)));
  const spots = [from, to].flatMap((spot) => (spot ? [round(spot.x), round(spot.y)] : []));
  return spots.length ? spots.join(",") : "on";
}

/** Metres, and degrees clockwise from north. */
export function measured({ from, to }: Ruler): { distance: number; bearing: number } | undefined {
  if (!from || !to) return undefined;
  const [east, north] = [to.x - from.x, to.y - from.y];
  const bearing = (Math.atan2(east, north) * 180) / Math.PI;
  return { distance: Math.hypot(east, north), bearing: (bearing + 360) % 360 };
}

export function rulerWords(ruler: Ruler): string | undefined {
  const result = measured(ruler);
  if (!result) return undefined;
  const { distance, bearing } = result;
  const length =
    distance < KILOMETRES_FROM_M ? `${metres(distance)} m` : `${(distance / 1000).toFixed(3)} km`;
  return `${length}, ${bearing.toFixed(1)}°`;
}

/** Without a ruler the same series without points, so that it leaves the chart. */
export function rulerSeries(ruler: Ruler | undefined, palette: Palette): SeriesOption[] {
  const spots = [ruler?.from, ruler?.to].filter((spot) => spot !== undefined);
  const { from, to } = ruler ?? {};
  const middle = from && to ? [[(from.x + to.x) / 2, (from.y + to.y) / 2]] : [];
  const label = {
    show: true,
    formatter: rulerWords(ruler ?? {}) ?? "",
    position: "top" as const,
    color: palette.text,
    backgroundColor: palette.surface,
    borderColor: palette.line,
    borderWidth: 1,
    padding: [3, 6],
    borderRadius: 3,
    fontSize: 12,
  };
  return [
    {
      type: "line",
      id: "ruler",
      data: spots.map(({ x, y }) => [x, y]),
      symbol: "rect",
      symbolSize: 7,
      silent: true,
      animation: false,
      z: 9,
      lineStyle: { color: palette.text, width: 1.6, type: "solid" },
      itemStyle: { color: palette.surface, borderColor: palette.text, borderWidth: 1.5 },
    },
    {
      type: "scatter",
      id: "ruler:label",
      data: middle,
      symbolSize: 1,
      silent: true,
      animation: false,
      z: 10,
      itemStyle: { color: "transparent" },
      label,
    },
  ];
}
