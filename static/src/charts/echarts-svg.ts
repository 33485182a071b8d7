// A chart as SVG; the renderer for it is loaded when such a file is asked for.

import { init, use } from "echarts/core";
import { SVGRenderer } from "echarts/renderers";
import type { Chart } from "./echarts";

use([SVGRenderer]);

export function drawSvg(chart: Chart, width: number, height: number): string {
  const twin = init(null, null, { renderer: "svg", ssr: true, width, height });
  twin.setOption({ ...chart.getOption(), animation: false });
  const text = twin.renderToSVGString();
  twin.dispose();
  return text;
}
