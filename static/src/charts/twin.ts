// A chart drawn once more for a file. A twin of its own, since what the screen's chart drew as one
// shape is not drawn again by it, and since a file has no use for a slider.

import { init, use } from "echarts/core";
import { SVGRenderer } from "echarts/renderers";
import { MARGIN } from "./axes";
import type { Chart } from "./echarts";

use([SVGRenderer]);

interface Zoom {
  type?: string;
}

/** What the chart shows now, without what only hands use. */
function still(chart: Chart): Record<string, unknown> {
  const option = chart.getOption() as { dataZoom?: Zoom[]; grid?: object[] };
  const zooms = option.dataZoom ?? [];
  const kept = zooms.filter((zoom) => zoom.type !== "slider");
  const grid =
    kept.length < zooms.length
      ? (option.grid ?? []).map((each) => ({ ...each, bottom: MARGIN.bottom }))
      : option.grid;
  return { ...option, dataZoom: kept, grid, animation: false };
}

export function drawSvg(chart: Chart): string {
  const twin = init(null, null, {
    renderer: "svg",
    ssr: true,
    width: chart.getWidth(),
    height: chart.getHeight(),
  });
  twin.setOption(still(chart));
  const text = twin.renderToSVGString();
  twin.dispose();
  return text;
}

export function drawCanvas(chart: Chart, scale: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  const size = { width: chart.getWidth(), height: chart.getHeight() };
  const twin = init(canvas, null, { renderer: "canvas", devicePixelRatio: scale, ...size });
  twin.setOption(still(chart));
  twin.getZr().flush();
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [size.width * scale, size.height * scale];
  copy.getContext("2d")?.drawImage(canvas, 0, 0, copy.width, copy.height);
  twin.dispose();
  return copy;
}
