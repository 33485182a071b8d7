// What is chosen in the pictures of a job: a truth, a track, how its verdict was decided, how its
// tuple was made.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { type Gates, partsOf, type Report, type TargetVerdict, type Tfa } from "../api/types";
import type { BearingScene } from "../charts/bearing-scene";
import { addressedEvent, eventSentence, NO_EVENT } from "../charts/event-moment";
import { gatesAt, innovationWords } from "../charts/gates";
import { at, hasEnded, isAlive, missesAtEnd, type Scene, type TrackLine } from "../charts/scene";
import { Icon, type IconName, Link } from "../components/basics";
import { Time } from "../components/time";
import { capital, metres, number, plural, words } from "../format";
import type { Clock } from "../state/clock";
import { hereHref, param, setParams } from "../state/url";
import { timeText } from "../times";
import { placeOf, sentence } from "./verdicts";

/**
 * Beyond this many the names are found by typing: a list of thousands takes long to make and longer
 * to read.
 */
const LISTED_UP_TO = 500;
const SUGGESTED = 50;

function Find({
  name,
  label,
  ids,
}: {
  name: "track" | "truth";
  label: string;
  ids: string[];
}): JSX.Element {
  const chosen = param(name) ?? "";
  const [text, setText] = useState(chosen);
  useEffect(() => setText(chosen), [chosen]);
  const suggested = ids.filter((id) => id.includes(text)).slice(0, SUGGESTED);
  return (
    <label>
      <span>{label}</span>
      <input
        type="search"
        list={`ids-${name}`}
        value={text}
        placeholder={`one of ${ids.length}`}
        onInput={(event) => setText(event.currentTarget.value)}
        onChange={(event) => setParams({ ...NO_EVENT, [name]: event.currentTarget.value }, "push")}
      />
      <datalist id={`ids-${name}`}>
        {suggested.map((id) => (
          <option value={id} />
        ))}
      </datalist>
    </label>
  );
}

function Pick({
  name,
  label,
  ids,
}: {
  name: "track" | "truth";
  label: string;
  ids: string[];
}): JSX.Element {
  if (ids.length > LISTED_UP_TO) return <Find name={name} label={label} ids={ids} />;
  return (
    <label>
      <span>{label}</span>
      <select
        value={param(name) ?? ""}
        onChange={(event) => setParams({ ...NO_EVENT, [name]: event.currentTarget.value }, "push")}
      >
        <option value="">none of {ids.length}</option>
        {ids.map((id) => (
          <option value={id}>{id}</option>
        ))}
      </select>
    </label>
  );
}

function verdictOf(
  tfa: Tfa | undefined,
  truth: string | null,
  track: string | null,
): TargetVerdict | undefined {
  if (truth) return tfa?.targets.find((target) => target.truth_id === truth);
  return track
    ? tfa?.targets.find((target) => (target.track_id ?? target.matched_track_id) === track)
    : undefined;
}

/** How the chosen system track was put together. */
export function TupleNote({ report }: { report: Report }): JSX.Element | null {
  const { tuples = [], sensors = [] } = partsOf(report);
  const tuple = tuples.find((entry) => entry.system_track_id === param("track"));
  if (!tuple) return null;
  return (
    <section class="panel">
      <h2>
        Tuple {tuple.system_track_id}{" "}
        {tuple.right === undefined ? null : (
          <span class={`badge verdict-${tuple.right ? "correct" : "missed"}`}>
            <Icon name={tuple.right ? "correct" : "false"} /> {tuple.right ? "right" : "wrong"}
          </span>
        )}
      </h2>
      <dl class="facts">
        {tuple.tracks.map((track, index) => (
          <>
            <dt>Track of {sensors[index]?.sensor_id}</dt>
            <dd class={track === null ? "absent-track" : "mono"}>{track ?? "absent"}</dd>
          </>
        ))}
        <dt>Cost</dt>
        <dd>{number(tuple.cost)}</dd>
        <dt>p-value</dt>
        <dd>{number(tuple.p_value)}</dd>
      </dl>
      <p class="small">
        <Link href={hereHref({ tab: "correlation" })}>All tuples</Link>
      </p>
    </section>
  );
}

interface SelectionProps {
  scene: Scene;
  directions: BearingScene | undefined;
  clock: Clock;
  tfa: Tfa | undefined;
  gates: Gates | undefined;
  /** Misses in a row that end a track, where the request says so. */
  maxMissed: number | undefined;
}

const idsOf = (one: Map<string, unknown>, other: Map<string, unknown> | undefined) => [
  ...new Set([...one.keys(), ...(other?.keys() ?? [])]),
];

export function Selection({
  scene,
  directions,
  clock,
  tfa,
  gates,
  maxMissed,
}: SelectionProps): JSX.Element {
  const track = param("track");
  const [truths, tracks] = [
    idsOf(scene.truths, directions?.truths),
    idsOf(scene.tracks, directions?.tracks),
  ];
  const verdict = verdictOf(tfa, param("truth"), track);
  const line = scene.tracks.get(track ?? "");
  return (
    <section class="panel selection">
      <h2>Selection</h2>
      <div class="filters">
        {truths.length ? <Pick name="truth" label="Truth" ids={truths} /> : null}
        {tracks.length ? <Pick name="track" label="Track" ids={tracks} /> : null}
      </div>
      {track && directions?.tracks.has(track) ? (
        <BearingFacts scene={directions} track={track} clock={clock} />
      ) : null}
      {line ? (
        <TrackFacts scene={scene} line={line} clock={clock} gates={gates} maxMissed={maxMissed} />
      ) : null}
      {track && !line && !directions?.tracks.has(track) ? (
        <p class="muted">There is no track {track} here.</p>
      ) : null}
      <EventNote clock={clock} />
      {verdict ? <VerdictNote verdict={verdict} isAlive={speaksThen(scene, verdict)} /> : null}
      {tfa ? <Failures tfa={tfa} current={verdict} /> : null}
    </section>
  );
}

/** Whether the track that speaks for a target lives when it went wrong. */
function speaksThen(scene: Scene, { track_id, at_time_s }: TargetVerdict): boolean | undefined {
  const line = scene.tracks.get(track_id ?? "");
  return line && typeof at_time_s === "number" ? isAlive(scene, line, at_time_s) : undefined;
}

/** The event that was followed here, as long as the clock stands at it. */
function EventNote({ clock }: { clock: Clock }): JSX.Element | null {
  const event = addressedEvent();
  const text = event && eventSentence(event);
  if (!event || !text || Math.abs(event.time - clock.time.value) > 1e-6) return null;
  return (
    <div class="verdict-note">
      <p>
        <b>{capital(words(event.kind))}</b> at <Time at={event.time} origin={clock.origin} />
      </p>
      <p>{text}</p>
    </div>
  );
}

/**
 * How a track ended: the misses at its end, and the one that was too many where the request names
 * as many.
 */
function endText(line: TrackLine, maxMissed: number | undefined): string {
  const misses = missesAtEnd(line);
  if (misses === 0) return "";
  if (maxMissed === misses + 1) return ` (${maxMissed} misses)`;
  return ` (no detection in its last ${plural(misses, "scan")})`;
}

interface TrackFactsProps {
  scene: Scene;
  line: TrackLine;
  clock: Clock;
  gates: Gates | undefined;
  maxMissed: number | undefined;
}

function TrackFacts(props: TrackFactsProps): JSX.Element {
  const { scene, line, clock, maxMissed } = props;
  const { origin } = clock;
  const [first, last] = [line.time[0] ?? 0, line.time.at(-1) ?? 0];
  const ended = hasEnded(scene, line, clock.time.value);
  return (
    <dl class={`facts${ended ? " ended" : ""}`}>
      <dt>Life</dt>
      <dd>
        <Time at={first} origin={origin} /> to <Time at={last} origin={origin} />
      </dd>
      <dt>Status</dt>
      {ended ? (
        <dd>{`ended at ${timeText(last, origin)}${endText(line, maxMissed)}`}</dd>
      ) : (
        <LivingFacts {...props} />
      )}
    </dl>
  );
}

/** Where a track is, and what it has there. */
function LivingFacts({ scene, line, clock, gates }: TrackFactsProps): JSX.Element {
  const here = at(line, clock.time.value);
  if (!here || (line.time[0] ?? Infinity) > clock.time.value + 1e-9) return <dd>not born yet</dd>;
  const covariance = line.covariance[here.index];
  return (
    <>
      <dd>{line.status[here.index]}</dd>
      <dt>Position</dt>
      <dd>{`${metres(here.x)}, ${metres(here.y)} m`}</dd>
      <dt>1σ east, north</dt>
      <dd>
        {covariance
          ? `${metres(Math.sqrt(covariance[0]))}, ${metres(Math.sqrt(covariance[2]))} m`
          : "–"}
      </dd>
      {gatesAt(gates, line.id, clock.time.value).map((row) => (
        <>
          <dt>Gate</dt>
          <dd>
            d² ≤ {number(gates?.threshold)}
            <span class="sub">
              innovation 1σ {gates ? innovationWords(gates, row, metres) : ""}
            </span>
          </dd>
        </>
      ))}
      {scene.locals.length ? null : (
        <>
          <dt>Detection</dt>
          <dd class="mono">{line.detection[here.index] ?? "none (ε)"}</dd>
        </>
      )}
    </>
  );
}

function BearingFacts({
  scene,
  track,
  clock,
}: {
  scene: BearingScene;
  track: string;
  clock: Clock;
}): JSX.Element | null {
  const line = scene.tracks.get(track);
  if (!line) return null;
  const { origin } = clock;
  const now = clock.time.value;
  const [first, last] = [line.time[0] ?? 0, line.time.at(-1) ?? 0];
  const row = line.time.findLastIndex((time) => time <= now + 1e-9);
  const status =
    row < 0 ? "not born yet" : last < now - 1e-9 ? `ended at ${timeText(last, origin)}` : undefined;
  const value = (column: (number | null)[], unit: string) =>
    column[row] === null ? "–" : `${number(column[row])}${unit}`;
  return (
    <dl class="facts">
      <dt>Life</dt>
      <dd>
        <Time at={first} origin={origin} /> to <Time at={last} origin={origin} />
      </dd>
      {status ? (
        <>
          <dt>Status</dt>
          <dd>{status}</dd>
        </>
      ) : (
        <>
          <dt>Bearing</dt>
          <dd>{value(line.bearing, "°")}</dd>
          <dt>Rate</dt>
          <dd>{value(line.rate, "°/s")}</dd>
          <dt>1σ</dt>
          <dd>{value(line.sigma, "°")}</dd>
          <dt>Detection</dt>
          <dd class="mono">{line.detection[row] ?? "none (ε)"}</dd>
        </>
      )}
    </dl>
  );
}

function VerdictNote({
  verdict,
  isAlive,
}: {
  verdict: TargetVerdict;
  isAlive: boolean | undefined;
}): JSX.Element {
  return (
    <div class="verdict-note">
      <p>
        <span class={`badge verdict-${verdict.verdict}`}>
          <Icon name={verdict.verdict as IconName} />
          {verdict.verdict}
        </span>{" "}
        <b>{verdict.truth_id}</b> <span class="muted">in the automaton</span>
      </p>
      <p>{sentence(verdict, isAlive)}</p>
      <button type="button" class="quiet" onClick={() => setParams(placeOf(verdict), "push")}>
        <Icon name="fit" /> Show where it was decided
      </button>
    </div>
  );
}

/** Steps through the targets that were not followed correctly, without going back to the table. */
function Failures({
  tfa,
  current,
}: {
  tfa: Tfa;
  current: TargetVerdict | undefined;
}): JSX.Element | null {
  const failures = tfa.targets.filter((target) => target.verdict !== "correct");
  if (!failures.length) return null;
  const index = current ? failures.indexOf(current) : -1;
  const show = (to: number) => () => {
    const target = failures[(to + failures.length) % failures.length];
    if (target) setParams(placeOf(target), "push");
  };
  return (
    <div class="failures" role="group" aria-label="Failures">
      <button type="button" onClick={show(index < 0 ? -1 : index - 1)}>
        Previous
      </button>
      <span class="muted">
        {index < 0
          ? plural(failures.length, "failure")
          : `failure ${index + 1} of ${failures.length}`}
      </span>
      <button type="button" onClick={show(index + 1)}>
        Next
      </button>
    </div>
  );
}
