// Curves over one axis, with bands where an interval is known: the common part of the charts that
// need no more.

import type { ComponentChildren, JSX } from "preact";
import { useRef } from "preact/hooks";
import type { TableData } from "../components/table";
import { number } from "../format";
import { type Palette, readPalette, theme } from "../state/theme";
import {
  axisLabel,
  GRID,
  lowerLabel,
  ruleAt,
  shareRange,
  textStyle,
  tipContent,
  tooltip,
  valueAxis,
} from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame } from "./frame";
import { Key, type KeyMark, symbolLook } from "./marks";

export type Point = [number, number | null];

export interface Curve {
  name: string;
  points: Point[];
  color: (palette: Palette) => string;
  look: KeyMark["look"];
  symbol?: string;
  /** Lower and upper limit at each point. */
  band?: ([number, number] | null)[] | undefined;
  /** Curves of one stack are drawn upon each other. */
  stack?: boolean;
  step?: boolean;
}

const SIX = 6;

/**
 * Colour, dash and shape of the n-th of several curves. No two of the first 18 are alike, and
 * neighbours differ without colour.
 */
export function lookOf(index: number): Pick<Curve, "color" | "look" | "symbol"> {
  const turned = index + Math.floor(index / SIX);
  const color = (palette: Palette) =>
    [palette.track, ...palette.sensors][index % (palette.sensors.length + 1)] ?? palette.track;
  const looks: KeyMark["look"][] = ["solid", "dashed", "dotted"];
  const symbols = ["circle", "rect", "triangle", "diamond", "emptyCircle", "emptyRect"];
  return {
    color,
    look: looks[turned % looks.length] ?? "solid",
    symbol: symbols[turned % SIX] ?? "circle",
  };
}

interface Props {
  title: string;
  file: string;
  label: string;
  curves: Curve[];
  xName: string;
  yName: string;
  table: () => TableData;
  /** What the values are: the axis of shares has all of 0 to 1, that of counts begins at 0. */
  values?: "shares" | "counts" | "values";
  logX?: boolean;
  logY?: boolean;
  badge?: string | undefined;
  tools?: ComponentChildren;
  class?: string;
  /** What a value of x is called in the tooltip. */
  xText?: (x: number) => string;
  /** A line at this x. */
  cursor?: number | undefined;
  /** Told where on the x axis the chart was clicked. */
  pick?: (x: number) => void;
}

/** Tells where a click inside the axes was. */
function whenPicked(chart: Chart, pick: (x: number) => void): () => void {
  const pressed = (event: { offsetX: number; offsetY: number }) => {
    if (!chart.containPixel("grid", [event.offsetX, event.offsetY])) return;
    const [x] = chart.convertFromPixel("grid", [
      event.offsetX,
      event.offsetY,
    ]) as unknown as number[];
    if (x !== undefined) pick(x);
  };
  chart.getZr().on("click", pressed);
  return () => chart.getZr().off("click", pressed);
}

const MARKS_UP_TO = 60;

/** Bands over each other must not become one dark field. */
const bandOpacity = (bands: number): number =>
  Math.max(0.04, Math.min(0.16, 0.4 / Math.max(bands, 1)));

const hasSymbols = (curve: Curve): boolean => !curve.stack && curve.points.length <= MARKS_UP_TO;

function lineOf(curve: Curve, palette: Palette, cursor: number | undefined): object {
  const color = curve.color(palette);
  const dots = curve.look === "dot";
  const lineStyle = { color, type: dots ? "solid" : curve.look, width: 1.8 };
  return {
    type: dots ? "scatter" : "line",
    name: curve.name,
    animation: false,
    data: curve.points,
    ...symbolLook(curve.symbol ?? "circle", color, palette.surface),
    symbolSize: dots ? 9 : 5,
    showSymbol: hasSymbols(curve),
    step: curve.step ? "end" : undefined,
    connectNulls: false,
    lineStyle,
    ...(curve.stack ? { stack: "parts", areaStyle: { color, opacity: 0.35 } } : {}),
    ...(cursor === undefined
      ? {}
      : { markLine: ruleAt({ xAxis: cursor }, { color: palette.selected }) }),
  };
}

/**
 * A band is two lines that are not seen, the upper one stacked on the lower, with the colour
 * between them.
 */
function bandOf(curve: Curve, palette: Palette, bands: number): object[] {
  const edge = (side: 0 | 1) =>
    curve.points.map(([x], index): Point => [x, curve.band?.[index]?.[side] ?? null]);
  const low = edge(0);
  const height = edge(1).map(
    ([x, high], index): Point => [
      x,
      high === null || low[index]?.[1] == null ? null : high - low[index][1],
    ],
  );
  const still = {
    type: "line",
    animation: false,
    silent: true,
    showSymbol: false,
    z: 1,
    tooltip: { show: false },
  };
  const limits = {
    ...still,
    stack: `band ${curve.name}`,
    stackStrategy: "all",
    lineStyle: { opacity: 0, width: 0 },
  };
  const areaStyle = { color: curve.color(palette), opacity: bandOpacity(bands) };
  return [
    { ...limits, name: `${curve.name} low`, data: low },
    { ...limits, name: `${curve.name} band`, data: height, areaStyle },
  ];
}

function seriesOf(
  curve: Curve,
  palette: Palette,
  cursor: number | undefined,
  bands: number,
): object[] {
  return [...(curve.band ? bandOf(curve, palette, bands) : []), lineOf(curve, palette, cursor)];
}

interface TipItem {
  seriesName?: string;
  value?: unknown;
}

function tip(items: TipItem[], props: Props): HTMLElement | string {
  const first = items[0]?.value;
  if (!Array.isArray(first)) return "";
  const x = Number(first[0]);
  const rows = props.curves.flatMap((curve): [string, string][] => {
    const at = curve.points.findIndex((point) => point[0] === x);
    const value = curve.points[at]?.[1];
    if (value === null || value === undefined) return [];
    const band = curve.band?.[at];
    return [
      [
        curve.name,
        band ? `${number(value)} [${number(band[0])}, ${number(band[1])}]` : number(value),
      ],
    ];
  });
  const heading = props.xText?.(x) ?? `${props.xName.replace(/ \(.*\)$/, "")} ${number(x)}`;
  return tipContent(heading, rows);
}

function xAxis(props: Props, palette: Palette): object {
  const xs = props.curves.flatMap((curve) => curve.points.map(([x]) => x));
  const range = xs.length ? { min: Math.min(...xs), max: Math.max(...xs) } : {};
  // Iterations and errors are counted in whole numbers.
  const least = xs.every(Number.isInteger) ? { minInterval: 1 } : {};
  return valueAxis(props.xName, palette, {
    ...least,
    ...(props.logX ? { type: "log" } : {}),
    ...range,
    nameGap: 26,
    axisLabel: lowerLabel(palette),
  });
}

/** The ends of the axis of values. */
function valueRange({ curves, logY, values = "values" }: Props): object {
  if (logY) return { type: "log" };
  if (values === "shares") return { min: 0, max: 1 };
  if (values === "counts") return { min: 0, minInterval: 1 };
  const limits = (curve: Curve) => (curve.band ?? []).flatMap((limit) => limit ?? []);
  const all = curves.flatMap((curve) => [
    ...curve.points.flatMap(([, value]) => value ?? []),
    ...limits(curve),
  ]);
  return all.length && !curves.some((curve) => curve.stack) ? shareRange(all) : {};
}

function yAxis(props: Props, palette: Palette): object {
  // Long numbers would reach into the name of the axis.
  const formatter = (value: number) =>
    Math.abs(value) >= 1e5 ? value.toExponential().replace("e+", "e") : number(value);
  const label = axisLabel(palette, { formatter });
  return valueAxis(props.yName, palette, {
    scale: true,
    ...valueRange(props),
    nameGap: 50,
    axisLabel: label,
  });
}

function draw(chart: Chart, props: Props): void {
  const palette = readPalette();
  const { curves, cursor } = props;
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: { ...GRID, left: 66 },
      tooltip: {
        trigger: "axis",
        ...tooltip(palette),
        formatter: (items: TipItem[]) => tip(items, props),
      },
      xAxis: xAxis(props, palette),
      yAxis: yAxis(props, palette),
      dataZoom: [{ type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl" }],
      series: curves.flatMap((curve) => seriesOf(curve, palette, cursor, curves.length)),
    },
    { replaceMerge: ["series"] },
  );
}

function markOf(curve: Curve, palette: Palette): KeyMark {
  const look = curve.stack ? "area" : curve.look;
  return {
    name: curve.name,
    color: curve.color(palette),
    look,
    symbol: hasSymbols(curve) ? (curve.symbol ?? "circle") : undefined,
  };
}

export function Lines(props: Props): JSX.Element {
  const chart = useRef<Chart | undefined>(undefined);
  const latest = useRef(props);
  latest.current = props;
  const { title, file, label, curves, table, badge, tools } = props;
  const key = (palette: Palette): KeyMark[] => curves.map((curve) => markOf(curve, palette));
  const under = (
    <>
      {tools}
      <Key marks={key} />
    </>
  );
  return (
    <ChartFrame
      title={title}
      file={file}
      badge={badge}
      table={table}
      chart={() => chart.current}
      pictureKey={key}
      tools={under}
    >
      <ChartCanvas
        class={props.class ?? "lines-canvas"}
        label={`${label} The table shows the same numbers.`}
        keys={[curves, props.logX, props.logY, props.cursor, props.yName, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, props);
        }}
        created={(made) => whenPicked(made, (x) => latest.current.pick?.(x))}
      />
    </ChartFrame>
  );
}
