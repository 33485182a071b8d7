// The legend of the plan view; each entry is a switch for its layer.

import type { JSX } from "preact";
import type { SensorSettings } from "../api/types";
import { param, setParams } from "../state/url";
import { detectionSymbol, drawnDetections, type Moment } from "./plan-series";
import type { Scene } from "./scene";

interface Entry {
  layer: string;
  name: string;
  mark: JSX.Element;
}

const MARKS: Record<string, string> = {
  circle: "M12 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6Z",
  rect: "M9 5h6v6H9Z",
  triangle: "m12 4.5 3.6 6.5H8.4Z",
  diamond: "m12 4 4 4-4 4-4-4Z",
  pin: "M12 12.5C10 10 9 8.5 9 7a3 3 0 0 1 6 0c0 1.5-1 3-3 5.5Z",
};

function stroke(kind: string, path: string): JSX.Element {
  return (
    <svg class={`mark ${kind}`} viewBox="0 0 24 16" aria-hidden="true">
      <path d={path} />
    </svg>
  );
}

function entries({ scene, sensors, hasGate, moment }: LegendProps): Entry[] {
  const marks = scene.clouds.map((cloud, order) => ({
    layer: `d:${cloud.sensor}`,
    name: `detections, ${cloud.sensor}`,
    mark: stroke(
      `mark-sensor-${(order % 5) + 1}`,
      MARKS[detectionSymbol(drawnDetections(cloud, moment), order)] ?? "",
    ),
  }));
  const list: Entry[] = [];
  if (scene.truths.size)
    list.push({ layer: "truth", name: "truth", mark: stroke("mark-truth", "M1 8h22") });
  if (sensors.some((sensor) => sensor.max_range_m))
    list.push({ layer: "rings", name: "sensor range", mark: stroke("mark-ring", "M1 8h22") });
  const ofTracks = scene.locals.length ? "system tracks" : "tracks";
  if (scene.tracks.size)
    list.push({ layer: "tracks", name: ofTracks, mark: stroke("mark-track", "M1 8h22") });
  if (hasGate)
    list.push({ layer: "gate", name: "gate", mark: stroke("mark-gate mark-dashed", "M1 8h22") });
  const locals = scene.locals.map(({ sensor }, order) => ({
    layer: `l:${sensor}`,
    name: `tracks of ${sensor}`,
    mark: stroke(`mark-local mark-local-${(order % 5) + 1} mark-dash-${order % 3}`, "M1 8h22"),
  }));
  return [...list, ...locals, ...marks];
}

interface LegendProps {
  scene: Scene;
  sensors: SensorSettings[];
  hasGate: boolean;
  moment: Moment;
}

export function Legend(props: LegendProps): JSX.Element {
  const { scene } = props;
  const hidden = (param("hide") ?? "").split(",").filter(Boolean);
  const toggle = (layer: string) => {
    const next = hidden.includes(layer)
      ? hidden.filter((name) => name !== layer)
      : [...hidden, layer];
    setParams({ hide: next.join(",") });
  };
  return (
    <div class="legend" role="group" aria-label="Layers">
      {entries(props).map((entry) => (
        <button
          type="button"
          class="legend-entry"
          aria-pressed={!hidden.includes(entry.layer)}
          onClick={() => toggle(entry.layer)}
        >
          {entry.mark}
          {entry.name}
        </button>
      ))}
      {scene.tracks.size && !scene.locals.length ? (
        <span class="legend-note">
          {stroke("mark-track mark-dashed", "M1 8h22")} coasted{" "}
          {stroke("mark-tentative", "M1 8h22")} tentative
        </span>
      ) : null}
    </div>
  );
}
