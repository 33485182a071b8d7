// The bearing-time picture: time runs down, bearings across, as operators read it; detections with
// truth and tracks over them.

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { BearingTime } from "../api/types";
import type { TableData } from "../components/table";
import { number, plural } from "../format";
import type { Clock } from "../state/clock";
import { type Palette, readPalette, theme } from "../state/theme";
import { param, setParams } from "../state/url";
import { timeAxisName, timeText } from "../times";
import {
  axisLabel,
  GRID,
  lowerLabel,
  ruleAt,
  textStyle,
  tipContent,
  tooltip,
  valueAxis,
} from "./axes";
import { type BearingLine, type BearingScene, unwrapped } from "./bearing-scene";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame, reducedBadge } from "./frame";
import { type Levels, shades } from "./levels";
import type { KeyMark } from "./marks";
import { momentOf } from "./plan-drawing";

const REACH_PX = 14;
const LARGE = 2000;

interface Props {
  jobId: string;
  series: BearingTime;
  scene: BearingScene;
  clock: Clock;
  /** The record behind them, where it is not too large. */
  levels: Levels | undefined;
}

/** The record as shades under everything else, moved and cut with the axes. */
function levelSeries({ levels, clock }: Props, moment: Moment, palette: Palette): object[] {
  if (!levels || moment.hidden.has("levels")) return [];
  const image = shades(levels, palette.text);
  const { origin } = clock;
  const renderItem = (_: unknown, api: { coord: (at: [number, number]) => [number, number] }) => {
    const [left, top] = api.coord([levels.fromBearing, levels.fromTime - origin]);
    const [right, bottom] = api.coord([levels.toBearing, levels.toTime - origin]);
    return {
      type: "image",
      style: { image, x: left, y: top, width: right - left, height: bottom - top },
    };
  };
  return [
    {
      type: "custom",
      id: "levels",
      data: [[0, 0]],
      renderItem,
      silent: true,
      clip: true,
      animation: false,
      z: 1,
    },
  ];
}

type Moment = ReturnType<typeof momentOf>;

function lines(all: Iterable<BearingLine>, moment: Moment, origin: number): [number, number][] {
  return [...all].flatMap((line) => unwrapped(line, moment.from, moment.now, origin));
}

/** Detections as the chart draws them; of very many small squares, as one shape. */
function dotLook(count: number): { symbol: string; symbolSize: number; large: boolean } {
  const large = count > LARGE;
  return { symbol: large ? "rect" : "circle", symbolSize: large ? 2.5 : 3.5, large };
}

function isWithin(time: number, { from, now }: Moment): boolean {
  return time >= from - 1e-9 && time <= now + 1e-9;
}

function seriesOf(props: Props, moment: Moment, palette: Palette): object[] {
  const { scene, clock } = props;
  const { origin } = clock;
  const line = (
    id: string,
    all: Iterable<BearingLine>,
    color: string,
    width: number,
    z: number,
  ) => {
    const data = lines(all, moment, origin);
    return {
      type: "line",
      id,
      data,
      showSymbol: false,
      silent: true,
      animation: false,
      z,
      lineStyle: { color, width },
    };
  };
  const shown = (layer: string) => !moment.hidden.has(layer);
  const dots = scene.detections.flatMap(({ time, bearing }, row) =>
    isWithin(time, moment) ? [[bearing, time - origin, row]] : [],
  );
  const color = palette.sensors[0] ?? palette.text;
  const still = {
    itemStyle: { color, opacity: 0.75 },
    animation: false,
    progressive: 0,
    largeThreshold: LARGE,
    z: 2,
  };
  const cursor = ruleAt(
    { yAxis: moment.now - origin },
    { color: palette.selected, width: 1.2, type: "dashed" },
  );
  const [truth, track] = [
    scene.truths.get(moment.truth ?? ""),
    scene.tracks.get(moment.track ?? ""),
  ];
  return [
    ...levelSeries(props, moment, palette),
    {
      type: "scatter",
      id: "detections",
      data: shown("d") ? dots : [],
      ...dotLook(dots.length),
      ...still,
      markLine: cursor,
    },
    line("truth", shown("truth") ? scene.truths.values() : [], palette.truth, 1.4, 3),
    line("tracks", shown("tracks") ? scene.tracks.values() : [], palette.track, 1.8, 4),
    line("chosen-truth", truth ? [truth] : [], palette.truth, 3, 5),
    line("chosen-track", track ? [track] : [], palette.selected, 3, 6),
  ];
}

function draw(chart: Chart, props: Props, moment: Moment): void {
  const palette = readPalette();
  const { clock, scene } = props;
  const { origin } = clock;
  const range = { min: (clock.times[0] ?? 0) - origin, max: (clock.times.at(-1) ?? 1) - origin };
  const degrees = { min: 0, max: 360, interval: 45, nameGap: 26, axisLabel: lowerLabel(palette) };
  const tip = (item: { seriesId?: string; data?: unknown }) => {
    const detection =
      item.seriesId === "detections" && Array.isArray(item.data)
        ? scene.detections[Number(item.data[2])]
        : undefined;
    if (!detection) return "";
    return tipContent(`Detection ${detection.id}`, [
      ["time", timeText(detection.time, origin)],
      ["bearing", `${number(detection.bearing)}°`],
    ]);
  };
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: { trigger: "item", ...tooltip(palette), formatter: tip },
      xAxis: valueAxis("bearing, clockwise from north (°)", palette, degrees),
      yAxis: valueAxis(timeAxisName(origin), palette, {
        inverse: true,
        ...range,
        nameGap: 42,
        axisLabel: axisLabel(palette),
      }),
      dataZoom: [
        { type: "inside", xAxisIndex: 0, filterMode: "none", zoomOnMouseWheel: "ctrl" },
        { type: "inside", yAxisIndex: 0, filterMode: "none", zoomOnMouseWheel: "ctrl" },
      ],
      series: seriesOf(props, moment, palette),
    },
    { replaceMerge: ["series"] },
  );
}

/** The line whose drawn point is nearest to a pixel; tracks before truth. */
function nearest(
  chart: Chart,
  { scene, clock }: Props,
  x: number,
  y: number,
): { track: string } | { truth: string } | undefined {
  const { origin } = clock;
  const closest = (all: Iterable<BearingLine>): string | undefined => {
    let best = { id: "", distance: REACH_PX };
    for (const line of all) {
      line.time.forEach((time, row) => {
        const [px, py] = chart.convertToPixel("grid", [
          line.bearing[row] ?? 0,
          time - origin,
        ]) as unknown as [number, number];
        const distance = Math.hypot(px - x, py - y);
        if (distance < best.distance) best = { id: line.id, distance };
      });
    }
    return best.id || undefined;
  };
  const track = closest(scene.tracks.values());
  if (track) return { track };
  const truth = closest(scene.truths.values());
  return truth ? { truth } : undefined;
}

function tableOf({ scene, clock }: Props, moment: Moment): TableData {
  const rowsOf = (layer: string, line: BearingLine) =>
    line.time.map((time, row) => [
      layer,
      line.id,
      time,
      line.bearing[row] ?? null,
      line.rate[row] ?? null,
      line.sigma[row] ?? null,
    ]);
  const all = [
    ...[...scene.truths.values()].flatMap((line) => rowsOf("truth", line)),
    ...scene.detections.map(({ id, time, bearing }) => [
      "detection",
      id,
      time,
      bearing,
      null,
      null,
    ]),
    ...[...scene.tracks.values()].flatMap((line) => rowsOf("track", line)),
  ];
  const columns = [
    "layer",
    "id",
    "time_s",
    "bearing_deg",
    "bearing_rate_degps",
    "sigma_bearing_deg",
  ];
  return {
    columns,
    rows: all.filter((row) => isWithin(Number(row[2]), moment)),
    origin_s: clock.origin,
  };
}

function badgeOf(series: BearingTime, levels: Levels | undefined): string | undefined {
  const bearings = reducedBadge([{ ...series, name: "bearings" }]);
  const blocks =
    levels && levels.perBlock > 1 ? `levels are means of ${levels.perBlock} cells` : undefined;
  return [bearings, blocks].filter(Boolean).join("; ") || undefined;
}

function pictureKey({ scene, levels }: Props, moment: Moment, palette: Palette): KeyMark[] {
  const shown = (layer: string, there: boolean) => there && !moment.hidden.has(layer);
  const drawn = scene.detections.filter(({ time }) => isWithin(time, moment)).length;
  const key: KeyMark[] = [];
  if (levels && shown("levels", true)) {
    key.push({
      name: `levels, ${number(levels.low)} to ${number(levels.high)} dB`,
      color: palette.muted,
      look: "area",
    });
  }
  if (shown("d", drawn > 0))
    key.push({
      name: "detections",
      color: palette.sensors[0] ?? palette.text,
      look: "dot",
      symbol: dotLook(drawn).symbol,
    });
  if (shown("truth", scene.truths.size > 0))
    key.push({ name: "truth", color: palette.truth, look: "solid" });
  if (shown("tracks", scene.tracks.size > 0))
    key.push({ name: "tracks", color: palette.track, look: "solid" });
  if (scene.truths.has(moment.truth ?? ""))
    key.push({ name: `selected ${moment.truth}`, color: palette.truth, look: "solid" });
  if (scene.tracks.has(moment.track ?? ""))
    key.push({ name: `selected ${moment.track}`, color: palette.selected, look: "solid" });
  return key;
}

export function BearingTimeChart(props: Props): JSX.Element {
  const { jobId, series, scene, clock, levels } = props;
  const chart = useRef<Chart | undefined>(undefined);
  const moment = momentOf(clock);
  const pressed = (made: Chart) => {
    const press = ({ offsetX, offsetY }: { offsetX: number; offsetY: number }) => {
      if (!made.containPixel("grid", [offsetX, offsetY])) return;
      setParams({ track: null, truth: null, ...nearest(made, props, offsetX, offsetY) }, "push");
    };
    made.getZr().on("click", press);
    return () => made.getZr().off("click", press);
  };
  const sizes = [
    plural(scene.truths.size, "truth line"),
    plural(scene.tracks.size, "track"),
    plural(scene.detections.length, "detection"),
  ];
  const title = `Bearings over time up to ${timeText(moment.now, clock.origin)}`;
  const label = `${title}: ${sizes.join(", ")}. The table shows the same points.`;
  return (
    <ChartFrame
      title="Bearing–time"
      file={`bearing-time-${jobId.slice(-12)}`}
      badge={badgeOf(series, levels)}
      table={() => tableOf(props, momentOf(clock))}
      chart={() => chart.current}
      pictureKey={(palette) => pictureKey(props, moment, palette)}
      tools={<Layers scene={scene} levels={levels} />}
      class="plan"
    >
      <ChartCanvas
        class="plan-canvas"
        label={label}
        keys={[
          scene,
          levels,
          moment.from,
          moment.now,
          param("hide"),
          moment.truth,
          moment.track,
          theme.value,
        ]}
        draw={(made) => {
          chart.current = made;
          draw(made, props, momentOf(clock));
        }}
        created={pressed}
      />
    </ChartFrame>
  );
}

function Layers({
  scene,
  levels,
}: {
  scene: BearingScene;
  levels: Levels | undefined;
}): JSX.Element {
  const hidden = (param("hide") ?? "").split(",").filter(Boolean);
  const toggle = (layer: string) => () =>
    setParams({
      hide: (hidden.includes(layer)
        ? hidden.filter((name) => name !== layer)
        : [...hidden, layer]
      ).join(","),
    });
  const entries: [string, string, string, boolean][] = [
    ["truth", "truth", "mark-truth", scene.truths.size > 0],
    ["tracks", "tracks", "mark-track", scene.tracks.size > 0],
    ["d", "detections", "mark-sensor-1", scene.detections.length > 0],
    [
      "levels",
      levels ? `levels, ${number(levels.low)} to ${number(levels.high)} dB` : "",
      "mark-levels",
      levels !== undefined,
    ],
  ];
  return (
    <div class="legend" role="group" aria-label="Layers">
      {entries.map(([layer, name, kind, there]) =>
        there ? (
          <button
            type="button"
            class="legend-entry"
            aria-pressed={!hidden.includes(layer)}
            onClick={toggle(layer)}
          >
            <svg class={`mark ${kind}`} viewBox="0 0 24 16" aria-hidden="true">
              <path
                d={
                  layer === "levels"
                    ? "M4 3h16v10H4Z"
                    : layer === "d"
                      ? "M12 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6Z"
                      : "M1 8h22"
                }
              />
            </svg>
            {name}
          </button>
        ) : null,
      )}
    </div>
  );
}
