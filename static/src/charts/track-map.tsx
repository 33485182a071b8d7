// All tracks over all scans as one picture: the darker a cell, the less of the probability went to
// the track's own target (without truth: to the chosen detection), in the colour of where it went.

import type { JSX } from "preact";
import { useMemo, useRef, useState } from "preact/hooks";
import type { AssociationMap, AssociationMapRow } from "../api/types";
import type { TableData } from "../components/table";
import { count, probability } from "../format";
import type { Clock } from "../state/clock";
import { type Palette, readPalette, theme } from "../state/theme";
import { param, setParams } from "../state/url";
import { timeText } from "../times";
import { NO_EVENT } from "./event-moment";
import { ChartFrame } from "./frame";
import { Key, type KeyMark } from "./marks";
import { Painted, type Spot } from "./painted";
import type { Painting } from "./pen";
import { AroundChoice, around } from "./ribbons";
import { type Band, bandOf, scanAt } from "./time-band";
import { MAP_TOP, mapPainting, rowAt, rowPixels } from "./track-map-paint";

const AT_ONCE = 1500;

/** The rows in the order that was asked for. */
function ordered(map: AssociationMap): AssociationMapRow[] {
  if (param("rows") !== "born") return map.rows;
  return map.rows.toSorted((a, b) => (a.at[0] ?? 0) - (b.at[0] ?? 0));
}

export function mapKey(originsKnown: boolean, palette: Palette): KeyMark[] {
  const area = (name: string, color: string): KeyMark => ({ name, color, look: "area" });
  const clutter = palette.sensors[0] ?? palette.text;
  return originsKnown
    ? [
        area("own target", palette.tentative),
        area("another target", palette.selected),
        area("clutter", clutter),
        area("none (ε)", palette.strongLine),
      ]
    : [
        area("chosen detection", palette.tentative),
        area("others", palette.selected),
        area("none (ε)", palette.strongLine),
      ];
}

interface Props {
  map: AssociationMap;
  clock: Clock;
  file: string;
}

export function TrackMap({ map, clock, file }: Props): JSX.Element | null {
  const latest = useRef<Painting | undefined>(undefined);
  const [tip, setTip] = useState<TipPlace | undefined>(undefined);
  const sorted = useMemo(() => ordered(map), [map, param("rows")]);
  const rows = sorted.slice(0, AT_ONCE);
  void theme.value;
  const palette = readPalette();
  if (!rows.length) return null;
  const paint = (width: number): Painting => {
    const band = bandOf(clock, width, around());
    const chosen = param("track");
    const moment = { now: clock.time.value, origin: clock.origin, chosen };
    latest.current = mapPainting({ map, rows, band, width, palette, ...moment });
    return latest.current;
  };
  const press = (at: Spot, width: number) => {
    const row = rows[rowAt(at.y, rows.length)];
    clock.playing.value = false;
    clock.seek(scanAt(clock, bandOf(clock, width, around()), at.x));
    if (row) setParams({ ...NO_EVENT, track: row.track_id, truth: row.truth_id }, "push");
  };
  const point = (at: Spot | undefined, width: number) =>
    setTip(at && tipPlace(map, rows, clock, at, bandOf(clock, width, around()), width));
  const key = (of: Palette) => mapKey(map.origins_known, of);
  const shown = rows.length < map.source_tracks;
  const badge = shown
    ? `Shown: ${count(rows.length)} of ${count(map.source_tracks)} tracks`
    : undefined;
  const label =
    `Probability of ${rows.length} tracks over ${clock.times.length} scans, a row a track. ` +
    "The table shows the same numbers.";
  return (
    <ChartFrame
      title="All tracks"
      file={`tracks-${file}`}
      badge={badge}
      table={() => tableOf(map, rows, clock.origin)}
      chart={() => latest.current}
      pictureKey={key}
      tools={
        <div class="strip-tools">
          <Key marks={key} />
          <Order />
          <AroundChoice clock={clock} />
        </div>
      }
      class="track-map"
    >
      <div class="track-map-scroll" tabIndex={0} role="region" aria-label="All tracks over time">
        <div class="tip-box">
          <Painted label={label} painting={paint} press={press} point={point} />
          {tip ? <Tip {...tip} origin={clock.origin} isKnown={map.origins_known} /> : null}
        </div>
      </div>
    </ChartFrame>
  );
}

function Order(): JSX.Element {
  return (
    <label class="inline">
      Rows
      <select
        value={param("rows") ?? ""}
        onChange={(event) => setParams({ rows: event.currentTarget.value })}
      >
        <option value="">the worst first</option>
        <option value="born">in order of birth</option>
      </select>
    </label>
  );
}

interface TipPlace {
  x: number;
  y: number;
  flip: boolean;
  row: AssociationMapRow;
  at: number;
  time: number;
}

function tipPlace(
  map: AssociationMap,
  rows: AssociationMapRow[],
  clock: Clock,
  at: Spot,
  band: Band,
  width: number,
): TipPlace | undefined {
  if (at.x < band.left || at.x > band.right || at.y < MAP_TOP) return undefined;
  if (at.y > MAP_TOP + rows.length * rowPixels(rows.length)) return undefined;
  const row = rows[rowAt(at.y, rows.length)];
  const time = clock.times[scanAt(clock, band, at.x)] ?? NaN;
  const place = row?.at.findIndex((each) => Math.abs((map.time_s[each] ?? 0) - time) < 1e-6) ?? -1;
  if (!row || place < 0) return undefined;
  return { ...at, flip: at.x > width / 2, row, at: place, time };
}

function sharesOf(row: AssociationMapRow, at: number): [number, number, number, number] {
  const [own, other, clutter] = [row.own[at] ?? 0, row.other[at] ?? 0, row.clutter[at] ?? 0];
  const none = Math.max(1000 - own - other - clutter, 0);
  return [own / 1000, other / 1000, clutter / 1000, none / 1000];
}

function Tip({
  x,
  y,
  flip,
  row,
  at,
  time,
  origin,
  isKnown,
}: TipPlace & { origin: number; isKnown: boolean }): JSX.Element {
  const place = flip ? { right: `calc(100% - ${x - 14}px)` } : { left: `${x + 14}px` };
  const [own, other, clutter, none] = sharesOf(row, at);
  const lines: [string, number][] = isKnown
    ? [
        [`own target ${row.truth_id ?? ""}`, own],
        ["other targets", other],
        ["clutter", clutter],
        ["none (ε)", none],
      ]
    : [
        ["chosen", own],
        ["others", other],
        ["none (ε)", none],
      ];
  return (
    <div class="strip-tip" style={{ ...place, top: `${Math.max(y - 20, 0)}px` }} aria-hidden="true">
      <b>
        track {row.track_id}, {timeText(time, origin)}
      </b>
      <table>
        <tbody>
          {lines.map(([name, share]) => (
            <tr>
              <td>{name}</td>
              <td class="num">{probability(share)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function tableOf(map: AssociationMap, rows: AssociationMapRow[], origin_s: number): TableData {
  const lines = rows.flatMap((row) =>
    row.at.map((place, at) => [
      map.time_s[place] ?? null,
      row.track_id,
      row.truth_id,
      ...sharesOf(row, at),
    ]),
  );
  const shares = map.origins_known
    ? ["own_target", "other_targets", "clutter", "none"]
    : ["chosen", "others", "clutter", "none"];
  return { columns: ["time_s", "track_id", "own_truth_id", ...shares], rows: lines, origin_s };
}
