// The plan view: truth, detections and tracks from above, at the clock's moment, with one scale on
// both axes.

import { useComputed, useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { Plan } from "../api/types";
import { count, plural } from "../format";
import { theme } from "../state/theme";
import { param } from "../state/url";
import { timeText } from "../times";
import { type Camera, toText } from "./camera";
import { ChartCanvas } from "./chart";
import type { Density } from "./density";
import { ChartFrame, reducedBadge } from "./frame";
import { gatesAt } from "./gates";
import { Legend } from "./legend";
import { momentOf, PlanDrawing, type PlanViewProps } from "./plan-drawing";
import { planKeys, ZoomButtons } from "./plan-hands";
import { drawnTable, pictureKey } from "./plan-table";
import { type Ruler, rulerText } from "./ruler";
import { RulerPanel } from "./ruler-panel";
import type { Scene } from "./scene";

const KEYS_TEXT =
  "plus and minus zoom, 0 shows everything, shift and arrows pan, r takes the ruler";

function labelOf(title: string, scene: Scene): string {
  const sizes = [
    plural(scene.truths.size, "truth line"),
    plural(scene.tracks.size, "track"),
    plural(scene.clouds.length, "sensor"),
  ];
  return `${title}: ${sizes.join(", ")}. The table shows the same points.`;
}

/** What is drawn of all that there is, where it is not all. */
function badgeOf(plan: Plan, density: Density | undefined, hasDots: boolean): string | undefined {
  const reduced = reducedBadge([
    { name: "truth", ...plan.truth },
    ...(hasDots ? [{ name: "detections", ...plan.detections }] : []),
    { name: "tracks", ...plan.tracks },
  ]);
  const dense = density && `density of all ${count(density.source_points)} detections`;
  return [reduced, dense].filter(Boolean).join("; ") || undefined;
}

/**
 * The camera of the address. Back, forward and jumps move the camera; what our own moves wrote does
 * not, also where the hand went on before this is told of it.
 */
function useAddress(drawing: PlanDrawing): string {
  const { camera } = drawing;
  const address = useComputed(() => `${param("centre") ?? ""} ${param("span") ?? ""}`).value;
  useEffect(() => {
    if (!drawing.isWritten()) return;
    const moved = camera.peek();
    const own = moved && toText(moved);
    if (!own || address !== `${own.centre} ${own.span}`) camera.value = undefined;
  }, [address]);
  return address;
}

export function PlanView(props: PlanViewProps): JSX.Element {
  const { plan, scene, clock, gates } = props;
  const camera = useSignal<Camera | undefined>(undefined);
  const stretched = useSignal<Ruler | undefined>(undefined);
  const drawing = useMemo(() => new PlanDrawing(props, camera, stretched), []);
  drawing.props = props;
  const box = useRef<HTMLDivElement>(null);
  const address = useAddress(drawing);
  useEffect(() => (box.current ? drawing.listen(box.current) : undefined), [drawing]);
  const moment = momentOf(clock);
  const title = `Plan view at ${timeText(moment.now, scene.origin)}`;
  const density = drawing.density(moment);
  const ruler = drawing.ruler();
  const content = { scene, gates, density };
  const gateCount = gatesAt(gates, moment.track, moment.now).length;
  const keys = [
    camera.value,
    moment.from,
    moment.now,
    param("hide"),
    moment.truth,
    moment.track,
    theme.value,
    address,
    ruler && rulerText(ruler),
    gateCount,
  ];
  return (
    <ChartFrame
      title="Plan view"
      file={`plan-${props.jobId.slice(-12)}`}
      badge={badgeOf(plan, density, drawing.hasDots(density))}
      table={() => drawnTable(content, momentOf(clock))}
      chart={() => drawing.chart}
      pictureKey={(palette) => pictureKey(content, moment, palette)}
      pictureTitle={title}
      tools={
        <Legend scene={scene} sensors={plan.sensors} hasGate={gateCount > 0} moment={moment} />
      }
      class="plan"
    >
      {props.notes.map((note) => (
        <p key={note} class="muted small frame-note">
          {note}
        </p>
      ))}
      {ruler ? <RulerPanel ruler={ruler} /> : null}
      <div class="plan-box">
        <div
          ref={box}
          class={ruler ? "plan-touch measuring" : "plan-touch"}
          tabIndex={0}
          role="group"
          aria-label={`Plan view; ${KEYS_TEXT}`}
          onKeyDown={(event) => planKeys(event, drawing)}
        >
          <ChartCanvas
            label={labelOf(title, scene)}
            keys={keys}
            draw={(chart) => drawing.draw(chart, moment)}
            class="plan-canvas"
          />
        </div>
        <ZoomButtons view={drawing} isMeasuring={ruler !== undefined} />
      </div>
    </ChartFrame>
  );
}
