// What the plan view draws, as a table, and what its colours and lines mean, for saved pictures.

import type { Gates } from "../api/types";
import type { TableData } from "../components/table";
import { count, number } from "../format";
import type { Palette } from "../state/theme";
import type { Density } from "./density";
import { gatesAt } from "./gates";
import type { KeyMark } from "./marks";
import { detectionSymbol, drawnDetections, type Moment } from "./plan-series";
import { hasEnded, type Scene, within } from "./scene";

export interface PlanContent {
  scene: Scene;
  gates: Gates | undefined;
  /** What stands for the detections, where it does. */
  density: Density | undefined;
}

/** The data as drawn: one row a point, whatever its layer. */
export function drawnTable({ scene, gates }: PlanContent, moment: Moment): TableData {
  const rows: TableData["rows"] = [];
  const add = (
    layer: string,
    line: { time: number[]; x: number[]; y: number[] },
    id: (row: number) => string | null,
    detail: (row: number) => string | null,
  ) => {
    const [first, end] = within(line.time, moment.from, moment.now);
    for (let row = first; row < end; row++)
      rows.push([
        layer,
        id(row),
        line.time[row] ?? null,
        line.x[row] ?? null,
        line.y[row] ?? null,
        detail(row),
      ]);
  };
  if (!moment.hidden.has("truth"))
    for (const line of scene.truths.values())
      add(
        "truth",
        line,
        () => line.id,
        () => null,
      );
  for (const cloud of scene.clouds) {
    if (!moment.hidden.has(`d:${cloud.sensor}`))
      add(
        "detection",
        cloud,
        (row) => cloud.id[row] ?? null,
        () => cloud.sensor,
      );
  }
  for (const { sensor, lines } of scene.locals) {
    if (!moment.hidden.has(`l:${sensor}`))
      for (const line of lines)
        add(
          "local track",
          line,
          () => line.id,
          () => sensor,
        );
  }
  if (!moment.hidden.has("tracks"))
    for (const line of scene.tracks.values())
      add(
        "track",
        line,
        () => line.id,
        (row) => line.status[row] ?? null,
      );
  for (const row of moment.hidden.has("gate") ? [] : gatesAt(gates, moment.track, moment.now)) {
    rows.push([
      "gate",
      moment.track,
      moment.now,
      gates?.columns.x_m[row] ?? null,
      gates?.columns.y_m[row] ?? null,
      `squared distance up to ${number(gates?.threshold)}`,
    ]);
  }
  return {
    columns: ["layer", "id", "time_s", "x_m", "y_m", "detail"],
    rows,
    origin_s: scene.origin,
  };
}

export function pictureKey(
  { scene, gates, density }: PlanContent,
  moment: Moment,
  palette: Palette,
): KeyMark[] {
  const shown = (layer: string, there: boolean) => there && !moment.hidden.has(layer);
  const colorOf = (order: number) =>
    palette.sensors[order % palette.sensors.length] ?? palette.text;
  const key: KeyMark[] = [];
  if (shown("truth", scene.truths.size > 0))
    key.push({ name: "truth", color: palette.truth, look: "solid" });
  if (shown("tracks", scene.tracks.size > 0)) {
    key.push(
      { name: "track", color: palette.track, look: "solid" },
      { name: "coasted", color: palette.track, look: "dashed" },
    );
    key.push({ name: "tentative", color: palette.tentative, look: "solid" });
  }
  scene.locals.forEach(({ sensor }, order) => {
    const look = (["dashed", "dotted", "solid"] as const)[order % 3] ?? "solid";
    if (shown(`l:${sensor}`, true))
      key.push({ name: `tracks of ${sensor}`, color: colorOf(order), look });
  });
  if (density)
    key.push({
      name: `all ${count(density.source_points)} detections`,
      color: colorOf(0),
      look: "dot",
      symbol: "rect",
    });
  else
    scene.clouds.forEach((cloud, order) => {
      const symbol = detectionSymbol(drawnDetections(cloud, moment), order);
      if (shown(`d:${cloud.sensor}`, true))
        key.push({
          name: `detections, ${cloud.sensor}`,
          color: colorOf(order),
          look: "dot",
          symbol,
        });
    });
  key.push(...selected(scene, moment, palette));
  const hasGate = !moment.hidden.has("gate") && gatesAt(gates, moment.track, moment.now).length > 0;
  return hasGate ? [...key, { name: "gate", color: palette.text, look: "dashed" }] : key;
}

function selected(scene: Scene, moment: Moment, palette: Palette): KeyMark[] {
  const track = scene.tracks.get(moment.track ?? "");
  const key: KeyMark[] = [];
  if (scene.truths.has(moment.truth ?? ""))
    key.push({ name: `selected ${moment.truth}`, color: palette.truth, look: "solid" });
  if (track && hasEnded(scene, track, moment.now)) {
    key.push({
      name: `selected ${moment.track}, which has ended`,
      color: palette.muted,
      look: "solid",
      symbol: "cross",
    });
  } else if (track)
    key.push({ name: `selected ${moment.track}`, color: palette.selected, look: "solid" });
  return key;
}
