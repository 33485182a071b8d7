// A time of the data in running text: short, with the whole of it for whoever points at it.

import type { JSX } from "preact";
import { timeText, timeTitle, utcText } from "../times";

export function Time({ at, origin }: { at: number; origin: number }): JSX.Element {
  const utc = utcText(at);
  return (
    <time
      title={timeTitle(at, origin)}
      dateTime={utc ? new Date(at * 1000).toISOString() : undefined}
    >
      {timeText(at, origin)}
    </time>
  );
}
