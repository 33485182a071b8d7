// The grid of a campaign: its axes with their points in order, and the cells they make.

import type { CampaignCell } from "../api/types";

export interface Axis {
  name: string;
  points: string[];
}

interface GridEntry {
  by?: string;
  name?: string;
  path?: string;
  values?: unknown[];
  variants?: { name: string }[];
}

const textOf = (value: unknown): string =>
  typeof value === "string" ? value : JSON.stringify(value);

/**
 * Axes in the order of the request. The cells say what the points are called: 150.0 of a request is
 * 150 to a browser.
 */
export function axesOf(spec: Record<string, unknown>, cells: CampaignCell[] = []): Axis[] {
  const grid = (Array.isArray(spec.grid) ? spec.grid : []) as GridEntry[];
  return grid.map((entry) => {
    const name = entry.name ?? entry.path ?? "";
    const asked =
      entry.by === "variants"
        ? (entry.variants ?? []).map((variant) => variant.name)
        : (entry.values ?? []).map(textOf);
    const named = [...new Set(cells.map((cell) => cell.parameters[name] ?? ""))];
    return { name, points: cells.length ? named : asked };
  });
}

/** Every combination of the points of some axes, the last running fastest. */
export function combinations(axes: Axis[]): string[][] {
  return axes.reduce<string[][]>(
    (before, axis) => before.flatMap((points) => axis.points.map((point) => [...points, point])),
    [[]],
  );
}

export function isNumeric(axis: Axis): boolean {
  return (
    axis.points.length > 1 &&
    axis.points.every((point) => point.trim() !== "" && Number.isFinite(Number(point)))
  );
}

/** The cell with these points, by axis. */
export function cellAt(
  cells: CampaignCell[],
  axes: Axis[],
  points: Record<string, string>,
): CampaignCell | undefined {
  return cells.find((cell) =>
    axes.every((axis) => cell.parameters[axis.name] === points[axis.name]),
  );
}

export const pointsOf = (axes: Axis[], points: string[]): Record<string, string> =>
  Object.fromEntries(axes.map((axis, index) => [axis.name, points[index] ?? ""]));

/** Rows are the points of all axes but the last, columns those of the last. */
export function rowsAndColumns(axes: Axis[]): { rows: Axis[]; columns: Axis } {
  return { rows: axes.slice(0, -1), columns: axes.at(-1) ?? { name: "", points: ["all"] } };
}
