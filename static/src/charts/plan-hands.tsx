// What hands do to a plan besides the pointer: buttons and keys that zoom, pan, and take the ruler.

import type { JSX } from "preact";
import { Icon } from "../components/basics";
import { param, setParams } from "../state/url";
import { type Camera, zoomed } from "./camera";

/** A plan that can be moved. */
export interface Looks {
  look(): Camera;
  move(to: Camera): void;
  fitAll(): void;
}

interface ZoomProps {
  view: Looks;
  isMeasuring: boolean;
}

export function ZoomButtons({ view, isMeasuring }: ZoomProps): JSX.Element {
  const zoom = (factor: number) => () => view.move(zoomed(view.look(), factor));
  return (
    <div class="plan-zoom">
      <button type="button" aria-label="Zoom in" onClick={zoom(1 / 1.5)}>
        <Icon name="plus" />
      </button>
      <button type="button" aria-label="Zoom out" onClick={zoom(1.5)}>
        <Icon name="minus" />
      </button>
      <button type="button" aria-label="Show everything" onClick={() => view.fitAll()}>
        <Icon name="fit" />
      </button>
      <button
        type="button"
        aria-label="Ruler"
        aria-pressed={isMeasuring}
        title="Distance and bearing between two points"
        onClick={takeRuler}
      >
        <Icon name="ruler" />
      </button>
    </div>
  );
}

/** Takes the ruler, or puts it away. */
function takeRuler(): void {
  setParams({ ruler: param("ruler") === null ? "on" : null });
}

const PAN_BY: Record<string, [number, number]> = {
  ArrowLeft: [-0.1, 0],
  ArrowRight: [0.1, 0],
  ArrowUp: [0, 0.1],
  ArrowDown: [0, -0.1],
};

export function planKeys(event: KeyboardEvent, view: Looks): void {
  const camera = view.look();
  const by = event.shiftKey ? PAN_BY[event.key] : undefined;
  if (by)
    view.move({
      ...camera,
      x: camera.x + by[0] * camera.span,
      y: camera.y + by[1] * camera.span,
    });
  else if (event.key === "+" || event.key === "=") view.move(zoomed(camera, 1 / 1.5));
  else if (event.key === "-") view.move(zoomed(camera, 1.5));
  else if (event.key === "0") view.fitAll();
  else if (event.key === "r" && !event.ctrlKey && !event.metaKey) takeRuler();
  else if (event.key === "Escape" && param("ruler") !== null) setParams({ ruler: null });
  else return;
  event.preventDefault();
  event.stopPropagation();
}
