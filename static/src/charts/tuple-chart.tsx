// How well the tracks of each tuple agree: its p-value over the threshold of the statistic, right
// and wrong told apart.

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import type { CorrelationTuple } from "../api/types";
import type { TableData } from "../components/table";
import { number } from "../format";
import { type Palette, readPalette, theme } from "../state/theme";
import {
  axisLabel,
  GRID,
  lowerLabel,
  ruleAt,
  textStyle,
  tipContent,
  tooltip,
  valueAxis,
} from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame } from "./frame";
import { Key, type KeyMark } from "./marks";

/** Smaller probabilities are drawn here. */
const LEAST_P = 1e-12;

type Group = "right" | "wrong" | "unknown";

const SYMBOLS: Record<Group, string> = { right: "circle", wrong: "diamond", unknown: "circle" };
const NAMES: Record<Group, string> = { right: "right", wrong: "wrong", unknown: "tuple" };

function colorOf(group: Group, palette: Palette): string {
  return { right: palette.good, wrong: palette.bad, unknown: palette.track }[group];
}

function groupOf(tuple: CorrelationTuple): Group {
  if (tuple.right === undefined) return "unknown";
  return tuple.right ? "right" : "wrong";
}

interface Props {
  tuples: CorrelationTuple[];
  alpha: number | undefined;
  file: string;
  table: () => TableData;
  badge?: string | undefined;
  pick: (tuple: CorrelationTuple) => void;
}

function seriesOf(tuples: CorrelationTuple[], group: Group, palette: Palette): object {
  const data = tuples.flatMap((tuple, index) => {
    const { p_value } = tuple;
    return groupOf(tuple) === group && typeof p_value === "number"
      ? [[index + 1, Math.max(p_value, LEAST_P), index]]
      : [];
  });
  const look = {
    symbol: SYMBOLS[group],
    symbolSize: group === "wrong" ? 12 : 9,
    itemStyle: { color: colorOf(group, palette) },
  };
  return {
    type: "scatter",
    name: NAMES[group],
    data,
    ...look,
    animation: false,
    cursor: "pointer",
  };
}

function threshold(alpha: number | undefined, palette: Palette): object[] {
  if (alpha === undefined) return [];
  const color = palette.selected;
  const label = {
    show: true,
    formatter: `α = ${alpha}`,
    position: "insideEndTop",
    color,
    fontSize: 11,
  };
  return [
    {
      type: "scatter",
      name: "threshold",
      data: [],
      markLine: ruleAt({ yAxis: alpha }, { color, type: "dashed", label }),
    },
  ];
}

function tip(tuple: CorrelationTuple | undefined): HTMLElement | string {
  if (!tuple) return "";
  const right = tuple.right === undefined ? "not known" : tuple.right ? "right" : "wrong";
  return tipContent(`System track ${tuple.system_track_id}`, [
    ["tracks", tuple.tracks.map((track) => track ?? "–").join(", ")],
    ["Q", `${number(tuple.statistic)} with ${tuple.degrees_of_freedom} d.o.f.`],
    ["p-value", number(tuple.p_value)],
    ["is", right],
  ]);
}

function draw(chart: Chart, { tuples, alpha }: Props, groups: Group[]): void {
  const palette = readPalette();
  const least = Math.min(
    alpha ?? 1,
    ...tuples.map((tuple) => Math.max(tuple.p_value ?? 1, LEAST_P)),
  );
  const lowest = 10 ** Math.floor(Math.log10(least) - 0.2);
  const formatter = (value: number) => (value >= 0.01 ? String(value) : value.toExponential(0));
  const label = lowerLabel(palette, { showMinLabel: false, showMaxLabel: false });
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: { ...GRID, left: 66 },
      tooltip: {
        trigger: "item",
        ...tooltip(palette),
        formatter: ({ data }: { data?: unknown }) =>
          Array.isArray(data) ? tip(tuples[Number(data[2])]) : "",
      },
      xAxis: valueAxis("system track", palette, {
        min: 0,
        max: tuples.length + 1,
        minInterval: 1,
        nameGap: 26,
        axisLabel: label,
      }),
      yAxis: valueAxis("p-value", palette, {
        type: "log",
        min: lowest,
        max: 1,
        nameGap: 48,
        axisLabel: axisLabel(palette, { formatter }),
      }),
      series: [
        ...groups.map((group) => seriesOf(tuples, group, palette)),
        ...threshold(alpha, palette),
      ],
    },
    { replaceMerge: ["series"] },
  );
}

export function TupleChart(props: Props): JSX.Element {
  const { tuples, alpha, file, table, badge } = props;
  const chart = useRef<Chart | undefined>(undefined);
  const groups = useMemo(() => [...new Set(tuples.map(groupOf))], [tuples]);
  const key = (palette: Palette): KeyMark[] => [
    ...groups.map(
      (group): KeyMark => ({
        name: NAMES[group],
        color: colorOf(group, palette),
        look: "dot",
        symbol: SYMBOLS[group],
      }),
    ),
    ...(alpha === undefined
      ? []
      : [{ name: `threshold α = ${alpha}`, color: palette.selected, look: "dashed" } as const]),
  ];
  const pressed = (item: { data?: unknown }) => {
    const tuple = Array.isArray(item.data) ? tuples[Number(item.data[2])] : undefined;
    if (tuple) props.pick(tuple);
  };
  const over = alpha === undefined ? "" : ` over the threshold ${alpha}`;
  return (
    <ChartFrame
      title="How well the tracks of each tuple agree"
      file={file}
      badge={badge}
      table={table}
      chart={() => chart.current}
      pictureKey={key}
      tools={<Key marks={key} />}
    >
      <ChartCanvas
        class="lines-canvas"
        label={`p-values of ${tuples.length} tuples${over}. The table shows the same numbers.`}
        keys={[tuples, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, props, groups);
        }}
        created={(made) => {
          made.on("click", pressed);
          return () => made.off("click", pressed);
        }}
      />
    </ChartFrame>
  );
}
