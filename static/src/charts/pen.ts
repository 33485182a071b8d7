// One way of drawing for the screen and for files: on a canvas, or as the text of an SVG.

import { FONT } from "./axes";

export type Anchor = "start" | "middle" | "end";

export interface TextLook {
  color: string;
  size?: number;
  anchor?: Anchor;
  weight?: number;
}

export interface StrokeLook {
  color: string;
  width?: number;
  dashes?: number[];
  opacity?: number;
}

export interface Pen {
  rect(x: number, y: number, width: number, height: number, color: string): void;
  /** Through points, one after the other. */
  line(points: [number, number][], look: StrokeLook): void;
  circle(x: number, y: number, radius: number, color: string, hollow?: boolean): void;
  /** A path of SVG moved to (x, y). */
  shape(path: string, x: number, y: number, look: { fill?: string; stroke?: string }): void;
  /** On its middle line. */
  text(text: string, x: number, y: number, look: TextLook): void;
  /** Stretched without smoothing. */
  image(image: HTMLCanvasElement, x: number, y: number, width: number, height: number): void;
  /** What `draw` draws is kept within a box. */
  within(box: [number, number, number, number], draw: () => void): void;
}

/** A drawing of our own: drawn anew wherever it is wanted. */
export interface Painting {
  width: number;
  height: number;
  paint(pen: Pen): void;
}

export const isPainting = (source: object): source is Painting => "paint" in source;

class CanvasPen implements Pen {
  constructor(private readonly on: CanvasRenderingContext2D) {}

  rect(x: number, y: number, width: number, height: number, color: string): void {
    this.on.fillStyle = color;
    this.on.fillRect(x, y, width, height);
  }

  line(points: [number, number][], { color, width = 1, dashes = [], opacity = 1 }: StrokeLook) {
    const { on } = this;
    on.strokeStyle = color;
    on.lineWidth = width;
    on.globalAlpha = opacity;
    on.lineJoin = "round";
    on.setLineDash(dashes);
    on.beginPath();
    for (const [x, y] of points) on.lineTo(x, y);
    on.stroke();
    on.setLineDash([]);
    on.globalAlpha = 1;
  }

  circle(x: number, y: number, radius: number, color: string, hollow = false): void {
    const { on } = this;
    on.beginPath();
    on.arc(x, y, radius, 0, 2 * Math.PI);
    [on.fillStyle, on.strokeStyle, on.lineWidth] = [color, color, 1.5];
    if (hollow) on.stroke();
    else on.fill();
  }

  shape(path: string, x: number, y: number, { fill, stroke }: { fill?: string; stroke?: string }) {
    const { on } = this;
    on.save();
    on.translate(x, y);
    const outline = new Path2D(path);
    if (fill) {
      on.fillStyle = fill;
      on.fill(outline);
    }
    if (stroke) {
      on.strokeStyle = stroke;
      on.lineWidth = 1.5;
      on.stroke(outline);
    }
    on.restore();
  }

  text(text: string, x: number, y: number, look: TextLook): void {
    const { on } = this;
    on.font = `${look.weight ?? 400} ${look.size ?? 11}px ${FONT}`;
    on.textBaseline = "middle";
    on.textAlign = look.anchor === "middle" ? "center" : (look.anchor ?? "start");
    on.fillStyle = look.color;
    on.fillText(text, x, y);
  }

  image(image: HTMLCanvasElement, x: number, y: number, width: number, height: number): void {
    this.on.imageSmoothingEnabled = false;
    this.on.drawImage(image, x, y, width, height);
  }

  within([x, y, width, height]: [number, number, number, number], draw: () => void): void {
    const { on } = this;
    on.save();
    on.beginPath();
    on.rect(x, y, width, height);
    on.clip();
    draw();
    on.restore();
  }
}

const escaped = (text: string) =>
  text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");
const short = (value: number) => String(Number(value.toFixed(2)));

class SvgPen implements Pen {
  readonly pieces: string[] = [];
  private boxes = 0;

  rect(x: number, y: number, width: number, height: number, color: string): void {
    const box = `x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}"`;
    this.pieces.push(`<rect ${box} fill="${color}"/>`);
  }

  line(points: [number, number][], { color, width = 1, dashes = [], opacity = 1 }: StrokeLook) {
    const d = points.map(([x, y], at) => `${at ? "L" : "M"}${short(x)} ${short(y)}`).join("");
    const dashed = dashes.length ? ` stroke-dasharray="${dashes.join(" ")}"` : "";
    const faint = opacity < 1 ? ` opacity="${opacity}"` : "";
    const look = `fill="none" stroke="${color}" stroke-width="${width}"${dashed}${faint}`;
    this.pieces.push(`<path d="${d}" ${look}/>`);
  }

  circle(x: number, y: number, radius: number, color: string, hollow = false): void {
    const look = hollow ? `fill="none" stroke="${color}" stroke-width="1.5"` : `fill="${color}"`;
    this.pieces.push(`<circle cx="${short(x)}" cy="${short(y)}" r="${radius}" ${look}/>`);
  }

  shape(path: string, x: number, y: number, { fill, stroke }: { fill?: string; stroke?: string }) {
    const edge = stroke ? ` stroke="${stroke}" stroke-width="1.5"` : "";
    const place = `transform="translate(${short(x)} ${short(y)})"`;
    this.pieces.push(`<path ${place} d="${path}" fill="${fill ?? "none"}"${edge}/>`);
  }

  text(text: string, x: number, y: number, look: TextLook): void {
    const font = `font-size="${look.size ?? 11}" font-weight="${look.weight ?? 400}"`;
    const place = `x="${short(x)}" y="${short(y)}" text-anchor="${look.anchor ?? "start"}"`;
    const middle = 'dominant-baseline="middle"';
    this.pieces.push(
      `<text ${place} ${font} fill="${look.color}" ${middle}>${escaped(text)}</text>`,
    );
  }

  image(image: HTMLCanvasElement, x: number, y: number, width: number, height: number): void {
    const box = `x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}"`;
    const look = 'preserveAspectRatio="none" style="image-rendering:pixelated"';
    this.pieces.push(`<image ${box} ${look} href="${image.toDataURL("image/png")}"/>`);
  }

  within([x, y, width, height]: [number, number, number, number], draw: () => void): void {
    const id = `box-${this.boxes++}`;
    const box = `x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}"`;
    this.pieces.push(`<clipPath id="${id}"><rect ${box}/></clipPath><g clip-path="url(#${id})">`);
    draw();
    this.pieces.push("</g>");
  }
}

/** As a canvas of so many pixels for one of the page. */
export function toCanvas(painting: Painting, scale: number, canvas?: HTMLCanvasElement) {
  const sheet = canvas ?? document.createElement("canvas");
  const [width, height] = [painting.width * scale, painting.height * scale].map(Math.round);
  if (sheet.width !== width) sheet.width = width ?? 0;
  if (sheet.height !== height) sheet.height = height ?? 0;
  const on = sheet.getContext("2d");
  if (!on) return sheet;
  on.setTransform(scale, 0, 0, scale, 0, 0);
  on.clearRect(0, 0, painting.width, painting.height);
  painting.paint(new CanvasPen(on));
  return sheet;
}

/** As shapes of an SVG. */
export function toSvg(painting: Painting): string {
  const pen = new SvgPen();
  painting.paint(pen);
  const size = `width="${painting.width}" height="${painting.height}"`;
  const box = `viewBox="0 0 ${painting.width} ${painting.height}"`;
  const body = pen.pieces.join("\n");
  return `<svg xmlns="http://www.w3.org/2000/svg" ${size} ${box}>\n${body}\n</svg>`;
}
