// Which track followed each target when: a lane a target, a bar a track, marks where tracks changed
// or broke. Every mark leads to its moment in the plan view.

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import { Link } from "../components/basics";
import type { TableData } from "../components/table";
import { number } from "../format";
import { type Palette, readPalette, theme } from "../state/theme";
import { param } from "../state/url";
import { timeAxisName, timeText } from "../times";
import type { Lane } from "./event-log";
import type { EventMoment } from "./event-moment";
import { ChartFrame } from "./frame";
import { Key, type KeyMark } from "./marks";
import { useRoom } from "./room";
import { ticks } from "./ticks";

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
  /** Where the times count from. */
  origin: number;
  /** Where a moment is shown. */
  href: (moment: EventMoment) => string;
  /** What that is called. */
  place: string;
}

function tableOf(lanes: Lane[], origin_s: number): TableData {
  const runs = lanes.flatMap((lane) =>
    lane.runs.map((run) => [lane.truth, "followed by", run.track, run.from, run.to, ""]),
  );
  const marks = lanes.flatMap((lane) =>
    lane.marks.map(({ kind, track, time, why }) => [lane.truth, kind, track, time, time, why]),
  );
  return {
    columns: ["truth_id", "what", "track_id", "from_s", "to_s", "why"],
    rows: [...runs, ...marks],
    origin_s,
  };
}

const NAMES = {
  switch: "switch to another track",
  break: "break",
  reacquisition: "taken up again",
} as const;

function colors(palette: Palette): string[] {
  return [palette.track, ...palette.sensors.slice(0, 4)];
}

export function Lanes(props: Props): JSX.Element {
  const { lanes, total, file, origin, place } = props;
  const box = useRef<HTMLDivElement>(null);
  const drawing = useRef<SVGSVGElement>(null);
  const width = useRoom(box);
  void theme.value;
  const palette = readPalette();
  const [from, to] = [
    Math.min(...lanes.map((lane) => lane.from)),
    Math.max(...lanes.map((lane) => lane.to)),
  ];
  const x = (time: number) =>
    LEFT_PX + ((time - from) / (to - from || 1)) * (width - LEFT_PX - RIGHT_PX);
  const asked = param("time");
  const now = asked === null || Number(asked) < from || Number(asked) > to ? null : Number(asked);
  const height = TOP_PX + lanes.length * LANE_PX + AXIS_PX;
  const note = (
    <>
      <Key marks={pictureKey} />
      <p class="muted small frame-note">
        A bar has a colour a track. A mark leads to its moment in {place}.
      </p>
    </>
  );
  const badge =
    props.badge ??
    (lanes.length < total ? `Shown: ${lanes.length} of ${total} targets` : undefined);
  return (
    <ChartFrame
      title="Who followed whom"
      file={file}
      badge={badge}
      table={() => tableOf(lanes, origin)}
      chart={() => drawing.current ?? undefined}
      pictureKey={pictureKey}
      tools={note}
    >
      <div class="lanes" ref={box}>
        <svg
          ref={drawing}
          class="drawing"
          width={width}
          height={height}
          viewBox={`0 0 ${width} ${height}`}
          role="group"
          aria-label={`Lanes of ${lanes.length} targets over time. The table shows the same.`}
        >
          {now === null ? null : (
            <path class="drawing-now" d={`M${x(now)} ${TOP_PX}V${height - AXIS_PX}`} />
          )}
          <Axis from={from} to={to} origin={origin} x={x} height={height} width={width} />
          {lanes.map((lane, row) => (
            <LaneRow
              key={lane.truth}
              lane={lane}
              y={TOP_PX + row * LANE_PX}
              x={x}
              palette={palette}
              origin={origin}
              href={props.href}
            />
          ))}
        </svg>
      </div>
    </ChartFrame>
  );
}

function pictureKey(of: Palette): KeyMark[] {
  return [
    { name: "followed", color: of.track, look: "area" },
    { name: "there, not followed", color: of.strongLine, look: "solid" },
    { name: "switch", color: of.selected, look: "dot", symbol: "down" },
    { name: "break", color: of.bad, look: "dot", symbol: "cross" },
    { name: "taken up again", color: of.text, look: "dot", symbol: "emptyCircle" },
  ];
}

interface AxisProps {
  from: number;
  to: number;
  origin: number;
  x: (time: number) => number;
  height: number;
  width: number;
}

function Axis({ from, to, origin, x, height, width }: AxisProps): JSX.Element {
  const times = ticks(from - origin, to - origin, Math.min(TICKS, width / 110));
  const bottom = height - AXIS_PX;
  return (
    <g class="drawing-axis">
      {times.map((time) => (
        <>
          <path class="drawing-grid" d={`M${x(time + origin)} ${TOP_PX}V${bottom}`} />
          <text x={x(time + origin)} y={bottom + 15} text-anchor="middle">
            {number(time)}
          </text>
        </>
      ))}
      <text x={(LEFT_PX + width - RIGHT_PX) / 2} y={height - 6} text-anchor="middle">
        {timeAxisName(origin)}
      </text>
    </g>
  );
}

interface RowProps {
  lane: Lane;
  y: number;
  x: (time: number) => number;
  palette: Palette;
  origin: number;
  href: (moment: EventMoment) => string;
}

function shortened(text: string): string {
  return text.length > 9 ? `${text.slice(0, 8)}…` : text;
}

function LaneRow({ lane, y, x, palette, origin, href }: RowProps): JSX.Element {
  const shades = colors(palette);
  const known = [...new Set(lane.runs.map((run) => run.track))];
  const middle = y + LANE_PX / 2;
  const span = ({ from, to }: { from: number; to: number }) =>
    `${timeText(from, origin)} to ${timeText(to, origin)}`;
  return (
    <g>
      <text
        class={`drawing-name${param("truth") === lane.truth ? " chosen" : ""}`}
        x={LEFT_PX - 8}
        y={middle}
        text-anchor="end"
        dominant-baseline="central"
      >
        {shortened(lane.truth)}
        <title>{lane.truth}</title>
      </text>
      <path
        class="lane-there"
        d={`M${x(lane.from)} ${middle}H${Math.max(x(lane.to), x(lane.from) + 2)}`}
      />
      {lane.runs.map((run) => (
        <path
          d={`M${x(run.from)} ${middle}H${Math.max(x(run.to), x(run.from) + 3)}`}
          stroke={shades[known.indexOf(run.track) % shades.length]}
          stroke-width={9}
        >
          <title>{`${lane.truth} followed by track ${run.track}, ${span(run)}`}</title>
        </path>
      ))}
      {lane.marks.map((mark) => {
        const when = `${NAMES[mark.kind]} at ${timeText(mark.time, origin)}`;
        const label = `${lane.truth}: ${when}${mark.track ? `, track ${mark.track}` : ""}`;
        const why = mark.why ? `${label}. ${mark.why}` : label;
        return (
          <Link
            href={href({ ...mark, truth: lane.truth })}
            label={why}
            class={`lane-mark lane-${mark.kind}`}
          >
            <Sign kind={mark.kind} x={x(mark.time)} y={middle} />
          </Link>
        );
      })}
    </g>
  );
}

function Sign({
  kind,
  x,
  y,
}: {
  kind: Lane["marks"][number]["kind"];
  x: number;
  y: number;
}): JSX.Element {
  const shapes = {
    switch: `M${x - 5} ${y - 9}h10l-5 8Z`,
    break: `m${x - 4} ${y - 4} 8 8m0-8-8 8`,
    reacquisition: `M${x - 3.5} ${y}a3.5 3.5 0 1 0 7 0 3.5 3.5 0 1 0-7 0Z`,
  };
  return (
    <>
      <rect
        x={x - 8}
        y={y - LANE_PX / 2}
        width={16}
        height={LANE_PX}
        fill="transparent"
        stroke="none"
      />
      <path d={shapes[kind]} />
    </>
  );
}
