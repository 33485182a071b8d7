// What is chosen in the pictures of a job: a truth, a track, how its verdict was decided, how its tuple was made.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { partsOf, type Gates, type Report, type TargetVerdict, type Tfa } from "../api/types";
import { timeText } from "../charts/axes";
import type { BearingScene } from "../charts/bearing-scene";
import { gatesAt, innovationWords } from "../charts/gates";
import { at, type Scene } from "../charts/scene";
import { Icon, Link, type IconName } from "../components/basics";
import { metres, number } from "../format";
import type { Clock } from "../state/clock";
import { hereHref, param, setParams } from "../state/url";
import { placeOf, sentence } from "./verdicts";

/** Beyond this many the names are found by typing: a list of thousands takes long to make and longer to read. */
const LISTED_UP_TO = 500;
const SUGGESTED = 50;

function Find({ name, label, ids }: { name: "track" | "truth"; label: string; ids: string[] }): JSX.Element {
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
        onChange={(event) => setParams({ [name]: event.currentTarget.value }, "push")}
      />
      <datalist id={`ids-${name}`}>
        {suggested.map((id) => (
          <option value={id} />
        ))}
      </datalist>
    </label>
  );
}

function Pick({ name, label, ids }: { name: "track" | "truth"; label: string; ids: string[] }): JSX.Element {
  if (ids.length > LISTED_UP_TO) return <Find name={name} label={label} ids={ids} />;
  return (
    <label>
      <span>{label}</span>
      <select value={param(name) ?? ""} onChange={(event) => setParams({ [name]: event.currentTarget.value }, "push")}>
        <option value="">none of {ids.length}</option>
        {ids.map((id) => (
          <option value={id}>{id}</option>
        ))}
      </select>
    </label>
  );
}

function verdictOf(tfa: Tfa | undefined, truth: string | null, track: string | null): TargetVerdict | undefined {
  if (truth) return tfa?.targets.find((target) => target.truth_id === truth);
  return track ? tfa?.targets.find((target) => (target.track_id ?? target.matched_track_id) === track) : undefined;
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
}

export function Selection({ scene, directions, clock, tfa, gates }: SelectionProps): JSX.Element {
  const track = param("track");
  const [truths, tracks] = [new Set([...scene.truths.keys(), ...(directions?.truths.keys() ?? [])]), new Set([...scene.tracks.keys(), ...(directions?.tracks.keys() ?? [])])];
  const verdict = verdictOf(tfa, param("truth"), track);
  return (
    <section class="panel selection">
      <h2>Selection</h2>
      <div class="filters">
        {truths.size ? <Pick name="truth" label="Truth" ids={[...truths]} /> : null}
        {tracks.size ? <Pick name="track" label="Track" ids={[...tracks]} /> : null}
      </div>
      {track ? directions?.tracks.has(track) ? <BearingFacts scene={directions} track={track} clock={clock} /> : <TrackFacts scene={scene} track={track} clock={clock} gates={gates} /> : null}
      {verdict ? <VerdictNote verdict={verdict} /> : null}
      {tfa ? <Failures tfa={tfa} current={verdict} /> : null}
    </section>
  );
}

function TrackFacts({ scene, track, clock, gates }: { scene: Scene; track: string; clock: Clock; gates: Gates | undefined }): JSX.Element {
  const line = scene.tracks.get(track);
  if (!line) return <p class="muted">There is no track {track} here.</p>;
  const here = at(line, clock.time.value);
  const index = here?.index ?? 0;
  const covariance = line.covariance[index];
  const born = (line.time[0] ?? Infinity) <= clock.time.value;
  const [first, last] = [timeText(line.time[0] ?? 0, scene.times), timeText(line.time.at(-1) ?? 0, scene.times)];
  return (
    <dl class="facts">
      <dt>Life</dt>
      <dd>
        {first} to {last}
      </dd>
      <dt>Status</dt>
      <dd>{born ? line.status[index] : "not born yet"}</dd>
      <dt>Position</dt>
      <dd>{born && here ? `${metres(here.x)}, ${metres(here.y)} m` : "–"}</dd>
      <dt>1σ east, north</dt>
      <dd>{born && covariance ? `${metres(Math.sqrt(covariance[0]))}, ${metres(Math.sqrt(covariance[2]))} m` : "–"}</dd>
      {gatesAt(gates, track, clock.time.value).map((row) => (
        <>
          <dt>Gate</dt>
          <dd>
            d² ≤ {number(gates?.threshold)}
            <span class="sub">innovation 1σ {gates ? innovationWords(gates, row, metres) : ""}</span>
          </dd>
        </>
      ))}
      {scene.locals.length ? null : (
        <>
          <dt>Detection</dt>
          <dd class="mono">{born ? (line.detection[index] ?? "none (ε)") : "–"}</dd>
        </>
      )}
    </dl>
  );
}

function BearingFacts({ scene, track, clock }: { scene: BearingScene; track: string; clock: Clock }): JSX.Element | null {
  const line = scene.tracks.get(track);
  if (!line) return null;
  const row = line.time.findLastIndex((time) => time <= clock.time.value + 1e-9);
  const value = (column: (number | null)[], unit: string) => (row < 0 || column[row] === null ? "–" : `${number(column[row])}${unit}`);
  return (
    <dl class="facts">
      <dt>Life</dt>
      <dd>
        {timeText(line.time[0] ?? 0, clock.times)} to {timeText(line.time.at(-1) ?? 0, clock.times)}
      </dd>
      <dt>Bearing</dt>
      <dd>{row < 0 ? "not born yet" : value(line.bearing, "°")}</dd>
      <dt>Rate</dt>
      <dd>{value(line.rate, "°/s")}</dd>
      <dt>1σ</dt>
      <dd>{value(line.sigma, "°")}</dd>
      <dt>Detection</dt>
      <dd class="mono">{row < 0 ? "–" : (line.detection[row] ?? "none (ε)")}</dd>
    </dl>
  );
}

function VerdictNote({ verdict }: { verdict: TargetVerdict }): JSX.Element {
  return (
    <div class="verdict-note">
      <p>
        <span class={`badge verdict-${verdict.verdict}`}>
          <Icon name={verdict.verdict as IconName} />
          {verdict.verdict}
        </span>{" "}
        <b>{verdict.truth_id}</b>
      </p>
      <p>{sentence(verdict)}</p>
      <button type="button" class="quiet" onClick={() => setParams(placeOf(verdict), "push")}>
        <Icon name="fit" /> Show where it was decided
      </button>
    </div>
  );
}

/** Steps through the targets that were not followed correctly, without going back to the table. */
function Failures({ tfa, current }: { tfa: Tfa; current: TargetVerdict | undefined }): JSX.Element | null {
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
      <span class="muted">{index < 0 ? `${failures.length} failures` : `failure ${index + 1} of ${failures.length}`}</span>
      <button type="button" onClick={show(index + 1)}>
        Next
      </button>
    </div>
  );
}
