// The centres of a clustering in the plane: from where each began to where it is at an iteration,
// among the detections.

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { TableData } from "../components/table";
import { number } from "../format";
import { type Palette, readPalette, theme } from "../state/theme";
import { GRID, MARGIN, textStyle, tipContent, tooltip, valueAxis } from "./axes";
import { bounds, fit } from "./camera";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame } from "./frame";
import { lookOf } from "./lines";
import type { KeyMark } from "./marks";

export type Place = [number, number];

export interface CentrePath {
  group: string;
  /** One for each iteration so far. */
  places: Place[];
}

interface Props {
  title: string;
  file: string;
  paths: CentrePath[];
  detections: { id: string; place: Place }[];
  xName: string;
  yName: string;
}

const LABELS_UP_TO = 20;

/** The widest of equal scales on both axes that shows every place. */
function view(
  chart: Chart,
  places: Place[],
): { xMin: number; xMax: number; yMin: number; yMax: number } {
  const [xs, ys] = [places.map(([x]) => x), places.map(([, y]) => y)];
  const size = {
    width: Math.max(chart.getWidth() - MARGIN.left - MARGIN.right, 1),
    height: Math.max(chart.getHeight() - MARGIN.top - MARGIN.bottom, 1),
  };
  return bounds(
    fit(
      {
        xMin: Math.min(...xs),
        xMax: Math.max(...xs),
        yMin: Math.min(...ys),
        yMax: Math.max(...ys),
      },
      size,
      1.12,
    ),
    size,
  );
}

function seriesOf({ paths, detections }: Props, palette: Palette): object[] {
  const still = { silent: true, animation: false };
  const ways = paths.map(({ group, places }, order) => ({
    ...still,
    type: "line",
    id: `way:${group}`,
    data: places,
    showSymbol: false,
    z: 3,
    lineStyle: { color: lookOf(order).color(palette), width: 1.6, type: lookOf(order).look },
  }));
  const marks = paths.flatMap(({ group, places }, order) => {
    const color = lookOf(order).color(palette);
    const [first, last] = [places[0], places.at(-1)];
    if (!first || !last) return [];
    const begin = {
      name: group,
      value: first,
      symbolSize: 7,
      itemStyle: { color: palette.surface, borderColor: color, borderWidth: 1.6 },
      label: { show: false },
    };
    return [
      begin,
      { name: group, value: last, symbolSize: 11, itemStyle: { color, borderColor: color } },
    ];
  });
  const label = {
    show: paths.length <= LABELS_UP_TO,
    formatter: "{b}",
    position: "right",
    color: palette.text,
    fontSize: 11,
  };
  return [
    {
      type: "scatter",
      id: "detections",
      data: detections.map(({ id, place }) => ({ name: id, value: place })),
      symbol: "rect",
      symbolSize: 5,
      itemStyle: { color: palette.muted },
      animation: false,
      z: 2,
    },
    ...ways,
    {
      type: "scatter",
      id: "centres",
      data: marks,
      symbol: "circle",
      label,
      animation: false,
      z: 4,
    },
  ];
}

interface TipItem {
  seriesId?: string;
  name?: string;
  value?: Place;
}

function draw(chart: Chart, props: Props): void {
  const palette = readPalette();
  const { xMin, xMax, yMin, yMax } = view(chart, [
    ...props.paths.flatMap((path) => path.places),
    ...props.detections.map((detection) => detection.place),
  ]);
  const label = {
    color: palette.muted,
    fontSize: 11,
    showMinLabel: false,
    showMaxLabel: false,
    hideOverlap: true,
    formatter: number,
  };
  const tip = ({ seriesId, name = "", value }: TipItem) =>
    tipContent(`${seriesId === "centres" ? "Centre" : "Detection"} ${name}`, [
      ["", value?.map(number).join(", ") ?? ""],
    ]);
  chart.setOption(
    {
      animation: false,
      grid: GRID,
      textStyle: textStyle(palette),
      tooltip: { trigger: "item", ...tooltip(palette), formatter: tip },
      xAxis: valueAxis(props.xName, palette, {
        min: xMin,
        max: xMax,
        nameGap: 26,
        splitNumber: 5,
        axisLabel: label,
      }),
      yAxis: valueAxis(props.yName, palette, {
        min: yMin,
        max: yMax,
        nameGap: 46,
        splitNumber: 5,
        axisLabel: label,
      }),
      series: seriesOf(props, palette),
    },
    { replaceMerge: ["series"] },
  );
}

export function CentrePaths(props: Props): JSX.Element {
  const chart = useRef<Chart | undefined>(undefined);
  const { title, file, paths, detections, xName, yName } = props;
  const table = (): TableData => ({
    columns: ["what", "id", "iteration", xName, yName],
    rows: [
      ...detections.map(({ id, place }) => ["detection", id, null, ...place]),
      ...paths.flatMap(({ group, places }) =>
        places.map((place, iteration) => ["centre", group, iteration, ...place]),
      ),
    ],
  });
  const key = (palette: Palette): KeyMark[] => [
    ...(detections.length
      ? [{ name: "detections", color: palette.muted, look: "dot", symbol: "rect" } as const]
      : []),
    ...paths.map(({ group }, order) => ({
      name: `centre ${group}`,
      color: lookOf(order).color(palette),
      look: lookOf(order).look,
    })),
  ];
  const note = (
    <p class="muted small frame-note">
      Hollow: where a centre began. Full: where it is now. Both axes have one scale.
    </p>
  );
  const sizes = `${paths.length} centres and ${detections.length} detections`;
  return (
    <ChartFrame
      title={title}
      file={file}
      table={table}
      chart={() => chart.current}
      pictureKey={key}
      tools={note}
    >
      <ChartCanvas
        label={`${title}: ${sizes}. The table shows the same.`}
        keys={[paths, detections, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, props);
        }}
        class="centres-canvas"
      />
    </ChartFrame>
  );
}
