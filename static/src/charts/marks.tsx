// The marks of the charts, drawn alike on the page's keys and in the keys of saved pictures.

import type { JSX } from "preact";
import { type Palette, readPalette, theme } from "../state/theme";

export interface KeyMark {
  name: string;
  color: string;
  /** The line; "dot" has none, and "area" is a broad one. */
  look: "solid" | "dashed" | "dotted" | "area" | "dot";
  /** On the line, or alone; `empty…` is hollow. A dot without one is a circle. */
  symbol?: string | undefined;
}

export const MARK_WIDTH = 22;
const RADIUS = 3.5;
const OPEN = ["cross", "ring"];

const circle = (r: number): string =>
  `M${-r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;

/** Shapes around the origin, of a radius of `r`. */
const SHAPES: Record<string, (r: number) => string> = {
  circle,
  rect: (r) => `M${-r} ${-r}h${2 * r}v${2 * r}h${-2 * r}Z`,
  triangle: (r) => `M0 ${-r}L${r} ${r}H${-r}Z`,
  down: (r) => `M0 ${r}L${r} ${-r}H${-r}Z`,
  diamond: (r) => `M0 ${-r}L${r} 0L0 ${r}L${-r} 0Z`,
  pin: (r) =>
    [
      `M0 ${1.5 * r}C${-0.6 * r} ${0.6 * r} ${-r} ${0.3 * r} ${-r} ${-0.3 * r}`,
      `a${r} ${r} 0 0 1 ${2 * r} 0C${r} ${0.3 * r} ${0.6 * r} ${0.6 * r} 0 ${1.5 * r}Z`,
    ].join(""),
  ring: (r) => `${circle(r)}${circle(0.4 * r)}`,
  cross: (r) => `M${-r} ${-r}L${r} ${r}M${r} ${-r}L${-r} ${r}`,
};

const DASHES: Record<KeyMark["look"], number[]> = {
  solid: [],
  dashed: [5, 3],
  dotted: [2, 3],
  area: [],
  dot: [],
};

export const isHollow = (symbol: string): boolean => symbol.startsWith("empty");

/** `emptyCircle` is a `circle`. */
export function shapeOf(symbol: string): string {
  const bare = symbol.replace(/^empty/, "").toLowerCase();
  return bare in SHAPES ? bare : "circle";
}

/**
 * A symbol of the chart library; hollow ones have the colour `inside`, else they show what is under
 * them.
 */
export function symbolLook(
  symbol: string,
  color: string,
  inside = "transparent",
): { symbol: string; itemStyle: object } {
  const itemStyle = isHollow(symbol)
    ? { color: inside, borderColor: color, borderWidth: 1.5 }
    : { color };
  return { symbol: shapeOf(symbol), itemStyle };
}

interface Parts {
  line?: { width: number; opacity: number; dashes: number[] };
  symbol?: { path: string; fill: boolean; stroke: boolean };
}

function partsOf({ look, symbol }: KeyMark): Parts {
  const wide = look === "area";
  const line =
    look === "dot"
      ? {}
      : { line: { width: wide ? 8 : 2, opacity: wide ? 0.6 : 1, dashes: DASHES[look] } };
  const name = symbol ?? (look === "dot" ? "circle" : undefined);
  if (!name) return line;
  const shape = shapeOf(name);
  const stroke = isHollow(name) || OPEN.includes(shape);
  return { ...line, symbol: { path: SHAPES[shape]?.(RADIUS) ?? "", fill: !stroke, stroke } };
}

/** As a piece of SVG whose line begins at (x, y). */
export function markSvg(mark: KeyMark, x: number, y: number): string {
  const { line, symbol } = partsOf(mark);
  const pieces: string[] = [];
  if (line) {
    const dashes = line.dashes.length ? ` stroke-dasharray="${line.dashes.join(" ")}"` : "";
    const look = `stroke-width="${line.width}" opacity="${line.opacity}"${dashes}`;
    pieces.push(`<path d="M0 0h${MARK_WIDTH}" fill="none" stroke="${mark.color}" ${look}/>`);
  }
  if (symbol) {
    const [fill, stroke] = [
      symbol.fill ? mark.color : "none",
      symbol.stroke ? ` stroke="${mark.color}" stroke-width="1.5"` : "",
    ];
    const place = `transform="translate(${MARK_WIDTH / 2} 0)"`;
    pieces.push(`<path ${place} d="${symbol.path}" fill="${fill}"${stroke}/>`);
  }
  return `<g transform="translate(${x} ${y})">${pieces.join("")}</g>`;
}

/** On a canvas, its line beginning at (x, y). */
export function drawMark(pen: CanvasRenderingContext2D, mark: KeyMark, x: number, y: number): void {
  const { line, symbol } = partsOf(mark);
  pen.save();
  pen.translate(x, y);
  pen.strokeStyle = pen.fillStyle = mark.color;
  if (line) {
    pen.lineWidth = line.width;
    pen.globalAlpha = line.opacity;
    pen.setLineDash(line.dashes);
    pen.stroke(new Path2D(`M0 0h${MARK_WIDTH}`));
  }
  if (symbol) {
    pen.translate(MARK_WIDTH / 2, 0);
    pen.globalAlpha = 1;
    pen.lineWidth = 1.5;
    pen.setLineDash([]);
    if (symbol.fill) pen.fill(new Path2D(symbol.path));
    if (symbol.stroke) pen.stroke(new Path2D(symbol.path));
  }
  pen.restore();
}

/** As shapes of an SVG drawing, its line beginning at the origin. */
export function MarkShapes({ mark }: { mark: KeyMark }): JSX.Element {
  const { line, symbol } = partsOf(mark);
  const { color } = mark;
  return (
    <>
      {line ? (
        <path
          d={`M0 0h${MARK_WIDTH}`}
          stroke={color}
          stroke-width={line.width}
          stroke-dasharray={line.dashes.join(" ") || "none"}
          opacity={line.opacity}
        />
      ) : null}
      {symbol ? (
        <path
          transform={`translate(${MARK_WIDTH / 2} 0)`}
          d={symbol.path}
          fill={symbol.fill ? color : "none"}
          stroke={symbol.stroke ? color : "none"}
          stroke-width={1.5}
        />
      ) : null}
    </>
  );
}

function Mark({ mark }: { mark: KeyMark }): JSX.Element {
  return (
    <svg class="mark" viewBox={`0 -7 ${MARK_WIDTH} 14`} aria-hidden="true">
      <MarkShapes mark={mark} />
    </svg>
  );
}

/**
 * What the lines and symbols of a chart mean, beside it: the same marks as in its saved picture.
 */
export function Key({ marks }: { marks: (palette: Palette) => KeyMark[] }): JSX.Element {
  void theme.value;
  return (
    <ul class="legend legend-note" aria-label="Key">
      {marks(readPalette()).map((mark) => (
        <li class="curve-key">
          <Mark mark={mark} />
          {mark.name}
        </li>
      ))}
    </ul>
  );
}
