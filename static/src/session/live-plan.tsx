// The plan of a live session on the page: the camera, what hands do, and the place under the
// pointer.

import { type Signal, signal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import {
  bounds,
  type Camera,
  fit,
  fromText,
  metresPerPixel,
  type Size,
  toText,
  zoomed,
} from "../charts/camera";
import { ChartFrame } from "../charts/frame";
import { listen } from "../charts/gestures";
import type { KeyMark } from "../charts/marks";
import { Key } from "../charts/marks";
import { Painted, type Spot } from "../charts/painted";
import type { Painting } from "../charts/pen";
import { type Looks, planKeys, ZoomButtons } from "../charts/plan-hands";
import { type Ruler, rulerOf, rulerText } from "../charts/ruler";
import { RulerPanel } from "../charts/ruler-panel";
import type { TableData } from "../components/table";
import { metres, number, plural } from "../format";
import { type Palette, readPalette, theme } from "../state/theme";
import { param, setParams } from "../state/url";
import { earthText, type Origin, onEarth } from "./earth";
import type { Follower } from "./follow";
import {
  arrowSeconds,
  extentOf,
  fading,
  type LivePlan,
  livePainting,
  sensorColor,
  trackNear,
} from "./plan-paint";
import { clockText } from "./time";

const REACH_PX = 14;
const ADDRESS_AFTER_MS = 250;
const HEAD_PX = 330;
/** A camera that nobody moved looks anew when less than this share of it has anything in it. */
const LEAST_FILLED = 0.4;
const KEYS_TEXT =
  "plus and minus zoom, 0 shows everything, shift and arrows pan, r takes the ruler";

export interface LiveProps {
  follower: Follower;
  /** The time that is looked at; the newest where there is none. */
  at: Signal<number | undefined>;
}

export function trailPoints(): number | undefined {
  return Number(param("trail")) || undefined;
}

class LiveView implements Looks {
  size: Size = { width: 900, height: 500 };
  readonly camera = signal<Camera | undefined>(fromText(param("centre"), param("span")));
  readonly pointer = signal<Spot | undefined>(undefined);
  readonly stretched = signal<Ruler | undefined>(undefined);
  plan: LivePlan | undefined;
  private auto: Camera | undefined;
  private pending = 0;

  look(): Camera {
    return this.camera.peek() ?? this.auto ?? { x: 0, y: 0, span: 1000 };
  }

  /** Looks at all that is drawn, and stays until something leaves or little is left. */
  lookAround(plan: LivePlan): Camera {
    if (this.camera.peek()) return this.look();
    const extent = extentOf(plan);
    if (!extent) return this.look();
    const wanted = fit(extent, this.size, 1.2);
    const view = this.auto && bounds(this.auto, this.size);
    const isInside =
      view &&
      extent.xMin >= view.xMin &&
      extent.xMax <= view.xMax &&
      extent.yMin >= view.yMin &&
      extent.yMax <= view.yMax;
    if (!isInside || !this.auto || wanted.span < LEAST_FILLED * this.auto.span) this.auto = wanted;
    return this.auto;
  }

  move(to: Camera): void {
    this.camera.value = to;
    window.clearTimeout(this.pending);
    this.pending = window.setTimeout(() => setParams(toText(to)), ADDRESS_AFTER_MS);
  }

  fitAll(): void {
    window.clearTimeout(this.pending);
    [this.camera.value, this.auto] = [undefined, undefined];
    setParams({ centre: null, span: null });
  }

  /** Keeps how near one looks. */
  lookAtTrack(id: string): void {
    const track = this.plan?.moment?.tracks.find((each) => each.id === id);
    const way = this.plan?.memory.ways.get(id);
    const [x, y] = [track?.x ?? way?.x.at(-1), track?.y ?? way?.y.at(-1)];
    if (x === undefined || y === undefined) return;
    const view = bounds(this.look(), this.size);
    const isSeen = x > view.xMin && x < view.xMax && y > view.yMin && y < view.yMax;
    if (!isSeen) this.move({ ...this.look(), x, y });
  }

  spot({ x, y }: Spot): Spot {
    const view = bounds(this.look(), this.size);
    const scale = metresPerPixel(this.look(), this.size);
    return { x: view.xMin + x * scale, y: view.yMax - y * scale };
  }

  ruler(): Ruler | undefined {
    return this.stretched.value ?? rulerOf(param("ruler"));
  }

  listen(box: HTMLElement): () => void {
    return listen(box, {
      drag: (start, before, now) => {
        if (param("ruler") !== null)
          this.stretched.value = { from: this.spot(start), to: this.spot(now) };
        else this.pan(now.x - before.x, now.y - before.y);
      },
      dropped: () => {
        if (this.stretched.peek()) this.lay(this.stretched.peek() ?? {});
      },
      zoom: (factor, x, y) => {
        const at = this.spot({ x, y });
        this.move(zoomed(this.look(), factor, at.x, at.y));
      },
      click: (x, y) =>
        param("ruler") === null ? this.select(x, y) : this.lay(this.pointed({ x, y })),
    });
  }

  private pan(dx: number, dy: number): void {
    const camera = this.look();
    const scale = metresPerPixel(camera, this.size);
    this.move({ ...camera, x: camera.x - dx * scale, y: camera.y + dy * scale });
  }

  private pointed(at: Spot): Ruler {
    const { from, to } = rulerOf(param("ruler")) ?? {};
    return from && !to ? { from, to: this.spot(at) } : { from: this.spot(at) };
  }

  private lay(ruler: Ruler): void {
    this.stretched.value = undefined;
    setParams({ ruler: rulerText(ruler) });
  }

  private select(x: number, y: number): void {
    if (this.plan) setParams({ track: trackNear(this.plan, x, y, REACH_PX) ?? null }, "push");
  }
}

/** The track that is gone to is looked at, too. */
export const goTo = signal<{ track: string } | undefined>(undefined);

export function PlanOfSession({ follower, at }: LiveProps): JSX.Element {
  const view = useMemo(() => new LiveView(), []);
  const box = useRef<HTMLDivElement>(null);
  const latest = useRef<Painting | undefined>(undefined);
  useEffect(() => (box.current ? view.listen(box.current) : undefined), [view]);
  useEffect(() => {
    if (goTo.value) view.lookAtTrack(goTo.value.track);
    goTo.value = undefined;
  }, [goTo.value]);
  void [theme.value, view.camera.value];
  const palette = readPalette();
  const sensors = follower.picture.value?.sensors ?? [];
  const moment = follower.memory.at(at.value);
  const ruler = view.ruler();
  const sized = (size: Size): LivePlan => {
    view.size = size;
    const plan: LivePlan = {
      ...{ memory: follower.memory, moment, sensors, ruler, palette, size },
      ...{ selected: param("track"), trail: trailPoints(), camera: view.look() },
    };
    plan.camera = view.lookAround(plan);
    view.plan = plan;
    return plan;
  };
  sized(view.size);
  const painting = (width: number): Painting => {
    latest.current = livePainting(sized({ width, height: heightFor(width) }));
    return latest.current;
  };
  const tracks = moment?.tracks.length ?? 0;
  const label = `Plan of the session: ${plural(tracks, "track")}. The table shows the same.`;
  const file = `session-${follower.id.slice(-12)}`;
  const key = (of: Palette) => keyOf(view, of);
  return (
    <ChartFrame
      title="Plan"
      file={file}
      table={() => tableOf(view)}
      chart={() => latest.current}
      pictureKey={key}
      pictureTitle={`Plan at ${moment ? clockText(moment.time) : "no time"}`}
      tools={<PlanKey view={view} marks={key} />}
      class="plan live-plan"
    >
      {ruler ? <RulerPanel ruler={ruler} /> : null}
      <div class="plan-box">
        <div
          ref={box}
          class={ruler ? "plan-touch measuring" : "plan-touch"}
          tabIndex={0}
          role="group"
          aria-label={`Plan; ${KEYS_TEXT}`}
          onKeyDown={(event) => planKeys(event, view)}
        >
          <Painted
            label={label}
            painting={painting}
            point={(spot) => (view.pointer.value = spot)}
          />
        </div>
        <ZoomButtons view={view} isMeasuring={ruler !== undefined} />
      </div>
      <Readout view={view} origin={originOf(follower)} />
    </ChartFrame>
  );
}

/** As much as the window leaves beside the head and the clock. */
function heightFor(width: number): number {
  if (width < 600) return 320;
  return Math.min(Math.max(window.innerHeight - HEAD_PX, 360), 760);
}

function originOf(follower: Follower): Origin | undefined {
  return follower.session.value?.request.origin as Origin | undefined;
}

function Readout({ view, origin }: { view: LiveView; origin: Origin | undefined }): JSX.Element {
  const pointer = view.pointer.value;
  const { x, y } = pointer ? view.spot(pointer) : { x: NaN, y: NaN };
  return (
    <p class="plan-readout">
      {pointer ? (
        <>
          <span>
            x {metres(x)} m, y {metres(y)} m
          </span>
          {origin ? <span>{earthText(onEarth(origin, x, y))}</span> : null}
        </>
      ) : (
        <span>Point at the plan for a place; press a track to select it.</span>
      )}
    </p>
  );
}

function keyOf({ plan, size }: LiveView, palette: Palette): KeyMark[] {
  if (!plan) return [];
  const seconds = arrowSeconds(plan, 1 / metresPerPixel(plan.camera, size));
  const seen = new Set(fading(plan).map((scan) => scan.sensor));
  return [
    { name: "confirmed", color: palette.track, look: "solid", symbol: "circle" },
    { name: "coasted", color: palette.track, look: "solid", symbol: "emptyCircle" },
    { name: "tentative", color: palette.tentative, look: "solid", symbol: "emptyCircle" },
    ...(plan.moment?.tracks.some((track) => track.existence !== undefined)
      ? [{ name: "existence", color: palette.track, look: "dot", symbol: "ring" } as KeyMark]
      : []),
    ...(seconds
      ? [{ name: `velocity, ${number(seconds)} s`, color: palette.text, look: "solid" } as KeyMark]
      : []),
    ...plan.sensors
      .filter((sensor) => seen.has(sensor.sensor_id))
      .map(
        ({ sensor_id }): KeyMark => ({
          name: `detections, ${sensor_id}`,
          color: sensorColor(plan.sensors, sensor_id, palette),
          look: "dot",
          symbol: "rect",
        }),
      ),
  ];
}

function PlanKey(props: { view: LiveView; marks: (palette: Palette) => KeyMark[] }): JSX.Element {
  return (
    <div class="strip-tools">
      <Key marks={props.marks} />
      <label class="inline">
        Trail
        <select
          value={param("trail") ?? ""}
          onChange={(event) => setParams({ trail: event.currentTarget.value })}
        >
          <option value="">all that is kept</option>
          {[10, 30, 100].map((points) => (
            <option value={String(points)}>{points} points</option>
          ))}
        </select>
      </label>
    </div>
  );
}

/** What is drawn, a row a point, whatever it is. */
function tableOf({ plan }: LiveView): TableData {
  const rows: TableData["rows"] = [];
  for (const track of plan?.moment?.tracks ?? []) {
    const time = plan?.moment?.time ?? null;
    rows.push(["track", track.id, time, track.x ?? null, track.y ?? null, track.status]);
  }
  for (const scan of plan ? fading(plan) : [])
    for (const [at, x] of scan.x.entries())
      rows.push([
        "detection",
        scan.sensor,
        scan.time,
        x,
        scan.y[at] ?? null,
        `scan ${scan.number}`,
      ]);
  return { columns: ["layer", "id", "time_s", "x_m", "y_m", "detail"], rows };
}
