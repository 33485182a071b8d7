// The stretch of time that a strip below the plan shows, on the clock of the plan.

import { number } from "../format";
import { type Clock, indexAt } from "../state/clock";
import type { Palette } from "../state/theme";
import { timeAxisName } from "../times";
import type { Pen } from "./pen";
import { ticks } from "./ticks";

export const AXIS_PX = 34;
const NARROW_PX = 560;
const RIGHT_PX = 12;

export interface Band {
  left: number;
  right: number;
  from: number;
  to: number;
  x(time: number): number;
}

/** The time from one scan to the next, in the middle. */
export function periodOf(times: number[]): number {
  const gaps = times.slice(1).map((time, at) => time - (times[at] ?? time));
  gaps.sort((a, b) => a - b);
  return gaps[gaps.length >> 1] || 1;
}

/** `around` scans about the clock, or all of them. */
export function bandOf(clock: Clock, width: number, around: number): Band {
  const { times } = clock;
  const last = Math.max(times.length - 1, 0);
  const first = Math.min(
    Math.max(clock.index.value - (around >> 1), 0),
    Math.max(last - around, 0),
  );
  const [begin, end] = around > 0 && around < last ? [first, first + around] : [0, last];
  const half = periodOf(times) / 2;
  const [from, to] = [(times[begin] ?? 0) - half, (times[end] ?? 1) + half];
  const [left, right] = [width < NARROW_PX ? 58 : 112, width - RIGHT_PX];
  const scale = (right - left) / (to - from);
  return { left, right, from, to, x: (time) => left + (time - from) * scale };
}

/** The scan whose column is under a place. */
export function scanAt(clock: Clock, band: Band, x: number): number {
  const time = band.from + ((x - band.left) / (band.right - band.left)) * (band.to - band.from);
  const before = indexAt(clock.times, time);
  const next = Math.min(before + 1, clock.times.length - 1);
  const [a, b] = [clock.times[before] ?? 0, clock.times[next] ?? 0];
  return time - a <= b - time ? before : next;
}

/** Where the column of each scan begins and ends: half way to its neighbours, unless far away. */
export function columnsOf(times: number[], period: number): [number, number][] {
  const reach = 0.75 * period;
  return times.map((time, at) => {
    const before = times[at - 1];
    const after = times[at + 1];
    const left = before === undefined ? period / 2 : Math.min((time - before) / 2, reach);
    const right = after === undefined ? period / 2 : Math.min((after - time) / 2, reach);
    return [time - left, time + right];
  });
}

export function paintAxis(pen: Pen, band: Band, y: number, origin: number, palette: Palette): void {
  const [from, to] = [band.from - origin, band.to - origin];
  pen.line(
    [
      [band.left, y],
      [band.right, y],
    ],
    { color: palette.strongLine },
  );
  for (const tick of ticks(from, to, Math.min(10, (band.right - band.left) / 90))) {
    const x = band.x(tick + origin);
    pen.line(
      [
        [x, y],
        [x, y + 4],
      ],
      { color: palette.strongLine },
    );
    pen.text(number(tick), x, y + 12, { color: palette.muted, anchor: "middle" });
  }
  const middle = (band.left + band.right) / 2;
  pen.text(timeAxisName(origin), middle, y + 26, { color: palette.muted, anchor: "middle" });
}

export function paintNow(
  pen: Pen,
  band: Band,
  now: number,
  [top, bottom]: [number, number],
  color: string,
) {
  if (now < band.from || now > band.to) return;
  const x = Math.round(band.x(now)) + 0.5;
  pen.line(
    [
      [x, top],
      [x, bottom],
    ],
    { color, width: 1.5 },
  );
}
