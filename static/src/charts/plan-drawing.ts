// The drawing of the plan view: its camera, its axes, what is under the pointer, and what stands on
// the canvas.

import type { Signal } from "@preact/signals";
import type { Gates, Plan } from "../api/types";
import { metres } from "../format";
import type { Clock } from "../state/clock";
import { type Palette, readPalette, theme } from "../state/theme";
import { param, setParams } from "../state/url";
import { timeText } from "../times";
import { GRID, MARGIN, textStyle, tipContent, tooltip, valueAxis } from "./axes";
import {
  bounds,
  type Camera,
  fit,
  fromText,
  lookAt,
  metresPerPixel,
  type Size,
  toText,
  zoomed,
} from "./camera";
import { type Density, densitySeries } from "./density";
import type { Chart } from "./echarts";
import { NO_EVENT } from "./event-moment";
import { gatesAt } from "./gates";
import { listen } from "./gestures";
import { type Moment, nearest, planSeries } from "./plan-series";
import { type Ruler, rulerOf, rulerSeries, rulerText } from "./ruler";
import type { Scene } from "./scene";

const REACH_PX = 14;
/**
 * Spans, and places far from the origin while not looked at too closely, are said in kilometres.
 */
const KILOMETRES_FROM_M = 10_000;
const CLOSE_M = 1000;
const ADDRESS_AFTER_MS = 250;
/** Cells of a density wider than this show their detections too. */
const CELL_PX = 10;

export interface PlanViewProps {
  jobId: string;
  plan: Plan;
  scene: Scene;
  clock: Clock;
  /** Of the selected track, where the job had gates. */
  gates: Gates | undefined;
  /** What is not drawn, and why. */
  notes: string[];
}

function hiddenLayers(): Set<string> {
  return new Set((param("hide") ?? "").split(",").filter(Boolean));
}

export function momentOf(clock: Clock): Moment {
  const trail = Number(param("trail"));
  const now = clock.time.value;
  const from =
    trail > 0 ? (clock.times[Math.max(0, clock.index.value - trail)] ?? -Infinity) : -Infinity;
  return { from, now, hidden: hiddenLayers(), truth: param("truth"), track: param("track") };
}

function sizeOf(chart: Chart): Size {
  return {
    width: Math.max(chart.getWidth() - MARGIN.left - MARGIN.right, 1),
    height: Math.max(chart.getHeight() - MARGIN.top - MARGIN.bottom, 1),
  };
}

/**
 * The camera of the address: numbers, or "selection" for what is selected; otherwise everything.
 */
function addressed(scene: Scene, size: Size): Camera {
  const time = param("time");
  const selected = { truth: param("truth"), track: param("track") };
  const onSelection =
    param("centre") === "selection"
      ? lookAt(scene, selected, time === null ? null : Number(time), size)
      : undefined;
  return onSelection ?? fromText(param("centre"), param("span")) ?? fit(scene.extent, size);
}

function axes(camera: Camera, size: Size, palette: Palette): Record<string, object> {
  const view = bounds(camera, size);
  const isFar =
    Math.max(...Object.values(view).map(Math.abs)) >= KILOMETRES_FROM_M && camera.span >= CLOSE_M;
  const kilometres = isFar || camera.span >= KILOMETRES_FROM_M;
  const unit = kilometres ? "km" : "m";
  const digits = Math.max(0, Math.ceil(1 - Math.log10(camera.span / (kilometres ? 1000 : 1) / 10)));
  const label = {
    color: palette.muted,
    fontSize: 11,
    showMinLabel: false,
    showMaxLabel: false,
    hideOverlap: true,
  };
  const formatter = (value: number) =>
    String(Number((kilometres ? value / 1000 : value).toFixed(Math.min(digits, 6))));
  const axis = (name: string, min: number, max: number, nameGap: number, pixels: number) =>
    valueAxis(`${name} (${unit})`, palette, {
      min,
      max,
      nameGap,
      splitNumber: Math.max(2, Math.round(pixels / 90)),
      axisLabel: { ...label, formatter },
    });
  return {
    xAxis: axis("x, east", view.xMin, view.xMax, 26, size.width),
    yAxis: axis("y, north", view.yMin, view.yMax, 46, size.height),
  };
}

interface TipItem {
  seriesId?: string;
  name?: string;
  data?: unknown;
}

function tip(scene: Scene, item: TipItem): HTMLElement | string {
  const layer = item.seriesId ?? "";
  if (layer.startsWith("detections:") && Array.isArray(item.data)) {
    const cloud = scene.clouds.find((entry) => `detections:${entry.sensor}` === layer);
    const row = Number(item.data[2]);
    if (!cloud) return "";
    const position = `${metres(cloud.x[row] ?? 0)}, ${metres(cloud.y[row] ?? 0)} m`;
    return tipContent(`Detection ${cloud.id[row] ?? ""}`, [
      ["time", timeText(cloud.time[row] ?? 0, scene.origin)],
      ["position", position],
      ["origin", cloud.truth[row] ?? "clutter or unknown"],
    ]);
  }
  if (layer === "heads") return tipContent(`Track ${item.name ?? ""}`, [["", "click to select"]]);
  return layer === "sensors" ? tipContent(`Sensor ${item.name ?? ""}`, []) : "";
}

export class PlanDrawing {
  chart: Chart | undefined;
  private pending = 0;
  /**
   * What the series on the chart show; while it is the same, a moved camera changes the axes alone.
   */
  private shown = "";
  private scene: Scene | undefined;
  constructor(
    public props: PlanViewProps,
    readonly camera: Signal<Camera | undefined>,
    /** While it is drawn by hand; afterwards the address has it. */
    readonly stretched: Signal<Ruler | undefined>,
  ) {}

  size(): Size {
    return this.chart ? sizeOf(this.chart) : { width: 600, height: 400 };
  }

  look(): Camera {
    return this.camera.peek() ?? addressed(this.props.scene, this.size());
  }

  /** Moves the camera at once, and the address when the hand rests. */
  move(to: Camera): void {
    this.camera.value = to;
    window.clearTimeout(this.pending);
    this.pending = window.setTimeout(() => {
      this.pending = 0;
      setParams(toText(to));
    }, ADDRESS_AFTER_MS);
  }

  /** The camera that the hand left stands in the address. */
  isWritten(): boolean {
    return this.pending === 0;
  }

  fitAll(): void {
    window.clearTimeout(this.pending);
    this.pending = 0;
    this.camera.value = undefined;
    setParams({ centre: null, span: null });
  }

  spot(x: number, y: number): { x: number; y: number } {
    const view = bounds(this.look(), this.size());
    const scale = metresPerPixel(this.look(), this.size());
    return { x: view.xMin + (x - MARGIN.left) * scale, y: view.yMax - (y - MARGIN.top) * scale };
  }

  listen(box: HTMLElement): () => void {
    return listen(box, {
      drag: (start, before, now) => {
        if (param("ruler") !== null)
          this.stretched.value = { from: this.spot(start.x, start.y), to: this.spot(now.x, now.y) };
        else this.pan(now.x - before.x, now.y - before.y);
      },
      dropped: () => {
        if (this.stretched.peek()) this.lay(this.stretched.peek() ?? {});
      },
      zoom: (factor, x, y) => {
        const at = this.spot(x, y);
        this.move(zoomed(this.look(), factor, at.x, at.y));
      },
      click: (x, y) => (param("ruler") === null ? this.select(x, y) : this.lay(this.pointed(x, y))),
    });
  }

  private pan(dx: number, dy: number): void {
    const camera = this.look();
    const scale = metresPerPixel(camera, this.size());
    this.move({ ...camera, x: camera.x - dx * scale, y: camera.y + dy * scale });
  }

  /** The first press is where the ruler begins, the second where it ends, the third begins anew. */
  private pointed(x: number, y: number): Ruler {
    const { from, to } = rulerOf(param("ruler")) ?? {};
    const at = this.spot(x, y);
    return from && !to ? { from, to: at } : { from: at };
  }

  private lay(ruler: Ruler): void {
    this.stretched.value = undefined;
    setParams({ ruler: rulerText(ruler) });
  }

  ruler(): Ruler | undefined {
    return this.stretched.value ?? rulerOf(param("ruler"));
  }

  /** The density, while everything up to the end is shown and no layer of detections is hidden. */
  density(moment: Moment): Density | undefined {
    const { scene, plan } = this.props;
    const whole = moment.from === -Infinity && moment.now >= (scene.times.at(-1) ?? 0);
    return whole && scene.clouds.every((cloud) => !moment.hidden.has(`d:${cloud.sensor}`))
      ? plan.density
      : undefined;
  }

  private select(x: number, y: number): void {
    const at = this.spot(x, y);
    const reach = REACH_PX * metresPerPixel(this.look(), this.size());
    const found = nearest(this.props.scene, momentOf(this.props.clock), at.x, at.y, reach);
    const frozen = param("centre") === "selection" ? toText(this.look()) : {};
    setParams({ ...frozen, ...NO_EVENT, track: null, truth: null, ...found }, "push");
  }

  /** Where a cell is large on the screen, single detections say more. */
  hasDots(density: Density | undefined): boolean {
    return !density || density.cell_m > CELL_PX * metresPerPixel(this.look(), this.size());
  }

  draw(chart: Chart, moment: Moment): void {
    const { scene, plan, gates } = this.props;
    if (chart !== this.chart || scene !== this.scene) this.shown = "";
    [this.chart, this.scene] = [chart, scene];
    const palette = readPalette();
    const view = axes(this.look(), this.size(), palette);
    const density = this.density(moment);
    const dots = this.hasDots(density);
    const ruler = rulerSeries(this.ruler(), palette);
    const hasGates = gatesAt(gates, moment.track, moment.now).length;
    const content = JSON.stringify([
      moment.from,
      moment.now,
      [...moment.hidden],
      moment.truth,
      moment.track,
      theme.peek(),
      dots,
      hasGates,
    ]);
    if (content === this.shown) {
      chart.setOption({ ...view, series: ruler });
      return;
    }
    this.shown = content;
    const around = { scene, sensors: plan.sensors, gates, dots };
    chart.setOption(
      {
        animation: false,
        grid: GRID,
        textStyle: textStyle(palette),
        tooltip: {
          trigger: "item",
          ...tooltip(palette),
          formatter: (item: TipItem) => tip(scene, item),
        },
        ...view,
        series: [
          ...densitySeries(density, palette.sensors[0] ?? palette.text),
          ...planSeries(around, moment, palette),
          ...ruler,
        ],
      },
      { replaceMerge: ["series"] },
    );
  }
}
