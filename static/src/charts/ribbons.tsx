// The ribbons of the selected tracks, under the plan and on its clock: where the probability of
// each went, scan by scan.

import type { JSX } from "preact";
import { useMemo, useRef, useState } from "preact/hooks";
import { Icon } from "../components/basics";
import type { TableData } from "../components/table";
import { probability } from "../format";
import type { Clock } from "../state/clock";
import { type Palette, readPalette, theme } from "../state/theme";
import { param, setParams } from "../state/url";
import { timeText } from "../times";
import { originWords, partsOf, type Step, type Story } from "./association";
import { ChartFrame } from "./frame";
import { Key } from "./marks";
import { Painted, type Spot } from "./painted";
import type { Painting } from "./pen";
import {
  hasExistence,
  partColor,
  type Ribbon,
  ribbonAt,
  ribbonKey,
  ribbonPainting,
  type Threshold,
  targetColors,
} from "./ribbon-paint";
import { type Band, bandOf, scanAt } from "./time-band";

interface Props {
  ribbons: Ribbon[];
  clock: Clock;
  thresholds: Threshold[];
  /** Begins the name of saved files. */
  file: string;
  title?: string;
  badge?: string | undefined;
  /** A press chooses this track, too. */
  choose?: (ribbon: Ribbon) => void;
}

export const namesOf = (ribbons: Ribbon[]): string =>
  ribbons.map(({ story }) => story.track).join(" and ");

/** Scans about the clock that the strips show; all when 0. */
export const around = (): number => Math.max(Number(param("around")) || 0, 0);

const AROUND = [20, 50, 100, 200, 500];

export function AroundChoice({ clock }: { clock: Clock }): JSX.Element {
  const shown = AROUND.filter((scans) => scans < clock.times.length - 1);
  return (
    <label class="inline">
      Shown
      <select
        value={param("around") ?? ""}
        onChange={(event) => setParams({ around: event.currentTarget.value })}
      >
        <option value="">all scans</option>
        {shown.map((scans) => (
          <option value={String(scans)}>{scans} around the clock</option>
        ))}
      </select>
    </label>
  );
}

export function Ribbons(props: Props): JSX.Element {
  const { ribbons, clock, thresholds, file, badge, choose } = props;
  const [tip, setTip] = useState<TipPlace | undefined>(undefined);
  const latest = useRef<Painting | undefined>(undefined);
  void theme.value;
  const palette = readPalette();
  const paint = (width: number): Painting => {
    const band = bandOf(clock, width, around());
    const moment = { now: clock.time.value, origin: clock.origin };
    latest.current = ribbonPainting({ ribbons, band, width, thresholds, palette, ...moment });
    return latest.current;
  };
  const press = (at: Spot, width: number) => {
    const ribbon = ribbons[ribbonAt(at.y, ribbons.length)];
    clock.playing.value = false;
    clock.seek(scanAt(clock, bandOf(clock, width, around()), at.x));
    if (ribbon) choose?.(ribbon);
  };
  const point = (at: Spot | undefined, width: number) =>
    setTip(at && tipPlace(props, at, bandOf(clock, width, around()), width));
  const key = (of: Palette) => ribbonKey(ribbons, thresholds, of);
  const title = props.title ?? `Association probability, ${namesOf(ribbons)}`;
  const scans = ribbons.reduce((sum, { story }) => sum + story.steps.length, 0);
  const label =
    `Association probability of track ${namesOf(ribbons)} over time, ${scans} scans. ` +
    "The table shows the same numbers.";
  return (
    <ChartFrame
      title={title}
      file={file}
      badge={badge}
      table={() => tableOf(ribbons, clock.origin)}
      chart={() => latest.current}
      pictureKey={key}
      tools={
        <div class="strip-tools">
          <Key marks={key} />
          <AroundChoice clock={clock} />
        </div>
      }
      class="ribbons"
    >
      <div class="tip-box">
        <Painted
          class="probability-canvas"
          label={label}
          painting={paint}
          press={press}
          point={point}
        />
        {tip ? <Tip {...tip} ribbons={ribbons} palette={palette} origin={clock.origin} /> : null}
      </div>
    </ChartFrame>
  );
}

interface TipPlace {
  x: number;
  y: number;
  flip: boolean;
  ribbon: Ribbon;
  step: Step;
}

function tipPlace(
  { ribbons, clock }: Props,
  at: Spot,
  band: Band,
  width: number,
): TipPlace | undefined {
  if (at.x < band.left || at.x > band.right) return undefined;
  const ribbon = ribbons[ribbonAt(at.y, ribbons.length)];
  const time = clock.times[scanAt(clock, band, at.x)];
  const step = ribbon?.story.steps.find((each) => Math.abs(each.time - (time ?? NaN)) < 1e-6);
  if (!ribbon || !step) return undefined;
  return { ...at, flip: at.x > width / 2, ribbon, step };
}

const TIP_CANDIDATES = 10;

function Tip({
  x,
  y,
  flip,
  ribbon,
  step,
  ribbons,
  palette,
  origin,
}: TipPlace & { ribbons: Ribbon[]; palette: Palette; origin: number }): JSX.Element {
  const { story } = ribbon;
  const colors = targetColors(
    ribbons.map((each) => each.story),
    palette,
  );
  const shown = step.candidates.slice(0, TIP_CANDIDATES);
  const sum = step.candidates.reduce((total, entry) => total + entry.probability, 0);
  const colorOf = (index: number) => {
    const alone = { ...step, candidates: [step.candidates[index]].filter((each) => !!each) };
    const [part] = partsOf(story, alone);
    return (
      part &&
      partColor(index > 0 && !story.originsKnown ? asOther(part) : part, story.own, colors, palette)
    );
  };
  const place = flip ? { right: `calc(100% - ${x - 14}px)` } : { left: `${x + 14}px` };
  return (
    <div class="strip-tip" style={{ ...place, top: `${Math.max(y - 20, 0)}px` }} aria-hidden="true">
      <b>
        track {story.track}, {timeText(step.time, origin)}
      </b>{" "}
      <span class="muted">{step.status}</span>
      <table>
        <tbody>
          {shown.map((entry, index) => (
            <tr>
              <td>
                <span class="swatch" style={{ background: colorOf(index) }} />
                {entry.detection ?? "none (ε)"}
              </td>
              <td class="muted">{entry.detection === null ? "" : originWords(story, entry)}</td>
              <td class="num">{probability(entry.probability)}</td>
            </tr>
          ))}
          <tr>
            <td>sum</td>
            <td class="muted">
              {step.candidates.length > shown.length
                ? `${step.candidates.length - shown.length} more`
                : ""}
            </td>
            <td class="num">{probability(sum)}</td>
          </tr>
          {step.existence === null ? null : (
            <tr>
              <td colSpan={2}>existence</td>
              <td class="num">{probability(step.existence)}</td>
            </tr>
          )}
        </tbody>
      </table>
    </div>
  );
}

/** Beside the chosen detection every other one is one of the others. */
const asOther = <P extends { kind: string }>(part: P): P =>
  part.kind === "chosen" ? { ...part, kind: "others" } : part;

function rowsOf({ story }: Ribbon, withExistence: boolean): (string | number | null)[][] {
  return story.steps.flatMap((step) =>
    step.candidates.map((entry) => [
      step.time,
      story.track,
      step.status || null,
      entry.detection,
      entry.truth,
      entry.probability,
      originWords(story, entry),
      step.nis,
      ...(withExistence ? [step.existence] : []),
    ]),
  );
}

function tableOf(ribbons: Ribbon[], origin_s: number): TableData {
  const withExistence = ribbons.some(({ story }) => hasExistence(story));
  const columns = ["time_s", "track_id", "status", "detection_id", "truth_id", "probability"];
  columns.push("what", "nis", ...(withExistence ? ["existence"] : []));
  return {
    columns,
    rows: ribbons.flatMap((ribbon) => rowsOf(ribbon, withExistence)),
    origin_s,
  };
}

/** The tracks whose ribbons stay while others are selected. */
export const keptTracks = (): string[] => {
  const text = param("kept");
  return text ? text.split(",").map(decodeURIComponent) : [];
};

export function keepTracks(tracks: string[]): void {
  setParams({ kept: tracks.map(encodeURIComponent).join(",") });
}

/** What stays when another track is selected. */
export function KeptTracks({ selected }: { selected: string | null }): JSX.Element | null {
  const kept = keptTracks();
  const canKeep = selected !== null && !kept.includes(selected);
  const drop = (track: string) => () => keepTracks(kept.filter((each) => each !== track));
  if (!canKeep && !kept.length) return null;
  return (
    <p class="kept-tracks">
      {canKeep ? (
        <button type="button" class="quiet" onClick={() => keepTracks([...kept, selected])}>
          <Icon name="plus" /> Keep track {selected} while others are selected
        </button>
      ) : null}
      {kept.map((track) => (
        <button
          type="button"
          class="quiet"
          aria-label={`Let go of track ${track}`}
          onClick={drop(track)}
        >
          <Icon name="close" /> {track}
        </button>
      ))}
    </p>
  );
}

export function useRibbons(stories: Story[] | undefined, causes: Ribbon["causes"]): Ribbon[] {
  return useMemo(() => (stories ?? []).map((story) => ({ story, causes })), [stories, causes]);
}
