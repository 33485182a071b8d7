// Axes, tooltips and grids in the look of the dashboard.

import { number } from "../format";
import type { Palette } from "../state/theme";

export const MARGIN = { left: 58, right: 14, top: 12, bottom: 42 };

/**
 * `outerBoundsMode` none: the drawing area must stay where it is put, or metres would not be equal
 * on both axes.
 */
export const GRID = { ...MARGIN, containLabel: false, outerBoundsMode: "none" as const };

/** Without quotes: the chart library writes it into an attribute as it is. */
export const FONT = "system-ui, -apple-system, Segoe UI, Roboto, DejaVu Sans, sans-serif";

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
    axisLabel: axisLabel(palette),
    splitLine: { lineStyle: { color: palette.line, opacity: 0.5 } },
    ...more,
  };
}

/** Labels with few digits. */
export function axisLabel(palette: Palette, more: object = {}): object {
  return {
    color: palette.muted,
    fontSize: 11,
    hideOverlap: true,
    formatter: (value: number) => number(value),
    ...more,
  };
}

/** The same along the lower edge, where the outer ones would stick out of the picture. */
export function lowerLabel(palette: Palette, more: object = {}): object {
  return axisLabel(palette, { alignMinLabel: "left", alignMaxLabel: "right", ...more });
}

export interface Rule {
  color: string;
  width?: number;
  type?: "solid" | "dashed";
  label?: object;
}

/**
 * A line across a chart at one value of an axis, at that very value: the library would round it to
 * hundredths.
 */
export function ruleAt(
  place: { xAxis: number } | { yAxis: number },
  { color, width = 1.5, type = "solid", label = { show: false } }: Rule,
): object {
  const lineStyle = { color, width, type };
  return {
    silent: true,
    symbol: "none",
    animation: false,
    precision: 20,
    label,
    lineStyle,
    data: [place],
  };
}

const ROUNDING = 1e-9;

/**
 * The ends of an axis of values that all lie from 0 to 1, as shares do: no such axis goes beyond.
 */
export function shareRange(values: number[]): { min?: number; max?: number } {
  const [least, greatest] = [Math.min(...values), Math.max(...values)];
  if (!(least >= -ROUNDING && greatest <= 1 + ROUNDING)) return {};
  return { ...(greatest > 0.8 ? { max: 1 } : {}), ...(least < 0.2 ? { min: 0 } : {}) };
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

/**
 * The content of a tooltip: a heading and rows, built without markup so that no name can be markup.
 */
export function tipContent(heading: string, rows: [string, string][]): HTMLElement {
  const box = document.createElement("div");
  box.className = "tip";
  box.append(Object.assign(document.createElement("strong"), { textContent: heading }));
  for (const [name, value] of rows) {
    const row = document.createElement("div");
    row.append(
      Object.assign(document.createElement("span"), { textContent: name }),
      Object.assign(document.createElement("span"), { textContent: value }),
    );
    box.append(row);
  }
  return box;
}
