// The automaton along time with one target's way through it: accepted scans on one line; where the
// string breaks, the target goes on above and the track below, and the weight that the track gave
// to the target's own symbol stands underneath.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Cell, TargetVerdict } from "../api/types";
import { Link } from "../components/basics";
import type { TableData } from "../components/table";
import { probability } from "../format";
import type { Palette } from "../state/theme";
import { go, hereHref } from "../state/url";
import { type Automaton, EPSILON, type Expected, type Step, type Way, wayOf } from "./automaton";
import { NO_EVENT } from "./event-moment";
import { ChartFrame } from "./frame";
import { Key, type KeyMark } from "./marks";

const LEFT = 104;
const RIGHT = 20;
const LEAST_STEP_PX = 18;
const LABELLED_STEP_PX = 40;
const Y = { truth: 34, way: 78, track: 122, base: 206, bars: 150 };
const HEIGHT = 246;

interface Props {
  verdict: TargetVerdict;
  expected: Expected[];
  automaton: Automaton;
  file: string;
  /** Where the times count from. */
  origin: number;
}

export function AutomatonView({ verdict, expected, automaton, file, origin }: Props): JSX.Element {
  const way = useMemo(() => wayOf(automaton, expected), [automaton, expected]);
  const box = useRef<HTMLDivElement>(null);
  const drawing = useRef<SVGSVGElement>(null);
  const [room, setRoom] = useState(900);
  useEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    const observer = new ResizeObserver(() => setRoom(element.clientWidth));
    observer.observe(element);
    return () => observer.disconnect();
  }, []);
  useEffect(() => {
    // A long way is wider than its box: the break is what people come for.
    if (box.current && way.break_ !== undefined)
      box.current.scrollLeft = x(way.break_) - box.current.clientWidth / 2;
  }, [way, room]);
  const scans = scansOf(way);
  const step = Math.max((room - LEFT - RIGHT) / Math.max(scans.length - 0.5, 1), LEAST_STEP_PX);
  const width = LEFT + RIGHT + step * Math.max(scans.length - 0.5, 1);
  const x = (index: number) => LEFT + step * (index + 0.25);
  const end =
    way.break_ === undefined
      ? "accepted to its end"
      : `broken at scan ${way.steps[way.break_]?.scan}`;
  const over = `through the automaton over ${way.steps.length} scans, ${end}`;
  const label = `Way of target ${verdict.truth_id} ${over}. The table shows the same.`;
  const seek = (event: MouseEvent) => {
    const index = Math.round((event.offsetX - LEFT) / step - 0.25);
    const time = timeAt(way, scans[Math.min(Math.max(index, 0), scans.length - 1)]);
    if (time !== undefined && !(event.target as Element).closest("a")) go(placeOf(verdict, time));
  };
  return (
    <ChartFrame
      title={`Target ${verdict.truth_id} in the automaton`}
      file={file}
      table={() => tableOf(way, origin)}
      chart={() => drawing.current ?? undefined}
      pictureKey={pictureKey}
      tools={<Under isMinimised={automaton.minimised} />}
    >
      <div class="automaton" ref={box} tabIndex={0} role="region" aria-label={label}>
        {/* biome-ignore lint/a11y/useKeyWithClickEvents: the clock has its keys in its own bar */}
        <svg
          ref={drawing}
          class="drawing"
          width={width}
          height={HEIGHT}
          viewBox={`0 0 ${width} ${HEIGHT}`}
          role="group"
          aria-label={label}
          onClick={seek}
        >
          <Names broken={way.break_ !== undefined} />
          <Ticks scans={scans} x={x} step={step} />
          <Accepted way={way} x={x} step={step} />
          {way.break_ === undefined ? null : (
            <Broken way={way} scans={scans} x={x} step={step} verdict={verdict} />
          )}
          <Weights way={way} x={x} step={step} />
        </svg>
      </div>
    </ChartFrame>
  );
}

function Under({ isMinimised }: { isMinimised: boolean }): JSX.Element {
  return (
    <>
      <Key marks={pictureKey} />
      {isMinimised ? <p class="muted small frame-note">Minimised: without weights.</p> : null}
    </>
  );
}

function placeOf(verdict: TargetVerdict, time: number): string {
  const track = verdict.track_id ?? verdict.matched_track_id ?? null;
  return hereHref({
    ...NO_EVENT,
    tab: "plan",
    time,
    truth: verdict.truth_id,
    track,
    centre: "selection",
    span: null,
  });
}

/** Every scan of the target and of the track that goes on without it. */
function scansOf(way: Way): number[] {
  return [
    ...new Set([...way.steps.map((step) => step.scan), ...way.taken.map((step) => step.scan)]),
  ].sort((a, b) => a - b);
}

function timeAt(way: Way, scan: number | undefined): number | undefined {
  return [...way.steps, ...way.taken].find((step) => step.scan === scan)?.time;
}

function Names({ broken }: { broken: boolean }): JSX.Element {
  const name = (y: number, text: string) => (
    <text class="drawing-name" x={8} y={y} dominant-baseline="central">
      {text}
    </text>
  );
  return (
    <g>
      {broken ? name(Y.truth, "target") : null}
      {name(Y.way, "accepted")}
      {broken ? name(Y.track, "track") : null}
      {name((Y.bars + Y.base) / 2 - 6, "weight of its")}
      {name((Y.bars + Y.base) / 2 + 7, "own symbol")}
    </g>
  );
}

function Ticks({
  scans,
  x,
  step,
}: {
  scans: number[];
  x: (index: number) => number;
  step: number;
}): JSX.Element {
  const every = Math.max(1, Math.ceil(34 / step));
  return (
    <g class="drawing-axis">
      {scans.map((scan, index) =>
        index % every ? null : (
          <text x={x(index)} y={Y.base + 16} text-anchor="middle">
            {scan}
          </text>
        ),
      )}
      <text x={LEFT} y={HEIGHT - 6}>
        scan
      </text>
    </g>
  );
}

const shown = (symbol: string, step: number): string => {
  const room = Math.max(Math.floor(step / 7), 1);
  return symbol.length > room ? `${symbol.slice(0, Math.max(room - 1, 1))}…` : symbol;
};

function Node({
  x,
  y,
  kind,
  isFinal,
  title,
}: {
  x: number;
  y: number;
  kind: string;
  isFinal?: boolean;
  title: string;
}): JSX.Element {
  return (
    <g class={`state-node state-node-${kind}`}>
      {isFinal ? <circle cx={x} cy={y} r={8} class="state-ring" /> : null}
      <circle cx={x} cy={y} r={5} />
      <title>{title}</title>
    </g>
  );
}

function titleOf(step: Step): string {
  const others = step.others.length ? `; it would also accept ${step.others.join(", ")}` : "";
  return `scan ${step.scan}: ${step.symbol}${others}`;
}

function Accepted({
  way,
  x,
  step,
}: {
  way: Way;
  x: (index: number) => number;
  step: number;
}): JSX.Element {
  const scans = scansOf(way);
  const accepted = way.steps.slice(0, way.break_ ?? way.steps.length);
  const place = (entry: Step) => x(scans.indexOf(entry.scan));
  const start = LEFT - step * 0.35;
  return (
    <g>
      <path
        class="way"
        d={`M${start} ${Y.way}${accepted.map((entry) => `H${place(entry)}`).join("")}`}
      />
      <path class="way-start" d={`M${start - 5} ${Y.way - 5}l6 5-6 5`} />
      {accepted.map((entry) => (
        <>
          {entry.others.length ? (
            <path
              class="way-other"
              d={`M${place(entry) - step} ${Y.way}q${step * 0.4} 0 ${step * 0.6} 20`}
            />
          ) : null}
          <Node
            x={place(entry)}
            y={Y.way}
            kind={entry.symbol === EPSILON ? "empty" : "accepted"}
            isFinal={entry.isFinal}
            title={titleOf(entry)}
          />
          {step >= LABELLED_STEP_PX ? (
            <text class="drawing-symbol" x={place(entry)} y={Y.way - 13} text-anchor="middle">
              {shown(entry.symbol, step)}
            </text>
          ) : null}
        </>
      ))}
    </g>
  );
}

interface BrokenProps {
  way: Way;
  scans: number[];
  x: (index: number) => number;
  step: number;
  verdict: TargetVerdict;
}

function Broken({ way, scans, x, step, verdict }: BrokenProps): JSX.Element {
  const first = way.break_ ?? 0;
  const rest = way.steps.slice(first);
  const at = x(scans.indexOf(way.steps[first]?.scan ?? 0));
  const before = first > 0 ? x(scans.indexOf(way.steps[first - 1]?.scan ?? 0)) : LEFT - step * 0.35;
  const line = (entries: { scan: number }[], y: number) => {
    const places = entries.map((entry) => x(scans.indexOf(entry.scan)));
    const moves = places.map((place, index) => (index ? `H${place}` : `L${place} ${y}`));
    return `M${before} ${Y.way}${moves.join("")}`;
  };
  const label = `Break at scan ${way.steps[first]?.scan}: show it in the plan view`;
  return (
    <g>
      <path class="drawing-break" d={`M${at} 12V${Y.base}`} />
      <path class="way way-truth" d={line(rest, Y.truth)} />
      {rest.map((entry) => (
        <SymbolMark
          x={x(scans.indexOf(entry.scan))}
          y={Y.truth}
          above
          entry={entry}
          step={step}
          kind="truth"
        />
      ))}
      {way.taken.length ? <path class="way way-track" d={line(way.taken, Y.track)} /> : null}
      {way.taken.map((entry) => (
        <SymbolMark
          x={x(scans.indexOf(entry.scan))}
          y={Y.track}
          entry={entry}
          step={step}
          kind="track"
        />
      ))}
      <Link
        href={placeOf(verdict, way.steps[first]?.time ?? 0)}
        label={label}
        class="lane-mark lane-break"
      >
        <rect x={at - 9} y={Y.way - 9} width={18} height={18} fill="transparent" stroke="none" />
        <path d={`m${at - 6} ${Y.way - 6} 12 12m0-12-12 12`} />
      </Link>
    </g>
  );
}

function SymbolMark({
  x,
  y,
  entry,
  step,
  kind,
  above,
}: {
  x: number;
  y: number;
  entry: { scan: number; symbol: string };
  step: number;
  kind: string;
  above?: boolean;
}): JSX.Element {
  return (
    <>
      <Node
        x={x}
        y={y}
        kind={entry.symbol === EPSILON ? "empty" : kind}
        title={`scan ${entry.scan}: ${entry.symbol}`}
      />
      {step >= LABELLED_STEP_PX ? (
        <text class="drawing-symbol" x={x} y={above ? y - 12 : y + 20} text-anchor="middle">
          {shown(entry.symbol, step)}
        </text>
      ) : null}
    </>
  );
}

function Weights({
  way,
  x,
  step,
}: {
  way: Way;
  x: (index: number) => number;
  step: number;
}): JSX.Element {
  const scans = scansOf(way);
  const width = Math.max(Math.min(step * 0.6, 14), 2);
  const end = x(scans.length - 1) + width;
  return (
    <g>
      <path class="drawing-grid" d={`M${LEFT} ${Y.bars}H${end}M${LEFT} ${Y.base}H${end}`} />
      <text
        class="drawing-symbol"
        x={LEFT - 4}
        y={Y.bars}
        text-anchor="end"
        dominant-baseline="central"
      >
        1
      </text>
      {way.steps.map((entry) =>
        entry.probability === null ? null : (
          <rect
            class="weight-bar"
            x={x(scans.indexOf(entry.scan)) - width / 2}
            y={Y.base - entry.probability * (Y.base - Y.bars)}
            width={width}
            height={entry.probability * (Y.base - Y.bars)}
          >
            <title>{`scan ${entry.scan}: ${probability(entry.probability)}`}</title>
          </rect>
        ),
      )}
    </g>
  );
}

function tableOf(way: Way, origin_s: number): TableData {
  const taken = new Map(way.taken.map((entry) => [entry.scan, entry.symbol]));
  const first = way.break_ ?? Infinity;
  const rowOf = (entry: Step, index: number): Cell[] => {
    const took = index < first ? entry.symbol : (taken.get(entry.scan) ?? null);
    const accepted = index < first ? "yes" : index === first ? "break" : "no";
    return [
      entry.scan,
      entry.time,
      entry.symbol,
      took,
      accepted,
      entry.probability,
      entry.others.join(" ") || null,
    ];
  };
  const columns = [
    "scan",
    "time_s",
    "expected",
    "took",
    "accepted",
    "weight of its own symbol",
    "also accepted",
  ];
  return { columns, rows: way.steps.map(rowOf), origin_s };
}

function pictureKey(palette: Palette): KeyMark[] {
  return [
    { name: "accepted", color: palette.track, look: "solid", symbol: "circle" },
    { name: "target after the break", color: palette.truth, look: "dashed", symbol: "circle" },
    { name: "track after the break", color: palette.selected, look: "solid", symbol: "circle" },
    { name: "ε, no detection", color: palette.muted, look: "dot", symbol: "emptyCircle" },
    { name: "final state", color: palette.track, look: "dot", symbol: "ring" },
    { name: "break", color: palette.bad, look: "dot", symbol: "cross" },
  ];
}
