// The pictures of a job under one clock and one selection: the plan view, what is selected, its probabilities.

import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { getArtifactText, getBearingTime, getDataset, getDatasetText, getPlan, listArtifacts } from "../api/client";
import { partsOf, type Artifact, type BearingTime, type Job, type Plan, type Report, type TargetVerdict, type Tfa } from "../api/types";
import { timeText } from "../charts/axes";
import { bearingScene, type BearingScene } from "../charts/bearing-scene";
import { BearingTimeChart } from "../charts/bearing-time";
import { ClockBar } from "../charts/clock-bar";
import { readLevels, type Levels } from "../charts/levels";
import { PlanView } from "../charts/plan-view";
import { ProbabilityChart } from "../charts/probability";
import { at, memberName, sceneOf, type LocalPoint, type Scene } from "../charts/scene";
import { Empty, Icon, Loading, ProblemBox, type IconName } from "../components/basics";
import { parseCsv, reader, type CsvTable } from "../components/csv";
import { useResource } from "../components/resource";
import { metres, number } from "../format";
import { createClock, type Clock } from "../state/clock";
import { param, setParams } from "../state/url";
import { placeOf, sentence } from "./verdicts";

const MOST_LOCAL_POINTS = 50_000;

interface Drawn {
  plan: Plan;
  locals: LocalPoint[];
  /** Of jobs that know directions. */
  bearings: BearingTime | undefined;
  levels: Levels | undefined;
  /** Whether the job left a picture of its bearing-time record. */
  hasRecord: boolean;
}

/** Larger records are looked at in the picture that the service draws. */
const MOST_RECORD_BYTES = 30e6;

/** The record that the job made or read, where it is a table of a size for a browser. */
async function levelsOf(job: Job, report: Report, files: Artifact[]): Promise<Levels | undefined> {
  const made = files.find((file) => file.name === "bearing_time.csv");
  if (made) return made.bytes <= MOST_RECORD_BYTES ? readLevels(await getArtifactText(job.id, made.name)) : undefined;
  const read = report.inputs.find((input) => input.role === "bearing_time")?.dataset_id;
  if (!read) return undefined;
  const set = await getDataset(read);
  return set.format === "csv" && set.bytes <= MOST_RECORD_BYTES ? readLevels(await getDatasetText(read)) : undefined;
}

const RECORD = "record.svg";

/** The plan, and the tracks that were put together where the job did that. */
async function load(job: Job, report: Report): Promise<Drawn> {
  const [plan, locals] = await Promise.all([getPlan(job.id), job.kind === "correlate" ? getArtifactText(job.id, "local_tracks.csv") : ""]);
  const hasBearings = plan.notes.length > 0 || plan.detections.columns.x_m.some((x) => x === null);
  const [bearings, files] = hasBearings ? await Promise.all([getBearingTime(job.id), listArtifacts(job.id)]) : [undefined, []];
  return { plan, locals: localPoints(parseCsv(locals, MOST_LOCAL_POINTS)), bearings, levels: await levelsOf(job, report, files).catch(() => undefined), hasRecord: files.some((file) => file.name === RECORD) };
}

function localPoints(table: CsvTable): LocalPoint[] {
  const [time, sensor, track, x, y] = ["time_s", "sensor_id", "track_id", "x_m", "y_m"].map((name) => reader(table, name)) as [CellReader, CellReader, CellReader, CellReader, CellReader];
  return table.rows.map((row) => ({ time: Number(time(row)), sensor: sensor(row), track: track(row), x: Number(x(row)), y: Number(y(row)) }));
}

type CellReader = (row: string[]) => string;

function membersOf(report: Report): Map<string, Set<string>> {
  const { tuples = [], sensors = [] } = partsOf(report);
  const names = (tracks: (string | null)[]) => tracks.flatMap((track, index) => (track === null ? [] : [memberName(sensors[index]?.sensor_id ?? "", track)]));
  return new Map(tuples.map((tuple) => [tuple.system_track_id, new Set(names(tuple.tracks))]));
}

export function JobPictures({ job, report }: { job: Job; report: Report }): JSX.Element {
  const drawn = useResource(() => load(job, report), [job.id]);
  if (drawn.error) return <ProblemBox error={drawn.error} retry={drawn.reload} />;
  if (!drawn.data) return <Loading what="the plan" />;
  return <Pictures job={job} drawn={drawn.data} report={report} />;
}

function Pictures({ job, drawn, report }: { job: Job; drawn: Drawn; report: Report }): JSX.Element {
  const { plan, locals, bearings } = drawn;
  const { tfa } = partsOf(report);
  const scene = useMemo(() => sceneOf(plan, locals, membersOf(report)), [plan]);
  const clock = useMemo(() => createClock(scene.times, scene.numbers), [scene]);
  const directions = useMemo(() => (bearings ? bearingScene(bearings) : undefined), [bearings]);
  const hasPlaces = scene.truths.size + scene.tracks.size + scene.clouds.length > 0;
  useEffect(() => clock.dispose, [clock]);
  if (!scene.times.length) return <Empty title="There is nothing to draw: no scan, no truth, no track." />;
  return (
    <div class="pictures">
      <div class="pictures-main">
        {bearings && directions ? <BearingTimeChart jobId={job.id} series={bearings} scene={directions} clock={clock} levels={drawn.levels} /> : null}
        {bearings && !hasPlaces ? null : <PlanView jobId={job.id} plan={plan} scene={scene} clock={clock} />}
        <ClockBar clock={clock} />
        {drawn.hasRecord ? <RecordPicture id={job.id} /> : null}
      </div>
      <aside class="pictures-side" aria-label="Selection">
        <Selection scene={scene} directions={directions} clock={clock} tfa={tfa} />
        {(scene.tracks.size || directions?.tracks.size) && job.kind !== "correlate" ? <ProbabilityChart jobId={job.id} track={param("track")} clock={clock} /> : null}
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

/** The levels of the record, as the service drew them once. */
function RecordPicture({ id }: { id: string }): JSX.Element {
  const address = `/v1/jobs/${encodeURIComponent(id)}/artifacts/${RECORD}`;
  return (
    <details class="panel record">
      <summary>The record as the service drew it</summary>
      <a href={address} target="_blank" rel="noreferrer">
        <img src={address} loading="lazy" alt="Bearing-time record: levels as shades, time downwards, with detections and tracks over it" />
      </a>
    </details>
  );
}

interface SelectionProps {
  scene: Scene;
  directions: BearingScene | undefined;
  clock: Clock;
  tfa: Tfa | undefined;
}

function Selection({ scene, directions, clock, tfa }: SelectionProps): JSX.Element {
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
      {track ? directions?.tracks.has(track) ? <BearingFacts scene={directions} track={track} clock={clock} /> : <TrackFacts scene={scene} track={track} clock={clock} /> : null}
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
