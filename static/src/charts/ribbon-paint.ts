// The drawing of ribbons: for each track a band along time, a column a scan, divided as the
// probability of the track was; above it the events, below it the state of the track.

import { plural } from "../format";
import type { Palette } from "../state/theme";
import { otherTargets, type Part, partsOf, type Step, type Story } from "./association";
import { type Cause, concerns } from "./causes";
import type { KeyMark } from "./marks";
import type { Painting, Pen } from "./pen";
import { AXIS_PX, type Band, columnsOf, paintAxis, paintNow, periodOf } from "./time-band";

const EVENTS_PX = 15;
const STATUS_PX = 5;
const GAP_PX = 9;
/** Columns wider than this stand apart. */
const APART_PX = 7;

export interface Ribbon {
  story: Story;
  causes: Cause[];
  /** Beside its name. */
  note?: string;
}

/** A probability of existence at which tracks come or go. */
export interface Threshold {
  name: string;
  existence: number;
}

export interface RibbonsProps {
  ribbons: Ribbon[];
  band: Band;
  width: number;
  now: number;
  origin: number;
  thresholds: Threshold[];
  palette: Palette;
}

const heightOf = (count: number): number => (count > 4 ? 34 : count > 2 ? 44 : 56);
const rowHeight = (count: number): number => EVENTS_PX + heightOf(count) + STATUS_PX + GAP_PX;

/** The ribbon at a height of the drawing. */
export function ribbonAt(y: number, count: number): number {
  return Math.min(Math.max(Math.floor(y / rowHeight(count)), 0), count - 1);
}

/** Targets in the colours of their own, the same in all ribbons. */
export function targetColors(stories: Story[], palette: Palette): Map<string, string> {
  const [, green = "", pink = "", olive = ""] = palette.sensors;
  const cycle = [palette.track, green, pink, olive, palette.bad, palette.odd];
  const own = stories.flatMap(({ own }) => (own === null ? [] : [own]));
  const names = [...new Set([...own, ...otherTargets(stories)])];
  return new Map(names.map((name, at) => [name, cycle[at % cycle.length] ?? palette.track]));
}

export function partColor(part: Part, own: string | null, colors: Map<string, string>, p: Palette) {
  if (part.kind === "own") return colors.get(own ?? "") ?? p.track;
  if (part.kind === "target") return colors.get(part.truth ?? "") ?? p.odd;
  if (part.kind === "clutter") return p.sensors[0] ?? p.text;
  if (part.kind === "chosen") return p.track;
  return part.kind === "others" ? p.tentative : p.line;
}

const NAMED_TARGETS = 6;

export function ribbonKey(ribbons: Ribbon[], thresholds: Threshold[], palette: Palette): KeyMark[] {
  const stories = ribbons.map(({ story }) => story);
  const area = (name: string, color: string): KeyMark => ({ name, color, look: "area" });
  const marks: KeyMark[] = [];
  if (stories.some((story) => story.originsKnown)) {
    const colors = [...targetColors(stories, palette)];
    for (const [name, color] of colors.slice(0, NAMED_TARGETS))
      marks.push(area(`target ${name}`, color));
    const more = colors.length - NAMED_TARGETS;
    if (more > 0) marks.push(area(plural(more, "other target"), palette.odd));
    marks.push(area("clutter", palette.sensors[0] ?? palette.text));
  } else marks.push(area("chosen detection", palette.track), area("others", palette.tentative));
  marks.push(area("none (ε)", palette.line));
  if (stories.some(hasExistence)) {
    marks.push({ name: "existence", color: palette.text, look: "dotted" });
    for (const { name, existence } of thresholds)
      marks.push({ name: `${name} ${existence}`, color: palette.text, look: "dashed" });
  }
  return [...marks, ...signKey(ribbons, palette)];
}

export const hasExistence = (story: Story): boolean =>
  story.steps.some((step) => step.existence !== null);

interface Sign {
  name: string;
  symbol: string;
  color: string;
}

const SIGNS: Record<string, { name: string; symbol: string; color: keyof Palette }> = {
  break: { name: "break", symbol: "cross", color: "bad" },
  switch: { name: "switch", symbol: "down", color: "selected" },
  miss: { name: "target missed", symbol: "emptyCircle", color: "text" },
  false_alarm: { name: "false track", symbol: "emptyTriangle", color: "odd" },
  redundant: { name: "second track", symbol: "emptyDiamond", color: "muted" },
  divergence: { name: "divergence", symbol: "diamond", color: "bad" },
  confirmed: { name: "confirmed", symbol: "triangle", color: "good" },
  ended: { name: "end", symbol: "rect", color: "muted" },
};

function signOf(kind: string, palette: Palette): Sign | undefined {
  const sign = SIGNS[kind];
  return sign && { ...sign, color: String(palette[sign.color]) };
}

interface Tick {
  kind: string;
  time: number;
}

/** What happened to a track, or to its target while the track lived, and where its life turned. */
export function ticksOf({ story, causes }: Ribbon): Tick[] {
  const { steps } = story;
  const found = causes
    .filter((cause) => concerns(cause, story.track, story.own))
    .map(({ event, from }) => ({ kind: event, time: from }));
  const confirmed = steps.findIndex((step) => step.status === "confirmed");
  if (confirmed > 0) found.push({ kind: "confirmed", time: steps[confirmed]?.time ?? 0 });
  const end = steps.at(-1);
  if (end) found.push({ kind: "ended", time: end.time });
  return found;
}

function signKey(ribbons: Ribbon[], palette: Palette): KeyMark[] {
  const kinds = new Set(ribbons.flatMap((ribbon) => ticksOf(ribbon).map(({ kind }) => kind)));
  return Object.keys(SIGNS).flatMap((kind) => {
    const sign = kinds.has(kind) ? signOf(kind, palette) : undefined;
    return sign
      ? [{ name: sign.name, color: sign.color, look: "dot" as const, symbol: sign.symbol }]
      : [];
  });
}

const SHAPES: Record<string, string> = {
  cross: "M-4 -4L4 4M4 -4L-4 4",
  down: "M-4 -4H4L0 4Z",
  emptyCircle: "M-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0Z",
  triangle: "M0 -4L4 4H-4Z",
  emptyTriangle: "M0 -4L4 4H-4Z",
  diamond: "M0 -4L4 0L0 4L-4 0Z",
  emptyDiamond: "M0 -4L4 0L0 4L-4 0Z",
  rect: "M-1 -4H1V4H-1Z",
};

function paintSigns(pen: Pen, ribbon: Ribbon, y: number, { band, palette }: RibbonsProps): void {
  for (const { kind, time } of ticksOf(ribbon)) {
    const sign = signOf(kind, palette);
    if (!sign || time < band.from || time > band.to) continue;
    const isOpen = sign.symbol.startsWith("empty") || sign.symbol === "cross";
    const look = isOpen ? { stroke: sign.color } : { fill: sign.color };
    pen.shape(SHAPES[sign.symbol] ?? "", band.x(time), y, look);
  }
}

function statusColor(status: string, palette: Palette): string {
  if (status === "confirmed") return palette.good;
  return status === "tentative" ? palette.tentative : palette.strongLine;
}

interface Column {
  step: Step;
  x: number;
  width: number;
}

function shownColumns({ story }: Ribbon, band: Band): Column[] {
  const times = story.steps.map((step) => step.time);
  const edges = columnsOf(times, periodOf(times));
  return story.steps.flatMap((step, at) => {
    const [from, to] = edges[at] ?? [0, 0];
    if (to < band.from || from > band.to) return [];
    const [x, end] = [Math.max(band.x(from), band.left), Math.min(band.x(to), band.right)];
    return [{ step, x, width: end - x }];
  });
}

function paintColumns(pen: Pen, ribbon: Ribbon, top: number, height: number, props: RibbonsProps) {
  const { palette, ribbons } = props;
  const { story } = ribbon;
  const colors = targetColors(
    ribbons.map((each) => each.story),
    palette,
  );
  for (const { step, x, width } of shownColumns(ribbon, props.band)) {
    const apart = width > APART_PX ? 1 : 0;
    let y = top + height;
    for (const part of partsOf(story, step)) {
      const part_px = Math.min(part.share, 1) * height;
      y -= part_px;
      if (part_px > 0)
        pen.rect(x, y, width - apart, part_px, partColor(part, story.own, colors, palette));
    }
    const color = statusColor(step.status, palette);
    pen.rect(x, top + height + 1.5, width - apart, STATUS_PX - 2, color);
  }
}

function paintExistence(
  pen: Pen,
  ribbon: Ribbon,
  top: number,
  height: number,
  props: RibbonsProps,
) {
  const { story } = ribbon;
  if (!hasExistence(story)) return;
  const { band, palette, thresholds } = props;
  const y = (value: number) => top + (1 - value) * height;
  for (const { existence } of thresholds)
    pen.line(
      [
        [band.left, y(existence)],
        [band.right, y(existence)],
      ],
      { color: palette.text, dashes: [6, 4], opacity: 0.7 },
    );
  const points = story.steps.flatMap((step): [number, number][] =>
    step.existence === null ? [] : [[band.x(step.time), y(step.existence)]],
  );
  pen.line(points, { color: palette.surface, width: 3.5, opacity: 0.7 });
  pen.line(points, { color: palette.text, width: 1.6, dashes: [2, 2.5] });
}

function shortened(text: string, room: number): string {
  const most = Math.max(Math.floor(room / 6.3), 4);
  return text.length > most ? `${text.slice(0, most - 1)}…` : text;
}

function paintName(
  pen: Pen,
  { story, note }: Ribbon,
  top: number,
  height: number,
  props: RibbonsProps,
) {
  const { band, palette } = props;
  const room = band.left - 26;
  const middle = top + height / 2;
  const isNarrow = room < 60;
  const own = story.own === null ? (note ?? "") : `${isNarrow ? "" : "of target "}${story.own}`;
  const name = isNarrow ? story.track : `track ${story.track}`;
  const lines = [name, own, story.own === null ? "" : (note ?? "")].filter(Boolean);
  lines.forEach((line, at) => {
    const y = middle + (at - (lines.length - 1) / 2) * 13;
    const look = { color: at ? palette.muted : palette.text, weight: at ? 400 : 600 };
    pen.text(shortened(line, room), 8, y, look);
  });
  for (const [value, y] of [
    ["1", top + 5],
    ["0", top + height - 4],
  ] as [string, number][])
    pen.text(value, band.left - 5, y, { color: palette.muted, size: 10, anchor: "end" });
}

function paintRibbon(pen: Pen, ribbon: Ribbon, top: number, height: number, props: RibbonsProps) {
  const { band, palette } = props;
  const strip = top + EVENTS_PX;
  paintName(pen, ribbon, strip, height, props);
  const width = band.right - band.left;
  for (const y of [strip - 0.5, strip + height + 0.5])
    pen.line(
      [
        [band.left, y],
        [band.right, y],
      ],
      { color: palette.line },
    );
  pen.within([band.left, top, width, EVENTS_PX + height + STATUS_PX], () => {
    paintColumns(pen, ribbon, strip, height, props);
    paintExistence(pen, ribbon, strip, height, props);
  });
  paintSigns(pen, ribbon, top + EVENTS_PX / 2, props);
}

export function ribbonPainting(props: RibbonsProps): Painting {
  const { ribbons, width, band, palette, origin, now } = props;
  const row = rowHeight(ribbons.length);
  const bottom = row * ribbons.length;
  return {
    width,
    height: bottom + AXIS_PX,
    paint: (pen) => {
      ribbons.forEach((ribbon, at) => {
        paintRibbon(pen, ribbon, at * row, heightOf(ribbons.length), props);
      });
      paintAxis(pen, band, bottom - GAP_PX / 2, origin, palette);
      paintNow(pen, band, now, [2, bottom - GAP_PX / 2], palette.selected);
    },
  };
}
