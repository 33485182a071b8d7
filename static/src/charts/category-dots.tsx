// Means over what has a name and no order: a row a name with a dot for each mean and a whisker for
// its interval, the greatest above.

import type { ComponentChildren, JSX } from "preact";
import { useRef } from "preact/hooks";
import type { TableData } from "../components/table";
import { count, number } from "../format";
import { type Palette, readPalette, theme } from "../state/theme";
import { shareRange } from "./axes";
import { ChartFrame } from "./frame";
import { lookOf } from "./lines";
import { Key, type KeyMark, MARK_WIDTH, MarkShapes } from "./marks";
import { useRoom } from "./room";
import { decades, niceStep, ticks } from "./ticks";

export interface Estimate {
  mean: number;
  low?: number | undefined;
  high?: number | undefined;
  /** How many runs it is of. */
  runs?: number | undefined;
}

export interface Row {
  name: string;
  /** One for each series; nothing where a cell has no number. */
  estimates: (Estimate | undefined)[];
}

interface Props {
  title: string;
  file: string;
  label: string;
  rows: Row[];
  series: string[];
  valueName: string;
  log?: boolean;
  table: () => TableData;
  badge?: string | undefined;
  tools?: ComponentChildren;
}

const [LINE_PX, PAD_PX, TOP_PX, AXIS_PX, RIGHT_PX, END_PX] = [15, 9, 6, 40, 70, 18];
const LETTER_PX = 6.4;
const TICK_PX = 60;
const MOST_OF_WIDTH = 0.42;
const NARROW_LEFT_PX = 22;

interface Scale {
  from: number;
  to: number;
  marks: number[];
  x: (value: number) => number;
}

function meanOf({ estimates }: Row): number {
  const means = estimates.flatMap((estimate) => estimate?.mean ?? []);
  return means.length ? means.reduce((sum, mean) => sum + mean, 0) / means.length : -Infinity;
}

/** The greatest first; of equals in the order in which they were asked for. */
const sorted = (rows: Row[]): Row[] => [...rows].sort((a, b) => meanOf(b) - meanOf(a) || 0);

/** Round limits around all values; those of shares stay within 0 and 1. */
function limits(values: number[], log: boolean): [number, number] {
  const [least, greatest] = [Math.min(...values), Math.max(...values)];
  if (log)
    return [10 ** Math.floor(Math.log10(least)), 10 ** Math.ceil(Math.log10(greatest) + 1e-9)];
  const step = niceStep(greatest - least || Math.abs(greatest) || 1, 5);
  const share = shareRange(values);
  return [
    share.min ?? Math.floor(least / step) * step,
    share.max ?? Math.ceil(greatest / step) * step,
  ];
}

function scaleOf(rows: Row[], log: boolean, left: number, width: number): Scale {
  const all = rows.flatMap((row) => row.estimates).filter((estimate) => estimate !== undefined);
  const values = all.flatMap(({ mean, low, high }) => [mean, low ?? mean, high ?? mean]);
  const [from, to] = limits(values.length ? values : [0, 1], log);
  const place = (value: number) =>
    log ? Math.log10(value / from) / Math.log10(to / from) : (value - from) / (to - from || 1);
  const marks = log
    ? decades(from, to)
    : ticks(from, to, Math.max((width - left - RIGHT_PX) / TICK_PX, 2));
  return { from, to, marks, x: (value) => left + place(value) * (width - left - RIGHT_PX) };
}

function estimateText({ mean, low, high, runs }: Estimate): string {
  const interval =
    low === undefined || high === undefined ? "" : ` [${number(low)}, ${number(high)}]`;
  return `${number(mean)}${interval}${runs === undefined ? "" : `, ${count(runs)} runs`}`;
}

/** `n = 5`, or the range of what the dots of a row are of. */
function sizeText({ estimates }: Row): string {
  const runs = estimates.flatMap((estimate) => estimate?.runs ?? []);
  if (!runs.length) return "";
  const [least, most] = [Math.min(...runs), Math.max(...runs)];
  return `n = ${count(least)}${most > least ? ` to ${count(most)}` : ""}`;
}

function markOf(order: number, name: string, palette: Palette): KeyMark {
  const { color, symbol } = lookOf(order);
  return { name, color: color(palette), look: "dot", symbol };
}

export function CategoryDots(props: Props): JSX.Element {
  const { title, file, label, series, badge, table, tools } = props;
  const box = useRef<HTMLDivElement>(null);
  const drawing = useRef<SVGSVGElement>(null);
  const width = useRoom(box);
  const rows = sorted(props.rows);
  const layout = layoutOf(rows, series.length, width);
  const height = rows.length * layout.rowHeight + TOP_PX + AXIS_PX;
  const scale = scaleOf(rows, props.log ?? false, layout.left, width);
  const key = (palette: Palette) => series.map((name, order) => markOf(order, name, palette));
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
      chart={() => drawing.current ?? undefined}
      pictureKey={key}
      tools={under}
    >
      <div class="lanes" ref={box}>
        <svg
          ref={drawing}
          class="drawing category-dots"
          width={width}
          height={height}
          viewBox={`0 0 ${width} ${height}`}
          role="img"
          aria-label={`${label} The table shows the same numbers.`}
        >
          <Axis
            scale={scale}
            name={props.valueName}
            left={layout.left}
            width={width}
            height={height}
          />
          {rows.map((row, index) => (
            <RowMarks
              key={row.name}
              row={row}
              top={TOP_PX + index * layout.rowHeight}
              scale={scale}
              layout={layout}
              width={width}
            />
          ))}
        </svg>
      </div>
    </ChartFrame>
  );
}

/**
 * Names stand at the left of their rows, or above them where that would leave no room for the dots.
 */
interface Layout {
  left: number;
  rowHeight: number;
  /** How far below the top of a row its marks begin. */
  marksFrom: number;
}

function layoutOf(rows: Row[], series: number, width: number): Layout {
  const left = Math.max(...rows.map((row) => row.name.length)) * LETTER_PX + 18;
  const ofMarks = series * LINE_PX + PAD_PX;
  if (left <= width * MOST_OF_WIDTH) return { left, rowHeight: ofMarks, marksFrom: 0 };
  return { left: NARROW_LEFT_PX, rowHeight: ofMarks + LINE_PX, marksFrom: LINE_PX };
}

interface AxisProps {
  scale: Scale;
  name: string;
  left: number;
  width: number;
  height: number;
}

function Axis({ scale, name, left, width, height }: AxisProps): JSX.Element {
  const bottom = height - AXIS_PX;
  return (
    <g class="drawing-axis">
      {scale.marks.map((value) => (
        <>
          <path class="drawing-grid" d={`M${scale.x(value)} ${TOP_PX}V${bottom}`} />
          <text x={scale.x(value)} y={bottom + 15} text-anchor="middle">
            {number(value)}
          </text>
        </>
      ))}
      <text x={(left + width - RIGHT_PX) / 2} y={height - 6} text-anchor="middle">
        {name}
      </text>
    </g>
  );
}

interface RowMarksProps {
  row: Row;
  top: number;
  scale: Scale;
  layout: Layout;
  width: number;
}

function RowMarks({ row, top, scale, layout, width }: RowMarksProps): JSX.Element {
  void theme.value;
  const palette = readPalette();
  const marks = top + layout.marksFrom;
  const middle = marks + (layout.rowHeight - layout.marksFrom) / 2;
  const isAbove = layout.marksFrom > 0;
  const [nameX, nameY] = isAbove
    ? [NARROW_LEFT_PX, top + LINE_PX / 2 + 2]
    : [layout.left - 10, middle];
  return (
    <g class="category-row">
      <text
        class="drawing-name"
        x={nameX}
        y={nameY}
        text-anchor={isAbove ? "start" : "end"}
        dominant-baseline="central"
      >
        {row.name}
      </text>
      {row.estimates.map((estimate, order) => {
        const y = marks + PAD_PX / 2 + (order + 0.5) * LINE_PX;
        return estimate ? (
          <EstimateMark
            estimate={estimate}
            name={row.name}
            mark={markOf(order, "", palette)}
            y={y}
            x={scale.x}
          />
        ) : null;
      })}
      <text x={width - END_PX / 2} y={middle} text-anchor="end" dominant-baseline="central">
        {sizeText(row)}
      </text>
    </g>
  );
}

interface EstimateMarkProps {
  estimate: Estimate;
  name: string;
  mark: KeyMark;
  y: number;
  x: (value: number) => number;
}

function EstimateMark({ estimate, name, mark, y, x }: EstimateMarkProps): JSX.Element {
  const { mean, low, high } = estimate;
  const whisker =
    low === undefined || high === undefined
      ? ""
      : `M${x(low)} ${y}H${x(high)}M${x(low)} ${y - 3.5}v7M${x(high)} ${y - 3.5}v7`;
  return (
    <g class="estimate">
      <path d={whisker} stroke={mark.color} stroke-width={1.6} />
      <g transform={`translate(${x(mean) - MARK_WIDTH / 2} ${y})`}>
        <MarkShapes mark={mark} />
      </g>
      <title>{`${name}: ${estimateText(estimate)}`}</title>
    </g>
  );
}
