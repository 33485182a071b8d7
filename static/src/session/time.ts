// Times of a live session: its clock is that of the feed, most often the seconds since 1970.

import { number } from "../format";
import { utcText } from "../times";

/** `07:54:53.03` of a UTC time, else the seconds. */
export function clockText(time_s: number): string {
  return utcText(time_s)?.slice(11, 22) ?? `${number(time_s)} s`;
}

/** All that is known of a time. */
export function clockTitle(time_s: number): string {
  return [utcText(time_s), `${time_s} s`].filter(Boolean).join(", ");
}
