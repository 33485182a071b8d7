// Curves over one axis, with bands where an interval is known: the common part of the charts that need no more.

import type { ComponentChildren, JSX } from "preact";
import { useRef } from "preact/hooks";
import type { TableData } from "../components/table";
import { number } from "../format";
import { readPalette, theme, type Palette } from "../state/theme";
import { GRID, textStyle, tipContent, tooltip, valueAxis } from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame } from "./frame";
import type { KeyMark } from "./picture";

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

/** Colour, dash and shape of the n-th of several curves. No two of the first 18 are alike, and neighbours differ without colour. */
export function lookOf(index: number): Pick<Curve, "color" | "look" | "symbol"> {
  const turned = index + Math.floor(index / SIX);
  const color = (palette: Palette) => [palette.track, ...palette.sensors][index % (palette.sensors.length + 1)] ?? palette.track;
  const looks: KeyMark["look"][] = ["solid", "dashed", "dotted"];
  return { color, look: looks[turned % looks.length] ?? "solid", symbol: ["circle", "rect", "triangle", "diamond", "emptyCircle", "emptyRect"][turned % SIX] ?? "circle" };
}

interface Props {
  title: string;
  file: string;
  label: string;
  curves: Curve[];
  xName: string;
  yName: string;
  table: () => TableData;
  /** Names of the values of x, where they are not numbers. */
  categories?: string[] | undefined;
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
    const [x] = chart.convertFromPixel("grid", [event.offsetX, event.offsetY]) as unknown as number[];
    if (x !== undefined) pick(x);
  };
  chart.getZr().on("click", pressed);
  return () => chart.getZr().off("click", pressed);
}

const MARKS_UP_TO = 60;

/** Bands over each other must not become one dark field. */
const bandOpacity = (bands: number): number => Math.max(0.04, Math.min(0.16, 0.4 / Math.max(bands, 1)));

function seriesOf(curve: Curve, palette: Palette, cursor: number | undefined, bands: number): object[] {
  const color = curve.color(palette);
  const type = curve.look === "dot" ? "solid" : curve.look;
  const mark = cursor === undefined ? {} : { markLine: { silent: true, symbol: "none", label: { show: false }, animation: false, lineStyle: { color: palette.selected, width: 1.5, type: "solid" }, data: [{ xAxis: cursor }] } };
  const dots = curve.look === "dot";
  const line = {
    type: dots ? "scatter" : "line",
    name: curve.name,
    animation: false,
    data: curve.points,
    symbol: curve.symbol ?? "circle",
    symbolSize: dots ? 9 : 5,
    showSymbol: curve.points.length <= MARKS_UP_TO,
    step: curve.step ? "end" : undefined,
    connectNulls: false,
    lineStyle: { color, type, width: 1.8 },
    itemStyle: { color },
    ...(curve.stack ? { stack: "parts", areaStyle: { color, opacity: 0.35 }, symbol: "none" } : {}),
    ...mark,
  };
  if (!curve.band) return [line];
  const edge = (side: 0 | 1) => curve.points.map(([x], index): Point => [x, curve.band?.[index]?.[side] ?? null]);
  const limits = { type: "line", animation: false, silent: true, showSymbol: false, z: 1, tooltip: { show: false } };
  const low = edge(0);
  const height = edge(1).map(([x, high], index): Point => [x, high === null || low[index]?.[1] == null ? null : high - low[index][1]]);
  const stack = `band ${curve.name}`;
  const none = { opacity: 0, width: 0 };
  return [
    { ...limits, name: `${curve.name} low`, data: low, stack, lineStyle: none, stackStrategy: "all" },
    { ...limits, name: `${curve.name} band`, data: height, stack, lineStyle: none, areaStyle: { color, opacity: bandOpacity(bands) }, stackStrategy: "all" },
    line,
  ];
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
    return [[curve.name, band ? `${number(value)} [${number(band[0])}, ${number(band[1])}]` : number(value)]];
  });
  const heading = props.categories?.[x] ?? props.xText?.(x) ?? `${props.xName.replace(/ \(.*\)$/, "")} ${number(x)}`;
  return tipContent(heading, rows);
}

function xAxis(props: Props, palette: Palette): object {
  const xs = props.curves.flatMap((curve) => curve.points.map(([x]) => x));
  if (props.categories) {
    const { categories } = props;
    const formatter = (value: number) => (Number.isInteger(value) ? (categories[value] ?? "") : "");
    return valueAxis(props.xName, palette, { min: -0.4, max: categories.length - 0.6, interval: 1, nameGap: 26, splitLine: { show: false }, axisLabel: { color: palette.muted, fontSize: 11, formatter, hideOverlap: true, width: 110, overflow: "truncate" } });
  }
  const range = { min: Math.min(...xs), max: Math.max(...xs) };
  const label = { color: palette.muted, fontSize: 11, hideOverlap: true };
  // Iterations and errors are counted in whole numbers.
  const least = xs.every(Number.isInteger) ? { minInterval: 1 } : {};
  return valueAxis(props.xName, palette, { ...least, ...(props.logX ? { type: "log" } : {}), ...(xs.length ? range : {}), nameGap: 26, axisLabel: label });
}

function draw(chart: Chart, props: Props): void {
  const palette = readPalette();
  // Long numbers would reach into the name of the axis.
  const formatter = (value: number) => (Math.abs(value) >= 1e5 ? value.toExponential().replace("e+", "e") : number(value));
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: { ...GRID, left: 66 },
      tooltip: { trigger: "axis", ...tooltip(palette), formatter: (items: TipItem[]) => tip(items, props) },
      xAxis: xAxis(props, palette),
      yAxis: valueAxis(props.yName, palette, { ...(props.logY ? { type: "log" } : {}), scale: true, nameGap: 50, axisLabel: { color: palette.muted, fontSize: 11, formatter, hideOverlap: true } }),
      dataZoom: [{ type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl" }],
      series: props.curves.flatMap((curve) => seriesOf(curve, palette, props.cursor, props.curves.length)),
    },
    { replaceMerge: ["series"] },
  );
}

export function Lines(props: Props): JSX.Element {
  const chart = useRef<Chart | undefined>(undefined);
  const latest = useRef(props);
  latest.current = props;
  const { title, file, label, curves, table, badge, tools } = props;
  const key = (palette: Palette): KeyMark[] => curves.map((curve) => ({ name: curve.name, color: curve.color(palette), look: curve.look }));
  return (
    <ChartFrame title={title} file={file} badge={badge} table={table} chart={() => chart.current} pictureKey={key} tools={<>{tools}<CurveKey curves={curves} /></>}>
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

const SYMBOLS: Record<string, string> = { circle: "M11 4.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5Z", rect: "M8.6 4.6h4.8v4.8H8.6Z", triangle: "m11 3.8 3 5.6H8Z", diamond: "m11 3.5 3.2 3.5-3.2 3.5L7.8 7Z" };

function CurveKey({ curves }: { curves: Curve[] }): JSX.Element {
  void theme.value;
  const palette = readPalette();
  const dashes = { solid: undefined, dashed: "5 3", dotted: "2 2.5", dot: undefined };
  return (
    <ul class="legend legend-note" aria-label="Key">
      {curves.map((curve) => (
        <li class="curve-key">
          <svg class="mark" viewBox="0 0 22 14" aria-hidden="true">
            {curve.look === "dot" ? null : <path d="M0 7h22" stroke={curve.color(palette)} stroke-dasharray={dashes[curve.look]} stroke-width={curve.stack ? 8 : 2} opacity={curve.stack ? 0.6 : 1} />}
            {curve.stack || (curve.look !== "dot" && !curve.symbol) ? null : <path d={SYMBOLS[(curve.symbol ?? "circle").replace("empty", "").toLowerCase()] ?? SYMBOLS["circle"]} fill={curve.color(palette)} />}
          </svg>
          {curve.name}
        </li>
      ))}
    </ul>
  );
}
