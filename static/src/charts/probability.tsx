// How probable each candidate was for one track, scan by scan: the detection it took, "none" (ε),
// and the others; and how probable it was that the track had a target, where its life says so.

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import { getTrackProbability } from "../api/client";
import type { TrackProbability } from "../api/types";
import { Empty, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { fromColumns } from "../components/table";
import { probability } from "../format";
import { type Clock, indexAt } from "../state/clock";
import { type Palette, readPalette, theme } from "../state/theme";
import { timeAxisName, timeText } from "../times";
import { GRID, lowerLabel, ruleAt, textStyle, tipContent, tooltip, valueAxis } from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame, reducedBadge } from "./frame";
import { Key, type KeyMark, symbolLook } from "./marks";

interface Candidate {
  detection: string | null;
  probability: number;
}

interface Row {
  time: number;
  status: string;
  existence: number | null;
  candidates: Candidate[];
}

function rowsOf(series: TrackProbability): Row[] {
  const rows: Row[] = [];
  const { time_s, detection_id, probability: values, status, existence } = series.columns;
  (time_s ?? []).forEach((cell, at) => {
    const time = Number(cell);
    if (rows.at(-1)?.time !== time)
      rows.push({
        time,
        status: String(status?.[at] ?? ""),
        existence: (existence?.[at] as number | null | undefined) ?? null,
        candidates: [],
      });
    const detection = detection_id?.[at];
    rows.at(-1)?.candidates.push({
      detection:
        detection === null || detection === undefined || detection === ""
          ? null
          : String(detection),
      probability: Number(values?.[at] ?? 0),
    });
  });
  for (const row of rows) row.candidates.sort((a, b) => b.probability - a.probability);
  return rows;
}

/** A probability of existence at which a track becomes something else. */
export interface Threshold {
  name: string;
  existence: number;
}

type Point = [number, number];

/** For each scan the best detection, "none", and the rest. */
function split(rows: Row[], origin: number): { best: Point[]; none: Point[]; others: Point[] } {
  const none: Point[] = rows.map((row) => [
    row.time - origin,
    row.candidates.find((entry) => entry.detection === null)?.probability ?? 0,
  ]);
  const best: Point[] = [];
  const others: Point[] = [];
  for (const row of rows) {
    const [first, ...rest] = row.candidates.filter((entry) => entry.detection !== null);
    best.push([row.time - origin, first?.probability ?? 0]);
    for (const entry of rest) others.push([row.time - origin, entry.probability]);
  }
  return { best, none, others };
}

interface Drawn {
  rows: Row[];
  thresholds: Threshold[];
}

const SYMBOLS = { best: "circle", none: "emptyDiamond", others: "emptyTriangle" };

const hasExistence = (rows: Row[]): boolean => rows.some((row) => row.existence !== null);

/** Lines across the chart, each with its name. */
function thresholdLines(thresholds: Threshold[], palette: Palette): object {
  const label = (existence: number) => ({
    show: true,
    position: existence > 0.5 ? "insideStartBottom" : "insideStartTop",
    color: palette.muted,
    formatter: "{b}",
  });
  return {
    silent: true,
    symbol: "none",
    animation: false,
    precision: 20,
    lineStyle: { color: palette.muted, width: 1, type: "dashed" },
    data: thresholds.map(({ name, existence }) => ({
      name: `${name} ${probability(existence)}`,
      yAxis: existence,
      label: label(existence),
    })),
  };
}

/** The probability that the track has a target; nothing where no row says so. */
function existenceCurve({ rows, thresholds }: Drawn, origin: number, palette: Palette): object[] {
  if (!hasExistence(rows)) return [];
  return [
    {
      animation: false,
      type: "line",
      step: "end",
      name: "existence",
      data: rows.map((row) => [row.time - origin, row.existence]),
      showSymbol: false,
      lineStyle: { color: palette.text, width: 1.8, type: "dotted" },
      markLine: thresholdLines(thresholds, palette),
    },
  ];
}

function curves(drawn: Drawn, { origin, time }: Clock, palette: Palette): object[] {
  const { rows } = drawn;
  const { best, none, others } = split(rows, origin);
  const common = { animation: false, symbolSize: 6 };
  const step = { ...common, type: "line", step: "middle" };
  const [track, muted, other] = [palette.track, palette.muted, palette.sensors[0] ?? palette.text];
  const cursor = ruleAt({ xAxis: time.value - origin }, { color: palette.selected });
  return [
    {
      ...step,
      name: "best detection",
      data: best,
      lineStyle: { color: track, width: 1.8 },
      ...symbolLook(SYMBOLS.best, track),
      markLine: cursor,
    },
    {
      ...step,
      name: "none (ε)",
      data: none,
      lineStyle: { color: muted, width: 1.3, type: "dashed" },
      ...symbolLook(SYMBOLS.none, muted, palette.surface),
    },
    {
      ...common,
      type: "scatter",
      name: "other candidates",
      symbolSize: 8,
      data: others,
      ...symbolLook(SYMBOLS.others, other),
    },
    ...existenceCurve(drawn, origin, palette),
  ];
}

function rowTip(
  rows: Row[],
  origin: number,
): (items: { value?: unknown }[]) => HTMLElement | string {
  return (items) => {
    const time = Array.isArray(items[0]?.value) ? Number(items[0].value[0]) + origin : NaN;
    const row = rows.find((entry) => Math.abs(entry.time - time) < 1e-6);
    if (!row) return "";
    const sum = row.candidates.reduce((total, entry) => total + entry.probability, 0);
    const lines = row.candidates.map((entry): [string, string] => [
      entry.detection ?? "none (ε)",
      probability(entry.probability),
    ]);
    lines.push(["sum", probability(sum)]);
    if (row.existence !== null) lines.push(["existence", probability(row.existence)]);
    return tipContent(`${timeText(row.time, origin)} · ${row.status}`, lines);
  };
}

function slider(palette: Palette): object {
  const clear = { lineStyle: { opacity: 0 }, areaStyle: { opacity: 0 } };
  return {
    ...{
      type: "slider",
      xAxisIndex: 0,
      filterMode: "none",
      height: 14,
      bottom: 6,
      showDetail: false,
      brushSelect: false,
    },
    ...{ borderColor: palette.line, fillerColor: `${palette.track}22` },
    handleStyle: { color: palette.surface, borderColor: palette.muted },
    dataBackground: clear,
    selectedDataBackground: clear,
  };
}

function draw(chart: Chart, drawn: Drawn, clock: Clock): void {
  const { rows } = drawn;
  const palette = readPalette();
  const { origin } = clock;
  const [first, last] = [rows[0]?.time ?? origin, rows.at(-1)?.time ?? origin + 1];
  const label = lowerLabel(palette, { showMinLabel: false, showMaxLabel: false });
  const pointer = { type: "line", lineStyle: { color: palette.muted } };
  const tip = {
    trigger: "axis",
    axisPointer: pointer,
    ...tooltip(palette),
    formatter: rowTip(rows, origin),
  };
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: { ...GRID, bottom: 66 },
      tooltip: tip,
      xAxis: valueAxis(timeAxisName(origin), palette, {
        min: first - origin,
        max: last - origin,
        nameGap: 24,
        axisLabel: label,
      }),
      yAxis: valueAxis("probability", palette, { min: 0, max: 1, nameGap: 34 }),
      dataZoom: [
        { type: "inside", xAxisIndex: 0, filterMode: "none", zoomOnMouseWheel: "ctrl" },
        slider(palette),
      ],
      series: curves(drawn, clock, palette),
    },
    { replaceMerge: ["series"] },
  );
}

/** A click moves the clock to the scan under it. */
export function seekOnClick(chart: Chart, clock: Clock): () => void {
  const pressed = (event: { offsetX: number; offsetY: number }) => {
    if (!chart.containPixel("grid", [event.offsetX, event.offsetY])) return;
    const [shown] = chart.convertFromPixel("grid", [
      event.offsetX,
      event.offsetY,
    ]) as unknown as number[];
    if (shown === undefined) return;
    const time = shown + clock.origin;
    const before = indexAt(clock.times, time);
    const next = Math.min(before + 1, clock.times.length - 1);
    clock.seek(
      time - (clock.times[before] ?? 0) <= (clock.times[next] ?? 0) - time ? before : next,
    );
  };
  chart.getZr().on("click", pressed);
  return () => chart.getZr().off("click", pressed);
}

export function ProbabilityChart({
  jobId,
  track,
  thresholds,
  clock,
}: {
  jobId: string;
  track: string | null;
  thresholds: Threshold[];
  clock: Clock;
}): JSX.Element {
  const series = useResource(
    () => (track ? getTrackProbability(jobId, track) : Promise.resolve(undefined)),
    [jobId, track],
  );
  const rows = useMemo(() => (series.data ? rowsOf(series.data) : []), [series.data]);
  const chart = useRef<Chart | undefined>(undefined);
  if (!track)
    return <Empty title="Select a track to see how probable each of its candidates was." />;
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data) return <Loading what="probabilities" />;
  const badge = reducedBadge([{ ...series.data, name: "points" }]);
  const title = `Association probability of track ${track} over time`;
  const lines = hasExistence(rows) ? thresholds : [];
  const told = lines.map(({ name, existence }) => ` ${name} ${probability(existence)}.`).join("");
  const label = `${title}, ${rows.length} scans.${told} The table shows the same numbers.`;
  const data = series.data;
  return (
    <ChartFrame
      title={`Association probability, ${track}`}
      file={`probability-${track}-${jobId.slice(-12)}`}
      badge={badge}
      table={() => fromColumns(data.columns, clock.origin)}
      chart={() => chart.current}
      pictureKey={keyOf(rows)}
      tools={<Key marks={keyOf(rows)} />}
    >
      <ChartCanvas
        class="probability-canvas"
        label={label}
        keys={[rows, told, clock.time.value, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, { rows, thresholds }, clock);
        }}
        created={(made) => seekOnClick(made, clock)}
      />
    </ChartFrame>
  );
}

const keyOf = (rows: Row[]) => (palette: Palette) =>
  hasExistence(rows)
    ? [...pictureKey(palette), { name: "existence", color: palette.text, look: "dotted" as const }]
    : pictureKey(palette);

function pictureKey(palette: Palette): KeyMark[] {
  return [
    { name: "best detection", color: palette.track, look: "solid", symbol: SYMBOLS.best },
    { name: "none (ε)", color: palette.muted, look: "dashed", symbol: SYMBOLS.none },
    {
      name: "other candidates",
      color: palette.sensors[0] ?? palette.text,
      look: "dot",
      symbol: SYMBOLS.others,
    },
  ];
}
