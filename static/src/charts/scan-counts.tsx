// What each scan held: detections of each sensor, tracks alive, tracks confirmed.

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import { getScanCounts } from "../api/client";
import type { ScanCounts as ScanCountsSeries } from "../api/types";
import { Empty, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { fromColumns } from "../components/table";
import { type Palette, readPalette, theme } from "../state/theme";
import { originOf, timeAxisName, timeText } from "../times";
import { GRID, lowerLabel, textStyle, tipContent, tooltip, valueAxis } from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame, reducedBadge } from "./frame";
import { Key, type KeyMark, symbolLook } from "./marks";
import { SHAPES } from "./plan-series";

const MARKS_UP_TO = 80;

interface Curve {
  name: string;
  kind: "detections" | "tracks" | "confirmed";
  /** Place of the sensor among the sensors, for its colour and shape. */
  sensor: number;
  points: [number, number][];
}

interface Counts {
  times: number[];
  origin: number;
  curves: Curve[];
}

function countsOf(series: ScanCountsSeries): Counts {
  const { time_s: times, sensor_id, detections, tracks, confirmed } = series.columns;
  const rows = times.map((_, row) => row);
  const sensors = [...new Set(sensor_id)].sort();
  const origin = originOf(times[0]);
  const curve = (
    name: string,
    kind: Curve["kind"],
    column: number[],
    keep = rows,
    sensor = 0,
  ): Curve => {
    const points = keep.map((row): [number, number] => [
      (times[row] ?? 0) - origin,
      column[row] ?? 0,
    ]);
    return { name, kind, sensor, points };
  };
  const rowsOf = (id: string) => rows.filter((row) => sensor_id[row] === id);
  const ofSensors = sensors.map((id, order) =>
    curve(`detections, ${id}`, "detections", detections, rowsOf(id), order),
  );
  const anyTrack = tracks.some((alive) => alive > 0);
  const ofTracks = anyTrack
    ? [curve("tracks", "tracks", tracks), curve("confirmed tracks", "confirmed", confirmed)]
    : [];
  return { times, origin, curves: [...ofSensors, ...ofTracks] };
}

function look(curve: Curve, palette: Palette): Omit<KeyMark, "name"> & { symbol: string } {
  if (curve.kind === "detections") {
    const color = palette.sensors[curve.sensor % palette.sensors.length] ?? palette.text;
    return { color, look: "dotted", symbol: SHAPES[curve.sensor % SHAPES.length] ?? "circle" };
  }
  if (curve.kind === "tracks")
    return { color: palette.muted, look: "dashed", symbol: "emptyTriangle" };
  return { color: palette.track, look: "solid", symbol: "circle" };
}

const hasSymbols = (curve: Curve): boolean => curve.points.length <= MARKS_UP_TO;

function lineOf(curve: Curve, palette: Palette): object {
  const { color, look: type, symbol } = look(curve, palette);
  const lineStyle = { color, type, width: 1.6 };
  const shown = {
    ...symbolLook(symbol, color, palette.surface),
    symbolSize: 5,
    showSymbol: hasSymbols(curve),
  };
  return {
    type: "line",
    name: curve.name,
    animation: false,
    ...shown,
    data: curve.points,
    lineStyle,
  };
}

interface TipItem {
  seriesName?: string;
  value?: unknown;
}

function tip(items: TipItem[], origin: number): HTMLElement | string {
  const value = items[0]?.value;
  if (!Array.isArray(value)) return "";
  const here = items.filter((item) => Array.isArray(item.value) && item.value[0] === value[0]);
  return tipContent(
    timeText(Number(value[0]) + origin, origin),
    here.map((item) => [item.seriesName ?? "", String((item.value as number[])[1])]),
  );
}

function draw(chart: Chart, { times, origin, curves }: Counts): void {
  const palette = readPalette();
  const range = { min: (times[0] ?? 0) - origin, max: (times.at(-1) ?? 1) - origin };
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: {
        trigger: "axis",
        ...tooltip(palette),
        formatter: (items: TipItem[]) => tip(items, origin),
      },
      xAxis: valueAxis(timeAxisName(origin), palette, {
        ...range,
        nameGap: 26,
        axisLabel: lowerLabel(palette),
      }),
      yAxis: valueAxis("count", palette, { min: 0, minInterval: 1, nameGap: 40 }),
      dataZoom: [{ type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl" }],
      series: curves.map((curve) => lineOf(curve, palette)),
    },
    { replaceMerge: ["series"] },
  );
}

export function ScanCounts({ jobId }: { jobId: string }): JSX.Element {
  const series = useResource(() => getScanCounts(jobId), [jobId]);
  const counts = useMemo(() => (series.data ? countsOf(series.data) : undefined), [series.data]);
  const chart = useRef<Chart | undefined>(undefined);
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data || !counts) return <Loading what="the counts of each scan" />;
  if (!counts.times.length)
    return <Empty title="No scans are known: these tracks came without their detections." />;
  const data = series.data;
  const mark = (curve: Curve, palette: Palette): KeyMark => {
    const { symbol, ...line } = look(curve, palette);
    return { name: curve.name, ...line, symbol: hasSymbols(curve) ? symbol : undefined };
  };
  const key = (palette: Palette) => counts.curves.map((curve) => mark(curve, palette));
  const what = "Detections, tracks and confirmed tracks";
  return (
    <ChartFrame
      title="Scan by scan"
      file={`scan-counts-${jobId.slice(-12)}`}
      badge={reducedBadge([{ ...data, name: "scans" }])}
      table={() => fromColumns(data.columns, counts.origin)}
      chart={() => chart.current}
      pictureKey={key}
      tools={<Key marks={key} />}
    >
      <ChartCanvas
        class="counts-canvas"
        label={`${what} of ${counts.times.length} scans. The table shows the same numbers.`}
        keys={[counts, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, counts);
        }}
      />
    </ChartFrame>
  );
}
