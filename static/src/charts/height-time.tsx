// Heights over time, up to the clock's moment: what the plan, seen from above, cannot show. Its
// layers are shown and hidden, and its lines selected, together with those of the plan.

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { TableData } from "../components/table";
import { number, plural } from "../format";
import type { Clock } from "../state/clock";
import { type Palette, readPalette, theme } from "../state/theme";
import { param, setParams } from "../state/url";
import { timeAxisName, timeText } from "../times";
import { GRID, lowerLabel, ruleAt, textStyle, tipContent, tooltip, valueAxis } from "./axes";
import { ChartCanvas } from "./chart";
import type { Chart } from "./echarts";
import { ChartFrame } from "./frame";
import type { HeightCloud, HeightLine, HeightScene } from "./height-scene";
import { Key, type KeyMark } from "./marks";
import { momentOf } from "./plan-drawing";
import type { Moment } from "./plan-series";

const REACH_PX = 14;
const LARGE = 2000;

interface Props {
  jobId: string;
  scene: HeightScene;
  clock: Clock;
}

type Spot = [number, number];
const BREAK: Spot = [NaN, NaN];

const isWithin = (time: number, { from, now }: Moment): boolean =>
  time >= from - 1e-9 && time <= now + 1e-9;

/** The lines as one, with a hole between each two. */
function spotsOf(lines: Iterable<HeightLine>, moment: Moment, origin: number): Spot[] {
  return [...lines].flatMap((line) => [
    ...line.time.flatMap((time, row): Spot[] =>
      isWithin(time, moment) ? [[time - origin, line.height[row] ?? NaN]] : [],
    ),
    BREAK,
  ]);
}

const sensorColor = (palette: Palette, order: number): string =>
  palette.sensors[order % palette.sensors.length] ?? palette.text;

function dotsOf(cloud: HeightCloud, order: number, moment: Moment, props: Props): object {
  const { origin } = props.clock;
  const isHidden = moment.hidden.has(`d:${cloud.sensor}`);
  const data = cloud.points.flatMap(({ time, height }, row) =>
    isWithin(time, moment) && !isHidden ? [[time - origin, height, row]] : [],
  );
  const large = data.length > LARGE;
  return {
    type: "scatter",
    id: `d:${order}`,
    data,
    symbol: large ? "rect" : "circle",
    symbolSize: large ? 2.5 : 3.5,
    large,
    largeThreshold: LARGE,
    progressive: 0,
    animation: false,
    itemStyle: { color: sensorColor(readPalette(), order), opacity: 0.75 },
    z: 2,
  };
}

interface Stroke {
  id: string;
  lines: Iterable<HeightLine>;
  color: string;
  width: number;
}

function seriesOf(props: Props, moment: Moment, palette: Palette): object[] {
  const { scene, clock } = props;
  const shown = (layer: string) => !moment.hidden.has(layer);
  const truth = scene.truths.get(moment.truth ?? "");
  const track = scene.tracks.get(moment.track ?? "");
  const strokes: Stroke[] = [
    {
      id: "truth",
      lines: shown("truth") ? scene.truths.values() : [],
      color: palette.truth,
      width: 1.4,
    },
    {
      id: "tracks",
      lines: shown("tracks") ? scene.tracks.values() : [],
      color: palette.track,
      width: 1.8,
    },
    { id: "chosen-truth", lines: truth ? [truth] : [], color: palette.truth, width: 3 },
    { id: "chosen-track", lines: track ? [track] : [], color: palette.selected, width: 3 },
  ];
  const cursor = { color: palette.selected, width: 1.2, type: "dashed" as const };
  const still = { type: "line", silent: true, animation: false, connectNulls: false };
  const drawn = strokes.map(({ id, lines, color, width }, order) => {
    const data = spotsOf(lines, moment, clock.origin);
    // A single point has no line.
    const showSymbol = data.length < 60;
    const look = { lineStyle: { color, width }, itemStyle: { color }, symbolSize: 4, showSymbol };
    const rule = order ? {} : { markLine: ruleAt({ xAxis: moment.now - clock.origin }, cursor) };
    return { ...still, id, data, ...look, ...rule, z: 3 + order };
  });
  return [...scene.clouds.map((cloud, order) => dotsOf(cloud, order, moment, props)), ...drawn];
}

function draw(chart: Chart, props: Props, moment: Moment): void {
  const palette = readPalette();
  const { clock, scene } = props;
  const { origin } = clock;
  const range = { min: (clock.times[0] ?? 0) - origin, max: (clock.times.at(-1) ?? 1) - origin };
  const tip = (item: { seriesId?: string; data?: unknown }) => {
    const cloud = scene.clouds[Number(item.seriesId?.replace(/^d:/, ""))];
    const point = Array.isArray(item.data) ? cloud?.points[Number(item.data[2])] : undefined;
    if (!cloud || !point) return "";
    return tipContent(`Detection ${point.id}`, [
      ["sensor", cloud.sensor],
      ["time", timeText(point.time, origin)],
      ["height", `${number(point.height)} m`],
    ]);
  };
  const below = { ...range, nameGap: 26, axisLabel: lowerLabel(palette) };
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: { trigger: "item", ...tooltip(palette), formatter: tip },
      xAxis: valueAxis(timeAxisName(origin), palette, below),
      yAxis: valueAxis("height (m)", palette, { scale: true, nameGap: 42 }),
      dataZoom: [
        { type: "inside", xAxisIndex: 0, filterMode: "none", zoomOnMouseWheel: "ctrl" },
        { type: "inside", yAxisIndex: 0, filterMode: "none", zoomOnMouseWheel: "ctrl" },
      ],
      series: seriesOf(props, moment, palette),
    },
    { replaceMerge: ["series"] },
  );
}

/** The line with the drawn point that is nearest to a pixel; tracks before truth. */
function nearest(
  chart: Chart,
  { scene, clock }: Props,
  at: { x: number; y: number },
): { track: string } | { truth: string } | undefined {
  const moment = momentOf(clock);
  const closest = (lines: Iterable<HeightLine>): string | undefined => {
    let best = { id: "", distance: REACH_PX };
    for (const line of lines)
      for (const [row, time] of line.time.entries()) {
        if (!isWithin(time, moment)) continue;
        const spot = [time - clock.origin, line.height[row] ?? NaN];
        const [px, py] = chart.convertToPixel("grid", spot) as unknown as Spot;
        const distance = Math.hypot(px - at.x, py - at.y);
        if (distance < best.distance) best = { id: line.id, distance };
      }
    return best.id || undefined;
  };
  const track = moment.hidden.has("tracks") ? undefined : closest(scene.tracks.values());
  if (track) return { track };
  const truth = moment.hidden.has("truth") ? undefined : closest(scene.truths.values());
  return truth ? { truth } : undefined;
}

/** The data as drawn: one row a point, whatever its layer. */
function tableOf({ scene, clock }: Props, moment: Moment): TableData {
  const ofLines = (layer: string, key: string, lines: Iterable<HeightLine>) =>
    moment.hidden.has(key)
      ? []
      : [...lines].flatMap((line) =>
          line.time.map((time, row) => [layer, line.id, time, line.height[row] ?? null, null]),
        );
  const ofCloud = ({ sensor, points }: HeightCloud) =>
    moment.hidden.has(`d:${sensor}`)
      ? []
      : points.map(({ id, time, height }) => ["detection", id, time, height, sensor]);
  const rows = [
    ...ofLines("truth", "truth", scene.truths.values()),
    ...scene.clouds.flatMap(ofCloud),
    ...ofLines("track", "tracks", scene.tracks.values()),
  ];
  return {
    columns: ["layer", "id", "time_s", "height_m", "sensor_id"],
    rows: rows.filter((row) => isWithin(Number(row[2]), moment)),
    origin_s: clock.origin,
  };
}

function keyOf({ scene }: Props, moment: Moment, palette: Palette): KeyMark[] {
  const shown = (layer: string) => !moment.hidden.has(layer);
  const key: KeyMark[] = [];
  if (scene.truths.size && shown("truth"))
    key.push({ name: "truth", color: palette.truth, look: "solid" });
  if (scene.tracks.size && shown("tracks"))
    key.push({ name: "tracks", color: palette.track, look: "solid" });
  for (const [order, { sensor, points }] of scene.clouds.entries())
    if (points.length && shown(`d:${sensor}`)) {
      const color = sensorColor(palette, order);
      key.push({ name: `detections, ${sensor}`, color, look: "dot" });
    }
  if (scene.truths.has(moment.truth ?? ""))
    key.push({ name: `selected ${moment.truth}`, color: palette.truth, look: "solid" });
  if (scene.tracks.has(moment.track ?? ""))
    key.push({ name: `selected ${moment.track}`, color: palette.selected, look: "solid" });
  return key;
}

export function HeightTimeChart(props: Props): JSX.Element {
  const { jobId, scene, clock } = props;
  const chart = useRef<Chart | undefined>(undefined);
  const moment = momentOf(clock);
  const pressed = (made: Chart) => {
    const press = ({ offsetX, offsetY }: { offsetX: number; offsetY: number }) => {
      if (!made.containPixel("grid", [offsetX, offsetY])) return;
      const found = nearest(made, props, { x: offsetX, y: offsetY });
      setParams({ track: null, truth: null, ...found }, "push");
    };
    made.getZr().on("click", press);
    return () => made.getZr().off("click", press);
  };
  const sizes = [plural(scene.truths.size, "truth line"), plural(scene.tracks.size, "track")];
  const title = `Heights over time up to ${timeText(moment.now, clock.origin)}`;
  const { from, now, truth, track } = moment;
  return (
    <ChartFrame
      title="Height over time"
      file={`height-time-${jobId.slice(-12)}`}
      table={() => tableOf(props, momentOf(clock))}
      chart={() => chart.current}
      pictureKey={(palette) => keyOf(props, moment, palette)}
      tools={<Key marks={(palette) => keyOf(props, moment, palette)} />}
    >
      <ChartCanvas
        class="lines-canvas"
        label={`${title}: ${sizes.join(", ")}. The table shows the same points.`}
        keys={[scene, from, now, param("hide"), truth, track, theme.value]}
        draw={(made) => {
          chart.current = made;
          draw(made, props, momentOf(clock));
        }}
        created={pressed}
      />
    </ChartFrame>
  );
}
