// Which track followed each target when: a lane a target, a bar a track, marks where tracks changed or broke. Every mark leads to
// its moment in the plan view.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { Link } from "../components/basics";
import type { TableData } from "../components/table";
import { number } from "../format";
import { readPalette, theme, type Palette } from "../state/theme";
import { hereHref, param } from "../state/url";
import type { Lane } from "./event-log";
import { ChartFrame } from "./frame";
import type { KeyMark } from "./picture";

const LANE_PX = 22;
const TOP_PX = 8;
const AXIS_PX = 40;
const LEFT_PX = 76;
const RIGHT_PX = 14;
const TICKS = 6;

interface Props {
  lanes: Lane[];
  /** Lanes that there are in all. */
  total: number;
  file: string;
  badge?: string | undefined;
}

/** A round step that divides a span into about `count` parts. */
function niceStep(span: number, count: number): number {
  const raw = span / Math.max(count, 1) || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  return ([1, 2, 5, 10].find((factor) => factor * power >= raw) ?? 10) * power;
}

function tableOf(lanes: Lane[]): TableData {
  const runs = lanes.flatMap((lane) => lane.runs.map((run) => [lane.truth, "followed by", run.track, run.from, run.to]));
  const marks = lanes.flatMap((lane) => lane.marks.map((mark) => [lane.truth, mark.kind, mark.track, mark.time, mark.time]));
  return { columns: ["truth_id", "what", "track_id", "from_s", "to_s"], rows: [...runs, ...marks] };
}

const NAMES = { switch: "switch to another track", break: "break", reacquisition: "taken up again" } as const;

function colors(palette: Palette): string[] {
  return [palette.track, ...palette.sensors.slice(0, 4)];
}

export function Lanes({ lanes, total, file, badge }: Props): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const drawing = useRef<SVGSVGElement>(null);
  const [width, setWidth] = useState(900);
  useEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    const observer = new ResizeObserver(() => setWidth(Math.max(element.clientWidth, 280)));
    observer.observe(element);
    return () => observer.disconnect();
  }, []);
  void theme.value;
  const palette = readPalette();
  const [from, to] = [Math.min(...lanes.map((lane) => lane.from)), Math.max(...lanes.map((lane) => lane.to))];
  const origin = Math.abs(from) > 1e6 ? from : 0;
  const x = (time: number) => LEFT_PX + ((time - from) / (to - from || 1)) * (width - LEFT_PX - RIGHT_PX);
  const asked = param("time");
  const now = asked === null || Number(asked) < from || Number(asked) > to ? null : Number(asked);
  const height = TOP_PX + lanes.length * LANE_PX + AXIS_PX;
  const key = (of: Palette): KeyMark[] => [
    { name: "target there, not followed", color: of.line, look: "solid" },
    { name: "followed (a colour a track)", color: of.track, look: "solid" },
    { name: "switch", color: of.selected, look: "dot" },
    { name: "break", color: of.bad, look: "dot" },
  ];
  const note = (
    <p class="legend legend-note">
      <span class="key key-lane">followed, a colour a track</span>
      <span class="key key-unfollowed">there, not followed</span>
      <span class="key-sign key-switch">▼ switch</span>
      <span class="key-sign key-break">✕ break</span>
      <span class="key-sign">○ taken up again</span>
      <span>A mark leads to its moment in the plan view.</span>
    </p>
  );
  return (
    <ChartFrame title="Who followed whom" file={file} badge={badge ?? (lanes.length < total ? `Shown: ${lanes.length} of ${total} targets` : undefined)} table={() => tableOf(lanes)} chart={() => drawing.current ?? undefined} pictureKey={key} tools={note}>
      <div class="lanes" ref={box}>
        <svg ref={drawing} class="drawing" width={width} height={height} viewBox={`0 0 ${width} ${height}`} role="group" aria-label={`Lanes of ${lanes.length} targets over time. The table shows the same.`}>
          {now === null ? null : <path class="drawing-now" d={`M${x(now)} ${TOP_PX}V${height - AXIS_PX}`} />}
          <Axis from={from} to={to} origin={origin} x={x} height={height} width={width} />
          {lanes.map((lane, row) => (
            <LaneRow key={lane.truth} lane={lane} y={TOP_PX + row * LANE_PX} x={x} palette={palette} />
          ))}
        </svg>
      </div>
    </ChartFrame>
  );
}

function Axis({ from, to, origin, x, height, width }: { from: number; to: number; origin: number; x: (time: number) => number; height: number; width: number }): JSX.Element {
  const step = niceStep(to - from, Math.min(TICKS, width / 110));
  const first = Math.ceil((from - origin) / step) * step + origin;
  const ticks = Array.from({ length: Math.max(Math.floor((to - first) / step) + 1, 0) }, (_, index) => first + index * step);
  const bottom = height - AXIS_PX;
  return (
    <g class="drawing-axis">
      {ticks.map((time) => (
        <>
          <path class="drawing-grid" d={`M${x(time)} ${TOP_PX}V${bottom}`} />
          <text x={x(time)} y={bottom + 15} text-anchor="middle">
            {number(time - origin)}
          </text>
        </>
      ))}
      <text x={(LEFT_PX + width - RIGHT_PX) / 2} y={height - 6} text-anchor="middle">
        {origin ? "time from the first step (s)" : "time (s)"}
      </text>
    </g>
  );
}

interface RowProps {
  lane: Lane;
  y: number;
  x: (time: number) => number;
  palette: Palette;
}

function shortened(text: string): string {
  return text.length > 9 ? `${text.slice(0, 8)}…` : text;
}

function LaneRow({ lane, y, x, palette }: RowProps): JSX.Element {
  const shades = colors(palette);
  const known = [...new Set(lane.runs.map((run) => run.track))];
  const middle = y + LANE_PX / 2;
  return (
    <g>
      <text class="drawing-name" x={LEFT_PX - 8} y={middle} text-anchor="end" dominant-baseline="central">
        {shortened(lane.truth)}
        <title>{lane.truth}</title>
      </text>
      <path class="lane-there" d={`M${x(lane.from)} ${middle}H${Math.max(x(lane.to), x(lane.from) + 2)}`} />
      {lane.runs.map((run) => (
        <path d={`M${x(run.from)} ${middle}H${Math.max(x(run.to), x(run.from) + 3)}`} stroke={shades[known.indexOf(run.track) % shades.length]} stroke-width={9}>
          <title>{`${lane.truth} followed by track ${run.track}, ${number(run.from)} to ${number(run.to)} s`}</title>
        </path>
      ))}
      {lane.marks.map((mark) => {
        const label = `${lane.truth}: ${NAMES[mark.kind]} at ${number(mark.time)} s${mark.track ? `, track ${mark.track}` : ""}`;
        return (
          <Link href={placeOf(lane.truth, mark.track, mark.time)} label={label} class={`lane-mark lane-${mark.kind}`}>
            <Sign kind={mark.kind} x={x(mark.time)} y={middle} />
          </Link>
        );
      })}
    </g>
  );
}

function Sign({ kind, x, y }: { kind: Lane["marks"][number]["kind"]; x: number; y: number }): JSX.Element {
  const shapes = { switch: `M${x - 5} ${y - 9}h10l-5 8Z`, break: `m${x - 4} ${y - 4} 8 8m0-8-8 8`, reacquisition: `M${x - 3.5} ${y}a3.5 3.5 0 1 0 7 0 3.5 3.5 0 1 0-7 0Z` };
  return (
    <>
      <rect x={x - 8} y={y - LANE_PX / 2} width={16} height={LANE_PX} fill="transparent" stroke="none" />
      <path d={shapes[kind]} />
    </>
  );
}

export function placeOf(truth: string, track: string, time: number): string {
  return hereHref({ tab: "plan", truth: truth || null, track: track || null, time, centre: "selection", span: null });
}
