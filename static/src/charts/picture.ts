// A chart as a PNG file that explains itself: its title and its key stand above the drawing.

import { saveBlob } from "../components/save";
import { readPalette, type Palette } from "../state/theme";
import { FONT } from "./axes";
import type { Chart } from "./echarts";

export interface KeyMark {
  name: string;
  color: string;
  look: "solid" | "dashed" | "dotted" | "dot";
}

const SCALE = 2;
const MARGIN = 14;
const TITLE_HEIGHT = 30;
const ROW_HEIGHT = 20;
const MARK_WIDTH = 22;

function drawMark(pen: CanvasRenderingContext2D, mark: KeyMark, x: number, y: number): void {
  pen.strokeStyle = pen.fillStyle = mark.color;
  if (mark.look === "dot") {
    pen.fillRect(x + MARK_WIDTH / 2 - 3, y - 3, 6, 6);
    return;
  }
  pen.lineWidth = 2;
  pen.setLineDash({ solid: [], dashed: [5, 3], dotted: [2, 3] }[mark.look]);
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x + MARK_WIDTH, y);
  pen.stroke();
}

/** Where each mark of the key stands, row by row within the width. */
function placed(pen: CanvasRenderingContext2D, key: KeyMark[], width: number): { mark: KeyMark; x: number; row: number }[] {
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

function compose(drawing: HTMLCanvasElement, title: string, key: KeyMark[], palette: Palette): HTMLCanvasElement {
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

export function savePng(chart: Chart, title: string, key: KeyMark[], name: string): void {
  const palette = readPalette();
  const drawing = chart.renderToCanvas({ pixelRatio: SCALE, backgroundColor: palette.surface });
  compose(drawing, title, key, palette).toBlob((blob) => {
    if (blob) saveBlob(blob, name);
  }, "image/png");
}
