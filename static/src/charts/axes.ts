// Axes, tooltips and grids in the look of the dashboard.

import { number } from "../format";
import type { Palette } from "../state/theme";

export const MARGIN = { left: 58, right: 14, top: 12, bottom: 42 };

/** `outerBoundsMode` none: the drawing area must stay where it is put, or metres would not be equal on both axes. */
export const GRID = { ...MARGIN, containLabel: false, outerBoundsMode: "none" as const };

export const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';

export function textStyle(palette: Palette): object {
  return { fontFamily: FONT, color: palette.text };
}

export function valueAxis(name: string, palette: Palette, more: object): object {
  return {
    type: "value",
    name,
    nameLocation: "middle",
    // A name that gives way to long numbers leaves the picture.
    nameMoveOverlap: false,
    nameTextStyle: { color: palette.muted, fontSize: 11.5 },
    axisLine: { show: true, onZero: false, lineStyle: { color: palette.line } },
    axisTick: { show: true, lineStyle: { color: palette.line } },
    axisLabel: { color: palette.muted, fontSize: 11, hideOverlap: true },
    splitLine: { lineStyle: { color: palette.line, opacity: 0.5 } },
    ...more,
  };
}

export function tooltip(palette: Palette): object {
  return {
    confine: true,
    transitionDuration: 0,
    padding: [6, 9],
    backgroundColor: palette.surface,
    borderColor: palette.line,
    borderWidth: 1,
    textStyle: { color: palette.text, fontSize: 12, fontFamily: FONT },
  };
}

/** The content of a tooltip: a heading and rows, built without markup so that no name can be markup. */
export function tipContent(heading: string, rows: [string, string][]): HTMLElement {
  const box = document.createElement("div");
  box.className = "tip";
  box.append(Object.assign(document.createElement("strong"), { textContent: heading }));
  for (const [name, value] of rows) {
    const row = document.createElement("div");
    row.append(Object.assign(document.createElement("span"), { textContent: name }), Object.assign(document.createElement("span"), { textContent: value }));
    box.append(row);
  }
  return box;
}

/** Where the time axis of a chart begins to count: a recording in seconds since 1970 counts from its first scan. */
export function timeOrigin(times: number[]): number {
  const start = times[0] ?? 0;
  return Math.abs(start) > 1e6 ? start : 0;
}

export function timeAxisName(times: number[]): string {
  return timeOrigin(times) === 0 ? "time (s)" : "time from the first scan (s)";
}

/** Seconds of the data, from the first scan when the clock of the recording starts far from zero. */
export function timeText(time: number, times: number[]): string {
  const origin = timeOrigin(times);
  return origin === 0 ? `${number(time)} s` : `+${number(time - origin)} s`;
}
