// Latitude and longitude of a place in the plane of a session with an origin: the oblique
// stereographic projection of WGS 84 over a conformal sphere, undone (IOGP guidance note 7-2,
// method 9809, written with the isometric latitude).

const SEMI_MAJOR_M = 6_378_137;
const E2 = 0.006_694_379_990_141_316;
const E = Math.sqrt(E2);
const RAD = Math.PI / 180;
const ROUNDS = 10;

function isometric(lat: number): number {
  return Math.asinh(Math.tan(lat)) - E * Math.atanh(E * Math.sin(lat));
}

function fromIsometric(value: number): number {
  let conformal = value;
  for (let round = 0; round < ROUNDS; round++)
    conformal = value + E * Math.atanh(E * Math.tanh(conformal));
  return Math.atan(Math.sinh(conformal));
}

export interface Origin {
  lat_deg: number;
  lon_deg: number;
}

/** Degrees, of east and north in metres. */
export function onEarth(origin: Origin, x: number, y: number): { lat: number; lon: number } {
  const lat0 = origin.lat_deg * RAD;
  const stretch = Math.sqrt(1 + (E2 * Math.cos(lat0) ** 4) / (1 - E2));
  const sphere = Math.asin(Math.sin(lat0) / stretch);
  const radius = (Math.sqrt(1 - E2) * SEMI_MAJOR_M) / (1 - E2 * Math.sin(lat0) ** 2);
  const offset = Math.asinh(Math.tan(sphere)) - stretch * isometric(lat0);
  const distance = Math.hypot(x, y);
  const away = 2 * Math.atan(distance / (2 * radius));
  const [toEast, toNorth] = distance > 0 ? [x / distance, y / distance] : [0, 0];
  const up = Math.cos(away) * Math.sin(sphere) + toNorth * Math.sin(away) * Math.cos(sphere);
  const east = toEast * Math.sin(away);
  const out = Math.cos(away) * Math.cos(sphere) - toNorth * Math.sin(away) * Math.sin(sphere);
  const lat = fromIsometric((Math.asinh(up / Math.hypot(east, out)) - offset) / stretch);
  const lon = origin.lon_deg + Math.atan2(east, out) / stretch / RAD;
  return { lat: lat / RAD, lon: ((lon + 540) % 360) - 180 };
}

/** `63.43051° N, 10.39512° E`, to a metre. */
export function earthText({ lat, lon }: { lat: number; lon: number }): string {
  const [north, east] = [lat < 0 ? "S" : "N", lon < 0 ? "W" : "E"];
  return `${Math.abs(lat).toFixed(5)}° ${north}, ${Math.abs(lon).toFixed(5)}° ${east}`;
}
