// How probable each motion model of the filter was for one track, scan by scan: stacked, so that
// together they are 1.

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import { getModeProbability } from "../api/client";
import type { ModeProbability } from "../api/types";
import { Loading, ProblemBox } from "../components/basics";
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
import { Key, type KeyMark } from "./marks";

type Point = [number, number];

/** The points of each model, in the order of the request. */
function linesOf(series: ModeProbability, models: string[], origin: number): Point[][] {
  const lines: Point[][] = models.map(() => []);
  const { time_s, model, probability: values } = series.columns;
  for (const [row, time] of time_s.entries())
    lines[(model[row] ?? 0) - 1]?.push([time - origin, values[row] ?? 0]);
  return lines;
}

const colorOf = (palette: Palette, model: number): string =>
  [palette.track, ...palette.sensors][model] ?? palette.muted;

/** Models of one kind are told apart by their places. */
function namesOf(models: string[]): string[] {
  const words = models.map((model) => model.replaceAll("_", " "));
  return words.map((word, at) =>
    words.indexOf(word) === words.lastIndexOf(word) ? word : `${word} (${at + 1})`,
  );
}

function draw(chart: Chart, lines: Point[][], names: string[], clock: Clock): void {
  const palette = readPalette();
  const { origin, time } = clock;
  const cursor = ruleAt({ xAxis: time.value - origin }, { color: palette.selected });
  const series = lines.map((data, model) => ({
    ...{ type: "line", stack: "models", step: "middle", symbol: "none", animation: false },
    ...{ name: names[model], data },
    lineStyle: { width: 0.6, color: colorOf(palette, model) },
    itemStyle: { color: colorOf(palette, model) },
    areaStyle: { color: colorOf(palette, model), opacity: 0.55 },
    ...(model ? {} : { markLine: cursor }),
  }));
  const tip = (items: { value?: unknown; seriesName?: string }[]) => {
    const values = items.map((item) => (Array.isArray(item.value) ? item.value : []));
    const at = Number(values[0]?.[0] ?? 0) + origin;
    const rows = items.map((item, row): [string, string] => [
      item.seriesName ?? "",
      probability(Number(values[row]?.[1] ?? 0)),
    ]);
    return tipContent(timeText(at, origin), rows);
  };
  const pointer = { type: "line", lineStyle: { color: palette.muted } };
  const label = lowerLabel(palette, { showMinLabel: false, showMaxLabel: false });
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: { trigger: "axis", axisPointer: pointer, ...tooltip(palette), formatter: tip },
      xAxis: valueAxis(timeAxisName(origin), palette, {
        min: lines[0]?.[0]?.[0],
        max: lines[0]?.at(-1)?.[0],
        nameGap: 24,
        axisLabel: label,
      }),
      yAxis: valueAxis("probability", palette, { min: 0, max: 1, nameGap: 34 }),
      dataZoom: [{ type: "inside", xAxisIndex: 0, filterMode: "none", zoomOnMouseWheel: "ctrl" }],
      series,
    },
    { replaceMerge: ["series"] },
  );
}

/** A click moves the clock to the scan under it. */
function seekOnClick(chart: Chart, clock: Clock): () => void {
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

interface Props {
  jobId: string;
  track: string;
  /** Kinds of the models, in the order of the request. */
  models: string[];
  clock: Clock;
}

export function ModesChart({ jobId, track, models, clock }: Props): JSX.Element {
  const series = useResource(() => getModeProbability(jobId, track), [jobId, track]);
  const names = namesOf(models);
  const lines = useMemo(
    () => (series.data ? linesOf(series.data, models, clock.origin) : []),
    [series.data],
  );
  const chart = useRef<Chart | undefined>(undefined);
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data) return <Loading what="models" />;
  const data = series.data;
  const key = (palette: Palette): KeyMark[] =>
    names.map((name, model) => ({ name, color: colorOf(palette, model), look: "solid" }));
  const title = `Probability of each motion model of track ${track} over time`;
  return (
    <ChartFrame
      title={`Motion models, ${track}`}
      file={`models-${track}-${jobId.slice(-12)}`}
      badge={reducedBadge([{ ...data, name: "points" }])}
      table={() => fromColumns(data.columns, clock.origin)}
      chart={() => chart.current}
      pictureKey={key}
      tools={<Key marks={key} />}
    >
      <ChartCanvas
        class="modes-canvas"
        label={`${title}: ${names.join(", ")}. The table shows the same numbers.`}
        keys={[lines, clock.time.value, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, lines, names, clock);
        }}
        created={(made) => seekOnClick(made, clock)}
      />
    </ChartFrame>
  );
}
