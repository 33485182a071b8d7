// The pictures of a job under one clock and one selection: the plan view, what is selected, its probabilities.

import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { getPlan } from "../api/client";
import type { Job, Plan, TargetVerdict, Tfa } from "../api/types";
import { timeText } from "../charts/axes";
import { ClockBar } from "../charts/clock-bar";
import { PlanView } from "../charts/plan-view";
import { ProbabilityChart } from "../charts/probability";
import { at, sceneOf, type Scene } from "../charts/scene";
import { Empty, Icon, Loading, ProblemBox, type IconName } from "../components/basics";
import { useResource } from "../components/resource";
import { metres } from "../format";
import { createClock, type Clock } from "../state/clock";
import { param, setParams } from "../state/url";
import { placeOf, sentence } from "./verdicts";

export function JobPictures({ job, tfa }: { job: Job; tfa: Tfa | undefined }): JSX.Element {
  const plan = useResource(() => getPlan(job.id), [job.id]);
  if (plan.error) return <ProblemBox error={plan.error} retry={plan.reload} />;
  if (!plan.data) return <Loading what="the plan" />;
  return <Pictures job={job} plan={plan.data} tfa={tfa} />;
}

function Pictures({ job, plan, tfa }: { job: Job; plan: Plan; tfa: Tfa | undefined }): JSX.Element {
  const scene = useMemo(() => sceneOf(plan), [plan]);
  const clock = useMemo(() => createClock(scene.times, scene.numbers), [scene]);
  useEffect(() => clock.dispose, [clock]);
  if (!scene.times.length) return <Empty title="There is nothing to draw: no scan, no truth, no track." />;
  return (
    <div class="pictures">
      <div class="pictures-main">
        <PlanView jobId={job.id} plan={plan} scene={scene} clock={clock} />
        <ClockBar clock={clock} />
      </div>
      <aside class="pictures-side" aria-label="Selection">
        <Selection scene={scene} clock={clock} tfa={tfa} />
        {scene.tracks.size ? <ProbabilityChart jobId={job.id} track={param("track")} clock={clock} /> : null}
      </aside>
    </div>
  );
}

function Pick({ name, label, ids }: { name: "track" | "truth"; label: string; ids: string[] }): JSX.Element {
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

function Selection({ scene, clock, tfa }: { scene: Scene; clock: Clock; tfa: Tfa | undefined }): JSX.Element {
  const track = param("track");
  const verdict = verdictOf(tfa, param("truth"), track);
  return (
    <section class="panel selection">
      <h2>Selection</h2>
      <div class="filters">
        {scene.truths.size ? <Pick name="truth" label="Truth" ids={[...scene.truths.keys()]} /> : null}
        {scene.tracks.size ? <Pick name="track" label="Track" ids={[...scene.tracks.keys()]} /> : null}
      </div>
      {track ? <TrackFacts scene={scene} track={track} clock={clock} /> : null}
      {verdict ? <VerdictNote verdict={verdict} /> : null}
      {tfa ? <Failures tfa={tfa} current={verdict} /> : null}
    </section>
  );
}

function TrackFacts({ scene, track, clock }: { scene: Scene; track: string; clock: Clock }): JSX.Element {
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
      <dt>Detection</dt>
      <dd class="mono">{born ? (line.detection[index] ?? "none (ε)") : "–"}</dd>
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
