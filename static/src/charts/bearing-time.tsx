// The bearing-time picture: time runs down, bearings across, as operators read it; detections with truth and tracks over them.

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { BearingTime } from "../api/types";
import type { TableData } from "../components/table";
import { number } from "../format";
import type { Clock } from "../state/clock";
import { readPalette, theme, type Palette } from "../state/theme";
import { param, setParams } from "../state/url";
import { GRID, textStyle, timeAxisName, timeOrigin, timeText, tipContent, tooltip, valueAxis } from "./axes";
import { unwrapped, type BearingLine, type BearingScene } from "./bearing-scene";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame, reducedBadge } from "./frame";
import { shades, type Levels } from "./levels";
import type { KeyMark } from "./picture";
import { momentOf } from "./plan-view";

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
  const origin = timeOrigin(clock.times);
  const renderItem = (_: unknown, api: { coord: (at: [number, number]) => [number, number] }) => {
    const [left, top] = api.coord([levels.fromBearing, levels.fromTime - origin]);
    const [right, bottom] = api.coord([levels.toBearing, levels.toTime - origin]);
    return { type: "image", style: { image, x: left, y: top, width: right - left, height: bottom - top } };
  };
  return [{ type: "custom", id: "levels", data: [[0, 0]], renderItem, silent: true, clip: true, animation: false, z: 1 }];
}

type Moment = ReturnType<typeof momentOf>;

function lines(all: Iterable<BearingLine>, moment: Moment, origin: number): [number, number][] {
  return [...all].flatMap((line) => unwrapped(line, moment.from, moment.now, origin));
}

function seriesOf(props: Props, moment: Moment, palette: Palette): object[] {
  const { scene, clock } = props;
  const origin = timeOrigin(clock.times);
  const line = (id: string, data: unknown[], color: string, width: number, z: number) => ({ type: "line", id, data, showSymbol: false, silent: true, animation: false, z, lineStyle: { color, width } });
  const dots = scene.detections.flatMap(({ time, bearing }, row) => (time >= moment.from - 1e-9 && time <= moment.now + 1e-9 ? [[bearing, time - origin, row]] : []));
  const shown = (layer: string) => !moment.hidden.has(layer);
  const cursor = { silent: true, symbol: "none", label: { show: false }, animation: false, lineStyle: { color: palette.selected, width: 1.2, type: "dashed" }, data: [{ yAxis: moment.now - origin }] };
  const chosen = [scene.truths.get(moment.truth ?? ""), scene.tracks.get(moment.track ?? "")];
  return [
    ...levelSeries(props, moment, palette),
    { type: "scatter", id: "detections", data: shown("d") ? dots : [], symbol: "circle", symbolSize: dots.length > LARGE ? 2.5 : 3.5, large: dots.length > LARGE, itemStyle: { color: palette.sensors[0], opacity: 0.75 }, animation: false, progressive: 0, z: 2, markLine: cursor },
    line("truth", shown("truth") ? lines(scene.truths.values(), moment, origin) : [], palette.truth, 1.4, 3),
    line("tracks", shown("tracks") ? lines(scene.tracks.values(), moment, origin) : [], palette.track, 1.8, 4),
    line("chosen-truth", chosen[0] ? lines([chosen[0]], moment, origin) : [], palette.truth, 3, 5),
    line("chosen-track", chosen[1] ? lines([chosen[1]], moment, origin) : [], palette.selected, 3, 6),
  ];
}

function draw(chart: Chart, props: Props, moment: Moment): void {
  const palette = readPalette();
  const { clock, scene } = props;
  const origin = timeOrigin(clock.times);
  const label = { color: palette.muted, fontSize: 11, hideOverlap: true };
  const tip = (item: { seriesId?: string; data?: unknown }) => {
    const detection = item.seriesId === "detections" && Array.isArray(item.data) ? scene.detections[Number(item.data[2])] : undefined;
    if (!detection) return "";
    return tipContent(`Detection ${detection.id}`, [
      ["time", timeText(detection.time, clock.times)],
      ["bearing", `${number(detection.bearing)}°`],
    ]);
  };
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: { trigger: "item", ...tooltip(palette), formatter: tip },
      xAxis: valueAxis("bearing, clockwise from north (°)", palette, { min: 0, max: 360, interval: 45, nameGap: 26, axisLabel: label }),
      yAxis: valueAxis(timeAxisName(clock.times), palette, { inverse: true, min: (clock.times[0] ?? 0) - origin, max: (clock.times.at(-1) ?? 1) - origin, nameGap: 42, axisLabel: label }),
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
function nearest(chart: Chart, { scene, clock }: Props, x: number, y: number): { track: string } | { truth: string } | undefined {
  const origin = timeOrigin(clock.times);
  const closest = (all: Iterable<BearingLine>): string | undefined => {
    let best = { id: "", distance: REACH_PX };
    for (const line of all) {
      line.time.forEach((time, row) => {
        const [px, py] = chart.convertToPixel("grid", [line.bearing[row] ?? 0, time - origin]) as unknown as [number, number];
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

function tableOf({ scene }: Props, moment: Moment): TableData {
  const within = (time: number) => time >= moment.from - 1e-9 && time <= moment.now + 1e-9;
  const ofLines = (layer: string, all: Iterable<BearingLine>) => [...all].flatMap((line) => line.time.flatMap((time, row) => (within(time) ? [[layer, line.id, time, line.bearing[row] ?? null, line.rate[row] ?? null, line.sigma[row] ?? null]] : [])));
  const dots = scene.detections.flatMap(({ id, time, bearing }) => (within(time) ? [["detection", id, time, bearing, null, null]] : []));
  return { columns: ["layer", "id", "time_s", "bearing_deg", "bearing_rate_degps", "sigma_bearing_deg"], rows: [...ofLines("truth", scene.truths.values()), ...dots, ...ofLines("track", scene.tracks.values())] };
}

function badgeOf(series: BearingTime, levels: Levels | undefined): string | undefined {
  const bearings = reducedBadge([{ ...series, name: "bearings" }]);
  const blocks = levels && levels.perBlock > 1 ? `levels are means of ${levels.perBlock} cells` : undefined;
  return [bearings, blocks].filter(Boolean).join("; ") || undefined;
}

export function BearingTimeChart(props: Props): JSX.Element {
  const { jobId, series, scene, clock, levels } = props;
  const chart = useRef<Chart | undefined>(undefined);
  const moment = momentOf(clock);
  const pressed = (made: Chart) => {
    const press = (event: { offsetX: number; offsetY: number }) => {
      if (made.containPixel("grid", [event.offsetX, event.offsetY])) setParams({ track: null, truth: null, ...nearest(made, props, event.offsetX, event.offsetY) }, "push");
    };
    made.getZr().on("click", press);
    return () => made.getZr().off("click", press);
  };
  const key = (palette: Palette): KeyMark[] => [
    ...(levels && !moment.hidden.has("levels") ? [{ name: `levels, ${number(levels.low)} to ${number(levels.high)} dB`, color: palette.muted, look: "dot" } as const] : []),
    { name: "detections", color: palette.sensors[0] ?? palette.text, look: "dot" },
    { name: "truth", color: palette.truth, look: "solid" },
    { name: "tracks", color: palette.track, look: "solid" },
    ...(moment.track || moment.truth ? [{ name: `selected ${[moment.truth, moment.track].filter(Boolean).join(", ")}`, color: palette.selected, look: "solid" } as const] : []),
  ];
  const label = `Bearings over time up to ${timeText(moment.now, clock.times)}: ${scene.truths.size} truth lines, ${scene.tracks.size} tracks, ${scene.detections.length} detections. The table shows the same points.`;
  return (
    <ChartFrame title="Bearing–time" file={`bearing-time-${jobId.slice(-12)}`} badge={badgeOf(series, levels)} table={() => tableOf(props, momentOf(clock))} chart={() => chart.current} pictureKey={key} tools={<Layers scene={scene} levels={levels} />} class="plan">
      <ChartCanvas
        class="plan-canvas"
        label={label}
        keys={[scene, levels, moment.from, moment.now, param("hide"), moment.truth, moment.track, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, props, momentOf(clock));
        }}
        created={pressed}
      />
    </ChartFrame>
  );
}

function Layers({ scene, levels }: { scene: BearingScene; levels: Levels | undefined }): JSX.Element {
  const hidden = (param("hide") ?? "").split(",").filter(Boolean);
  const toggle = (layer: string) => () => setParams({ hide: (hidden.includes(layer) ? hidden.filter((name) => name !== layer) : [...hidden, layer]).join(",") });
  const entries: [string, string, string, boolean][] = [
    ["truth", "truth", "mark-truth", scene.truths.size > 0],
    ["tracks", "tracks", "mark-track", scene.tracks.size > 0],
    ["d", "detections", "mark-sensor-1", scene.detections.length > 0],
    ["levels", levels ? `levels, ${number(levels.low)} to ${number(levels.high)} dB` : "", "mark-levels", levels !== undefined],
  ];
  return (
    <div class="legend" role="group" aria-label="Layers">
      {entries.map(([layer, name, kind, there]) =>
        there ? (
          <button type="button" class="legend-entry" aria-pressed={!hidden.includes(layer)} onClick={toggle(layer)}>
            <svg class={`mark ${kind}`} viewBox="0 0 24 16" aria-hidden="true">
              <path d={layer === "levels" ? "M4 3h16v10H4Z" : layer === "d" ? "M12 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6Z" : "M1 8h22"} />
            </svg>
            {name}
          </button>
        ) : null,
      )}
    </div>
  );
}
