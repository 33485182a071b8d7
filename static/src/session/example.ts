// Commands that begin a session and push its first scan, made of its own settings.

import type { Session } from "./api";

type Known = { sensor_id: string } & Record<string, unknown>;

/** A detection as the sensor reports it, which follows from its noises. */
function detectionOf(sensor: Known): Record<string, number> {
  const knows = (name: string) => sensor[name] !== undefined && sensor[name] !== null;
  if (knows("sigma_x_m"))
    return { x_m: 1200, y_m: 800, ...(knows("sigma_z_m") ? { z_m: 300 } : {}) };
  return {
    ...(knows("sigma_range_m") ? { range_m: 1500 } : {}),
    bearing_deg: 45,
    ...(knows("sigma_elevation_deg") ? { elevation_deg: 5 } : {}),
  };
}

function command(path: string, body: object): string {
  return [
    "curl -sS -H 'content-type: application/json' \\",
    `  ${location.origin}${path} \\`,
    `  -d '${JSON.stringify(body).replaceAll("'", "'\\''")}'`,
  ].join("\n");
}

export function pushExample(session: Session): string {
  const [sensor] = (session.request.sensors ?? []) as Known[];
  if (!sensor) return "";
  const time_s = Math.floor(Date.now() / 1000);
  const scan = { sensor_id: sensor.sensor_id, time_s, detections: [detectionOf(sensor)] };
  return command(`/v1/sessions/${session.id}/scans`, scan);
}

export function beginExample(): string {
  const radar = {
    sensor_id: "radar",
    sigma_x_m: 20,
    sigma_y_m: 20,
    p_d: 0.9,
    clutter_per_m2: 1e-8,
  };
  const tracker = { initial_speed_sigma_mps: 10 };
  return command("/v1/sessions", { name: "harbour", sensors: [radar], tracker });
}
