// What the page keeps of a live session: the ways of its tracks, the scans, and what was believed
// at each picture, so that one can look back. All of it is bounded.

import type { LiveTrack, Picture } from "./api";

/** A track as it was believed to be at one time. */
export interface Belief {
  id: string;
  status: string;
  existence: number | undefined;
  x: number | undefined;
  y: number | undefined;
  vx: number;
  vy: number;
  /** Of the place. */
  covariance: [number, number, number] | undefined;
  /** Of a session that tracks directions. */
  bearing: number | undefined;
  bearingRate: number | undefined;
  started: number;
  detected: number;
  detections: number;
  lat: number | undefined;
  lon: number | undefined;
}

export interface Way {
  time: number[];
  x: number[];
  y: number[];
}

export interface Seen {
  number: number;
  sensor: string;
  time: number;
  from: [number, number] | undefined;
  x: number[];
  y: number[];
  bearing: number[];
}

/** What was believed at the time of a picture. */
export interface Moment {
  time: number;
  scan: number;
  tracks: Belief[];
}

const MOST_MOMENTS = 600;
const MOST_BELIEFS = 60_000;
const MOST_SCANS = 600;
const MOST_DETECTIONS = 60_000;
const WAY_POINTS = 256;
/** Ended tracks whose ways are kept. */
const MOST_ENDED = 200;

function beliefOf(track: LiveTrack): Belief {
  const { covariance: all } = track;
  const size = (Math.sqrt(8 * all.length + 1) - 1) / 2;
  const [xx, xy, yy] = [all[0], all[1], all[size]];
  const isKnown = xx !== undefined && xy !== undefined && yy !== undefined;
  return {
    id: track.track_id,
    status: track.status,
    existence: track.existence,
    x: track.x_m,
    y: track.y_m,
    vx: track.vx_mps ?? 0,
    vy: track.vy_mps ?? 0,
    covariance: isKnown && track.x_m !== undefined ? [xx, xy, yy] : undefined,
    bearing: track.bearing_deg,
    bearingRate: track.bearing_rate_degps,
    started: track.started_s,
    detected: track.detected_s,
    detections: track.detections,
    lat: track.lat_deg,
    lon: track.lon_deg,
  };
}

/** Takes away what is at or after a time. */
function cut(way: Way, time: number): void {
  while (way.time.length && (way.time.at(-1) ?? 0) >= time) {
    way.time.pop();
    way.x.pop();
    way.y.pop();
  }
}

export class Memory {
  readonly ways = new Map<string, Way>();
  readonly moments: Moment[] = [];
  readonly scans: Seen[] = [];
  private beliefs = 0;
  private detections = 0;

  take(picture: Picture): void {
    for (const scan of picture.scans) this.addScan(scan);
    this.trimScans();
    for (const { track_id, time_s, x_m, y_m } of picture.ways ?? [])
      if (time_s.length) this.ways.set(track_id, { time: time_s, x: x_m, y: y_m });
    if (picture.processed_to_s === undefined) return;
    const tracks = picture.tracks.map(beliefOf);
    this.addMoment({ time: picture.processed_to_s, scan: picture.last_scan, tracks });
    for (const track of tracks) this.lengthen(track, picture.processed_to_s);
    this.forgetEnded(tracks);
  }

  /** The newest moment not after a time; the latest where none is given. */
  at(time: number | undefined): Moment | undefined {
    if (time === undefined) return this.moments.at(-1);
    return this.moments.findLast((moment) => moment.time <= time) ?? this.moments[0];
  }

  private addScan(scan: Picture["scans"][number]): void {
    const { number, sensor_id: sensor, time_s: time, x_m: x, y_m: y, bearing_deg } = scan;
    if (this.scans.some((other) => other.number === number)) return;
    const from =
      scan.sensor_x_m !== undefined && scan.sensor_y_m !== undefined
        ? ([scan.sensor_x_m, scan.sensor_y_m] as [number, number])
        : undefined;
    // Late ones find their place by their time.
    const place = this.scans.findLastIndex((other) => other.time <= time) + 1;
    this.scans.splice(place, 0, { number, sensor, time, from, x, y, bearing: bearing_deg });
    this.detections += x.length + bearing_deg.length;
  }

  private trimScans(): void {
    while (this.scans.length > MOST_SCANS || this.detections > MOST_DETECTIONS) {
      const oldest = this.scans.shift();
      this.detections -= oldest ? oldest.x.length + oldest.bearing.length : this.detections;
    }
  }

  /** In the place of what was believed at this time and later, which late scans may change. */
  private addMoment(moment: Moment): void {
    while ((this.moments.at(-1)?.time ?? -Infinity) >= moment.time)
      this.beliefs -= this.moments.pop()?.tracks.length ?? 0;
    this.moments.push(moment);
    this.beliefs += moment.tracks.length;
    while (
      this.moments.length > MOST_MOMENTS ||
      (this.beliefs > MOST_BELIEFS && this.moments.length > 1)
    )
      this.beliefs -= this.moments.shift()?.tracks.length ?? 0;
  }

  private lengthen({ id, x, y }: Belief, time: number): void {
    if (x === undefined || y === undefined) return;
    const way = this.ways.get(id) ?? { time: [], x: [], y: [] };
    cut(way, time);
    way.time.push(time);
    way.x.push(x);
    way.y.push(y);
    if (way.time.length > WAY_POINTS) for (const column of [way.time, way.x, way.y]) column.shift();
    this.ways.set(id, way);
  }

  private forgetEnded(living: Belief[]): void {
    const surplus = this.ways.size - living.length - MOST_ENDED;
    if (surplus <= 0) return;
    const lives = new Set(living.map((track) => track.id));
    const ended = [...this.ways.keys()].filter((id) => !lives.has(id));
    for (const id of ended.slice(0, surplus)) this.ways.delete(id);
  }
}

/** Metres a second, and degrees clockwise from north. */
export function motionOf({ vx, vy }: Belief): { speed: number; course: number } {
  const course = (Math.atan2(vx, vy) * 180) / Math.PI;
  return { speed: Math.hypot(vx, vy), course: (course + 360) % 360 };
}
