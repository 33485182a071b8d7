// What each scan held: detections of each sensor, tracks alive, tracks confirmed.

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import { getScanCounts } from "../api/client";
import type { ScanCounts as ScanCountsSeries } from "../api/types";
import { Empty, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { fromColumns } from "../components/table";
import { readPalette, theme, type Palette } from "../state/theme";
import { GRID, textStyle, timeAxisName, timeOrigin, timeText, tipContent, tooltip, valueAxis } from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame, reducedBadge } from "./frame";
import type { KeyMark } from "./picture";
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
  curves: Curve[];
}

function countsOf(series: ScanCountsSeries): Counts {
  const { time_s: times, sensor_id, detections, tracks, confirmed } = series.columns;
  const rows = times.map((_, row) => row);
  const sensors = [...new Set(sensor_id)].sort();
  const origin = timeOrigin(times);
  const curve = (name: string, kind: Curve["kind"], column: number[], keep = rows, sensor = 0): Curve => ({ name, kind, sensor, points: keep.map((row) => [(times[row] ?? 0) - origin, column[row] ?? 0]) });
  const ofSensors = sensors.map((id, order) => curve(`detections, ${id}`, "detections", detections, rows.filter((row) => sensor_id[row] === id), order));
  const anyTrack = tracks.some((alive) => alive > 0);
  const ofTracks = anyTrack ? [curve("tracks", "tracks", tracks), curve("confirmed tracks", "confirmed", confirmed)] : [];
  return { times, curves: [...ofSensors, ...ofTracks] };
}

function look(curve: Curve, palette: Palette): Omit<KeyMark, "name"> {
  if (curve.kind === "detections") return { color: palette.sensors[curve.sensor % palette.sensors.length] ?? palette.text, look: "dotted" };
  return curve.kind === "tracks" ? { color: palette.muted, look: "dashed" } : { color: palette.track, look: "solid" };
}

function lineOf(curve: Curve, palette: Palette): object {
  const { color, look: type } = look(curve, palette);
  const symbol = { detections: SHAPES[curve.sensor % SHAPES.length], tracks: "emptyTriangle", confirmed: "circle" }[curve.kind];
  return { type: "line", name: curve.name, animation: false, symbol, symbolSize: 5, showSymbol: curve.points.length <= MARKS_UP_TO, data: curve.points, lineStyle: { color, type, width: 1.6 }, itemStyle: { color } };
}

interface TipItem {
  seriesName?: string;
  value?: unknown;
}

function tip(items: TipItem[], times: number[]): HTMLElement | string {
  const value = items[0]?.value;
  if (!Array.isArray(value)) return "";
  const here = items.filter((item) => Array.isArray(item.value) && item.value[0] === value[0]);
  return tipContent(
    timeText(Number(value[0]) + timeOrigin(times), times),
    here.map((item) => [item.seriesName ?? "", String((item.value as number[])[1])]),
  );
}

function draw(chart: Chart, { times, curves }: Counts): void {
  const palette = readPalette();
  const origin = timeOrigin(times);
  const label = { color: palette.muted, fontSize: 11, hideOverlap: true, showMaxLabel: false };
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: { trigger: "axis", ...tooltip(palette), formatter: (items: TipItem[]) => tip(items, times) },
      xAxis: valueAxis(timeAxisName(times), palette, { min: (times[0] ?? 0) - origin, max: (times.at(-1) ?? 1) - origin, nameGap: 26, axisLabel: label }),
      yAxis: valueAxis("count", palette, { min: 0, minInterval: 1, nameGap: 40 }),
      dataZoom: [{ type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl" }],
      series: curves.map((curve) => lineOf(curve, palette)),
    },
    { replaceMerge: ["series"] },
  );
}

function Key({ curves }: { curves: Curve[] }): JSX.Element {
  return (
    <p class="legend legend-note">
      {curves.map((curve) => (
        <span class={`key key-${curve.kind}${curve.kind === "detections" ? ` key-sensor-${(curve.sensor % 5) + 1}` : ""}`}>{curve.name}</span>
      ))}
    </p>
  );
}

export function ScanCounts({ jobId }: { jobId: string }): JSX.Element {
  const series = useResource(() => getScanCounts(jobId), [jobId]);
  const counts = useMemo(() => (series.data ? countsOf(series.data) : undefined), [series.data]);
  const chart = useRef<Chart | undefined>(undefined);
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data || !counts) return <Loading what="the counts of each scan" />;
  if (!counts.times.length) return <Empty title="No scans are known: these tracks came without their detections." />;
  const data = series.data;
  return (
    <ChartFrame title="Scan by scan" file={`scan-counts-${jobId.slice(-12)}`} badge={reducedBadge([{ ...data, name: "scans" }])} table={() => fromColumns(data.columns)} chart={() => chart.current} pictureKey={(palette) => counts.curves.map((curve) => ({ name: curve.name, ...look(curve, palette) }))} tools={<Key curves={counts.curves} />}>
      <ChartCanvas
        class="counts-canvas"
        label={`Detections, tracks and confirmed tracks of ${counts.times.length} scans. The table shows the same numbers.`}
        keys={[counts, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, counts);
        }}
      />
    </ChartFrame>
  );
}
