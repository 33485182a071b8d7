// Times of the data: told from the first scan where the clock of a recording counts from far away,
// and as UTC where it counts seconds since 1970. A job has one origin, whatever view shows it.

import { number } from "./format";

/** Clocks that start farther from zero than this are told from their first scan. */
const FAR_S = 1e6;
/** Seconds since 1970 from 2001 to 2103; other clocks far from zero count from somewhere else. */
const [UNIX_FROM_S, UNIX_TO_S] = [1e9, 4.2e9];

/**
 * Where the times of data that begin at `start_s` count from: their start, or 0 where that is near.
 */
export function originOf(start_s: number | undefined): number {
  return start_s !== undefined && Math.abs(start_s) > FAR_S ? start_s : 0;
}

export function timeAxisName(origin_s: number): string {
  return origin_s === 0 ? "time (s)" : "time from the first scan (s)";
}

const signed = (text: string): string => (text.startsWith("-") ? `−${text.slice(1)}` : `+${text}`);

/** `33.57 s`, or `+33.57 s` from the origin. */
export function timeText(time_s: number, origin_s: number): string {
  return origin_s === 0 ? `${number(time_s)} s` : `${signed(number(time_s - origin_s))} s`;
}

/** As a cell of a table shows it, in seconds and to the millisecond. */
export function timeCell(time_s: number, origin_s: number): string {
  return origin_s === 0 ? number(time_s) : String(Number((time_s - origin_s).toFixed(3)));
}

/** `2021-05-04 07:54:53.034 UTC`, where the seconds are those since 1970. */
export function utcText(time_s: number): string | undefined {
  if (!(time_s >= UNIX_FROM_S && time_s < UNIX_TO_S)) return undefined;
  const text = new Date(Math.round(time_s * 1000)).toISOString();
  return `${text.slice(0, 10)} ${text.slice(11, 23)} UTC`;
}

/** The time with all its digits, for whoever points at a short one. */
export function timeTitle(time_s: number, origin_s: number): string | undefined {
  return origin_s === 0 ? undefined : [utcText(time_s), `${time_s} s`].filter(Boolean).join(", ");
}

const TIMES = /^(time|from|to)_s$/;

export const isTimeColumn = (name: string): boolean => TIMES.test(name);

/** A column of times as it heads a table: with where they count from, so that nothing is lost. */
export function timeHead(name: string, origin_s: number): string {
  if (origin_s === 0 || !isTimeColumn(name)) return name;
  return `${name.slice(0, -2)} after ${utcText(origin_s) ?? `${origin_s} s`} (s)`;
}
