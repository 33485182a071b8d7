// A chart as a PNG or SVG file that explains itself: its title and its key stand above the drawing.

import { saveBlob } from "../components/save";
import { type Palette, readPalette } from "../state/theme";
import { FONT } from "./axes";
import type { Chart } from "./echarts";
import { drawMark, type KeyMark, MARK_WIDTH, markSvg } from "./marks";
import { isPainting, type Painting, toCanvas, toSvg } from "./pen";

const SCALE = 2;
const MARGIN = 14;
const TITLE_HEIGHT = 30;
const ROW_HEIGHT = 20;

/** Where each mark of the key stands, row by row within the width. */
function placed(
  pen: CanvasRenderingContext2D,
  key: KeyMark[],
  width: number,
): { mark: KeyMark; x: number; row: number }[] {
  let x = MARGIN;
  let row = 0;
  return key.map((mark) => {
    const wide = MARK_WIDTH + 6 + pen.measureText(mark.name).width + 18;
    if (x > MARGIN && x + wide > width - MARGIN) [x, row] = [MARGIN, row + 1];
    const place = { mark, x, row };
    x += wide;
    return place;
  });
}

function compose(
  drawing: HTMLCanvasElement,
  title: string,
  key: KeyMark[],
  palette: Palette,
): HTMLCanvasElement {
  const sheet = document.createElement("canvas");
  const pen = sheet.getContext("2d");
  if (!pen) return drawing;
  const width = drawing.width / SCALE;
  pen.font = `12px ${FONT}`;
  const places = placed(pen, key, width);
  const head = TITLE_HEIGHT + ((places.at(-1)?.row ?? -1) + 1) * ROW_HEIGHT;
  sheet.width = drawing.width;
  sheet.height = drawing.height + head * SCALE;
  pen.scale(SCALE, SCALE);
  pen.fillStyle = palette.surface;
  pen.fillRect(0, 0, width, sheet.height / SCALE);
  pen.textBaseline = "middle";
  pen.fillStyle = palette.text;
  pen.font = `600 14px ${FONT}`;
  pen.fillText(title, MARGIN, TITLE_HEIGHT / 2 + 2);
  pen.font = `12px ${FONT}`;
  for (const { mark, x, row } of places) {
    const y = TITLE_HEIGHT + row * ROW_HEIGHT + ROW_HEIGHT / 2;
    drawMark(pen, mark, x, y);
    pen.fillStyle = palette.text;
    pen.fillText(mark.name, x + MARK_WIDTH + 6, y);
  }
  pen.drawImage(drawing, 0, head, width, drawing.height / SCALE);
  return sheet;
}

/** What a saved picture is made from: a chart of the library, or a drawing of our own. */
export type Source = Chart | SVGSVGElement | Painting;

const INLINED = [
  ...["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "fill-opacity"],
  ...["font-size", "font-family", "font-weight", "text-anchor", "dominant-baseline"],
];

/**
 * A drawing with the looks that the style sheet gives it written into it, so that it stands alone.
 */
function standalone(drawing: SVGSVGElement): { text: string; width: number; height: number } {
  const { width, height } = drawing.getBoundingClientRect();
  const copy = drawing.cloneNode(true) as SVGSVGElement;
  const [from, to] = [drawing, copy].map((root) => [
    root,
    ...root.querySelectorAll<SVGElement>("*"),
  ]) as [SVGElement[], SVGElement[]];
  from.forEach((element, index) => {
    const style = getComputedStyle(element);
    to[index]?.setAttribute(
      "style",
      INLINED.map((name) => `${name}:${style.getPropertyValue(name)}`).join(";"),
    );
  });
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", String(width));
  copy.setAttribute("height", String(height));
  return { text: new XMLSerializer().serializeToString(copy), width, height };
}

async function asSvg(source: Source): Promise<{ text: string; width: number; height: number }> {
  if (source instanceof SVGSVGElement) return standalone(source);
  if (isPainting(source)) return { ...source, text: toSvg(source) };
  const { drawSvg } = await import("./twin");
  return { text: drawSvg(source), width: source.getWidth(), height: source.getHeight() };
}

async function asCanvas(source: Source): Promise<HTMLCanvasElement> {
  if (isPainting(source)) return toCanvas(source, SCALE);
  if (!(source instanceof SVGSVGElement)) return (await import("./twin")).drawCanvas(source, SCALE);
  const { text, width, height } = standalone(source);
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width * SCALE, height * SCALE];
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas;
}

export async function savePng(
  source: Source,
  title: string,
  key: KeyMark[],
  name: string,
): Promise<void> {
  const palette = readPalette();
  compose(await asCanvas(source), title, key, palette).toBlob((blob) => {
    if (blob) saveBlob(blob, name);
  }, "image/png");
}

const escaped = (text: string) =>
  text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");

/** Names may hold signs that XML has no place for. */
const NOT_XML = /[^\t\n\r\x20-\ufffd\u{10000}-\u{10ffff}]/gu;

function textSvg(text: string, x: number, y: number, style: string): string {
  return `<text x="${x}" y="${y}" ${style} dominant-baseline="middle">${escaped(text)}</text>`;
}

export async function saveSvg(
  source: Source,
  title: string,
  key: KeyMark[],
  name: string,
): Promise<void> {
  const palette = readPalette();
  const { text, width, height } = await asSvg(source);
  const pen = document.createElement("canvas").getContext("2d");
  if (pen) pen.font = `12px ${FONT}`;
  const places = pen ? placed(pen, key, width) : [];
  const head = TITLE_HEIGHT + ((places.at(-1)?.row ?? -1) + 1) * ROW_HEIGHT;
  const marks = places.map(({ mark, x, row }) => {
    const y = TITLE_HEIGHT + row * ROW_HEIGHT + ROW_HEIGHT / 2;
    return markSvg(mark, x, y) + textSvg(mark.name, x + MARK_WIDTH + 6, y, 'font-size="12"');
  });
  const box = `width="${width}" height="${height + head}" viewBox="0 0 ${width} ${height + head}"`;
  const look = `font-family="${escaped(FONT)}" fill="${palette.text}"`;
  const sheet = [
    `<svg xmlns="http://www.w3.org/2000/svg" ${box} ${look}>`,
    `<title>${escaped(title)}</title><rect width="100%" height="100%" fill="${palette.surface}"/>`,
    textSvg(title, MARGIN, TITLE_HEIGHT / 2 + 2, 'font-size="14" font-weight="600"'),
    ...marks,
    `<g transform="translate(0 ${head})">${text}</g></svg>`,
  ];
  saveBlob(
    new Blob([sheet.join("\n").replace(NOT_XML, "\ufffd")], { type: "image/svg+xml" }),
    name,
  );
}
