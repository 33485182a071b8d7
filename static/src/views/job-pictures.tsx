// The pictures of a job under one clock and one selection: the plan view, what is selected, its
// probabilities.

import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import {
  getArtifactText,
  getBearingTime,
  getDataset,
  getDatasetText,
  getGates,
  getPlan,
  getPlanOfTrack,
  getPlanWindow,
  listArtifacts,
} from "../api/client";
import {
  type Artifact,
  type BearingTime,
  type Job,
  type Plan,
  partsOf,
  type Report,
} from "../api/types";
import { bearingScene } from "../charts/bearing-scene";
import { BearingTimeChart } from "../charts/bearing-time";
import { type Cause, readCauses } from "../charts/causes";
import { ClockBar } from "../charts/clock-bar";
import { heightScene } from "../charts/height-scene";
import { HeightTimeChart } from "../charts/height-time";
import { type Levels, readLevels } from "../charts/levels";
import { ModesChart } from "../charts/modes";
import { PlanView } from "../charts/plan-view";
import { type LocalPoint, memberName, type Scene, sceneOf } from "../charts/scene";
import { isWhole, withMore } from "../charts/whole";
import { Empty, Link, Loading, ProblemBox } from "../components/basics";
import { type CsvTable, parseCsv, reader } from "../components/csv";
import { useResource } from "../components/resource";
import { capital, plural } from "../format";
import { type Boxes, boxesOf } from "../state/boxes";
import { type Clock, createClock } from "../state/clock";
import { hereHref, param } from "../state/url";
import { Selection, TupleNote } from "./selection";
import { Strips, useStories } from "./strips";
import { Why } from "./why";

const MOST_LOCAL_POINTS = 50_000;

interface Drawn {
  plan: Plan;
  locals: LocalPoint[];
  /** Of jobs that know directions. */
  bearings: BearingTime | undefined;
  levels: Levels | undefined;
  /** Whether the job left a picture of its bearing-time record. */
  hasRecord: boolean;
  boxes: Boxes;
}

/** Larger records are looked at in the picture that the service draws. */
const MOST_RECORD_BYTES = 30e6;

/** The record that the job made or read, where it is a table of a size for a browser. */
async function levelsOf(job: Job, report: Report, files: Artifact[]): Promise<Levels | undefined> {
  const made = files.find((file) => file.name === "bearing_time.csv");
  if (made)
    return made.bytes <= MOST_RECORD_BYTES
      ? readLevels(await getArtifactText(job.id, made.name))
      : undefined;
  const read = report.inputs.find((input) => input.role === "bearing_time")?.dataset_id;
  if (!read) return undefined;
  const set = await getDataset(read);
  return set.format === "csv" && set.bytes <= MOST_RECORD_BYTES
    ? readLevels(await getDatasetText(read))
    : undefined;
}

const RECORD = "record.svg";

/** The plan, and the tracks that were put together where the job did that. */
async function load(job: Job, report: Report): Promise<Drawn> {
  const ofLocals = job.kind === "correlate" ? getArtifactText(job.id, "local_tracks.csv") : "";
  const [plan, locals, boxes] = await Promise.all([getPlan(job.id), ofLocals, boxesOf(report)]);
  const hasBearings = plan.notes.length > 0 || plan.detections.columns.x_m.some((x) => x === null);
  const [bearings, files] = hasBearings
    ? await Promise.all([getBearingTime(job.id), listArtifacts(job.id)])
    : [undefined, []];
  const levels = await levelsOf(job, report, files).catch(() => undefined);
  const hasRecord = files.some((file) => file.name === RECORD);
  return {
    plan,
    locals: localPoints(parseCsv(locals, MOST_LOCAL_POINTS)),
    bearings,
    levels,
    hasRecord,
    boxes,
  };
}

function localPoints(table: CsvTable): LocalPoint[] {
  const field = (name: string) => reader(table, name);
  const [time, sensor, track, x, y] = [
    field("time_s"),
    field("sensor_id"),
    field("track_id"),
    field("x_m"),
    field("y_m"),
  ];
  return table.rows.map((row) => ({
    time: Number(time(row)),
    sensor: sensor(row),
    track: track(row),
    x: Number(x(row)),
    y: Number(y(row)),
  }));
}

function membersOf(report: Report): Map<string, Set<string>> {
  const { tuples = [], sensors = [] } = partsOf(report);
  const names = (tracks: (string | null)[]) =>
    tracks.flatMap((track, index) =>
      track === null ? [] : [memberName(sensors[index]?.sensor_id ?? "", track)],
    );
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
  const { tfa, association } = partsOf(report);
  const models = (association?.models ?? []).map((line) => line.model);
  const base = useMemo(() => sceneOf(plan, locals, membersOf(report)), [plan]);
  const clock = useMemo(() => createClock(base.times, base.numbers), [base]);
  const scene = useWholeScene(job, plan, base, clock);
  const directions = useMemo(() => (bearings ? bearingScene(bearings) : undefined), [bearings]);
  const heights = useMemo(() => heightScene(plan), [plan]);
  const hasPlaces = scene.truths.size + scene.tracks.size + scene.clouds.length > 0;
  const track = param("track");
  const gated = track && scene.tracks.has(track) && !locals.length ? track : undefined;
  const gates = useResource(
    async () => (gated ? getGates(job.id, gated) : undefined),
    [job.id, gated, base],
  ).data;
  const causes = useCauses(job, report);
  useEffect(() => clock.dispose, [clock]);
  const hasTracks =
    scene.tracks.size + (directions?.tracks.size ?? 0) > 0 && job.kind !== "correlate";
  const stories = useStories(job.id, hasTracks);
  if (!scene.times.length) return <Nothing boxes={drawn.boxes} report={report} />;
  const notes = [
    ...boxNotes(drawn.boxes),
    ...plan.notes.map((note) => noteText(note, bearings !== undefined)),
  ];
  return (
    <div class={`pictures${track && hasTracks ? " with-ribbons" : ""}`}>
      <div class="pictures-main">
        {bearings && directions ? (
          <BearingTimeChart
            jobId={job.id}
            series={bearings}
            scene={directions}
            clock={clock}
            levels={drawn.levels}
          />
        ) : null}
        {bearings && !hasPlaces ? null : (
          <PlanView
            jobId={job.id}
            plan={plan}
            scene={scene}
            clock={clock}
            gates={gates}
            notes={notes}
          />
        )}
        <ClockBar clock={clock} />
        {hasTracks ? (
          <Strips job={job} report={report} clock={clock} stories={stories} causes={causes} />
        ) : null}
        {heights ? <HeightTimeChart jobId={job.id} scene={heights} clock={clock} /> : null}
        {drawn.hasRecord ? <RecordPicture id={job.id} /> : null}
      </div>
      <aside class="pictures-side" aria-label="Selection">
        <Selection
          scene={scene}
          directions={directions}
          clock={clock}
          tfa={tfa}
          gates={gates}
          maxMissed={maxMissedOf(report)}
        />
        <TupleNote report={report} />
        <Why
          scene={scene}
          clock={clock}
          story={stories.selected}
          causes={causes}
          gates={gates}
          maxMissed={maxMissedOf(report)}
        />
        {models.length && track ? (
          <ModesChart jobId={job.id} track={track} models={models} clock={clock} />
        ) : null}
      </aside>
    </div>
  );
}

const NO_CAUSES: Cause[] = [];

/** Why things happened, of jobs that explained their events. */
function useCauses(job: Job, report: Report): Cause[] {
  const areThere = partsOf(report).events?.causes !== undefined;
  const read = async () =>
    areThere ? readCauses(await getArtifactText(job.id, "causes.csv")) : NO_CAUSES;
  return useResource(read, [job.id]).data ?? NO_CAUSES;
}

/** Scans before the clock that are fetched whole. */
const WHOLE_SCANS = 5;

/**
 * The scene; where the plan holds but a part of the points, with all of the selected track and of
 * the last scans up to the clock, as soon as the clock rests.
 */
function useWholeScene(job: Job, plan: Plan, base: Scene, clock: Clock): Scene {
  const isPart = useMemo(() => job.kind !== "correlate" && !isWhole(plan), [plan]);
  const track = param("track");
  const index = clock.playing.value ? -1 : clock.index.value;
  const ofTrack = useResource(
    async () => (isPart && track !== null ? getPlanOfTrack(job.id, track) : undefined),
    [job.id, track, isPart],
  ).data;
  const from = base.times[Math.max(index - WHOLE_SCANS + 1, 0)];
  const to = base.times[index];
  const ofScans = useResource(
    async () =>
      isPart && from !== undefined && to !== undefined
        ? getPlanWindow(job.id, from, to)
        : undefined,
    [job.id, from, to, isPart],
  ).data;
  return useMemo(
    () =>
      ofTrack || ofScans
        ? { ...sceneOf(withMore(plan, [ofTrack, ofScans])), extent: base.extent }
        : base,
    [base, ofTrack, ofScans],
  );
}

/** Misses in a row that end a track, as the request says. */
function maxMissedOf(report: Report): number | undefined {
  const { max_missed } = ((report.spec as Record<string, unknown>).tracker ?? {}) as {
    max_missed?: number;
  };
  return max_missed;
}

function boxNotes(boxes: Boxes): string[] {
  const kinds = [
    boxes.truths ? plural(boxes.truths, "truth") : "",
    boxes.tracks ? plural(boxes.tracks, "track") : "",
  ].filter(Boolean);
  return kinds.length
    ? [`${kinds.join(" and ")} of boxes in a video: boxes are not drawn in this view.`]
    : [];
}

/** What the service says of its answers, as people need it who look at the pictures. */
function noteText(note: string, hasBearings: boolean): string {
  const of = /^the (truth|tracks) are directions/.exec(note)?.[1];
  if (!of || !hasBearings) return capital(note);
  return of === "truth"
    ? "The truth is directions: the bearing–time picture shows it."
    : "The tracks are directions: the bearing–time picture shows them.";
}

/** A job without a place and a scan; of a video it says what there is and where that is told. */
function Nothing({ boxes, report }: { boxes: Boxes; report: Report }): JSX.Element {
  const [note] = boxNotes(boxes);
  if (!note) return <Empty title="There is nothing to draw: no scan, no truth, no track." />;
  return (
    <Empty title={note}>
      {partsOf(report).metrics ? (
        <p>
          <Link href={hereHref({ tab: "metrics" })}>The metrics tab</Link> shows which track
          followed which target when, and every event.
        </p>
      ) : null}
    </Empty>
  );
}

const RECORD_TEXT =
  "Bearing-time record: levels as shades, time downwards, with detections and tracks over it";

/** The levels of the record, as the service drew them once. */
function RecordPicture({ id }: { id: string }): JSX.Element {
  const address = `/v1/jobs/${encodeURIComponent(id)}/artifacts/${RECORD}`;
  return (
    <details class="panel record">
      <summary>The record as the service drew it</summary>
      <a href={address} target="_blank" rel="noreferrer">
        <img src={address} loading="lazy" alt={RECORD_TEXT} />
      </a>
    </details>
  );
}
