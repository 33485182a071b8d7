// What stands under the plan on its clock: the ribbons of the selected tracks, and the map of all.

import type { JSX } from "preact";
import { getAssociationMap, getTrackProbability } from "../api/client";
import { type Job, partsOf, type Report } from "../api/types";
import { type Story, storyOf } from "../charts/association";
import type { Cause } from "../charts/causes";
import { reducedBadge } from "../charts/frame";
import { KeptTracks, keptTracks, Ribbons, useRibbons } from "../charts/ribbons";
import { TrackMap } from "../charts/track-map";
import { Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { Clock } from "../state/clock";
import { param, setParams } from "../state/url";
import { thresholdsOf } from "./thresholds";

/** Ribbons at once. */
const MOST_RIBBONS = 8;

interface Told {
  story: Story;
  badge: string | undefined;
}

const told = new Map<string, Promise<Told>>();
const MOST_TOLD = 24;

/** What a job says of a track never changes: the last few are kept. */
function storyFrom(jobId: string, track: string): Promise<Told> {
  const key = `${jobId} ${track}`;
  const asked = told.get(key) ?? ask(jobId, track);
  told.delete(key);
  told.set(key, asked);
  asked.catch(() => told.delete(key));
  for (const oldest of [...told.keys()].slice(0, -MOST_TOLD)) told.delete(oldest);
  return asked;
}

async function ask(jobId: string, track: string): Promise<Told> {
  const series = await getTrackProbability(jobId, track);
  return {
    story: storyOf(track, series),
    badge: reducedBadge([{ ...series, name: `candidates of track ${track}` }]),
  };
}

export interface Stories {
  told: Told[] | undefined;
  error?: unknown;
  reload(): void;
  /** Of the selected track. */
  selected: Story | undefined;
}

/** The stories of the tracks that are kept and of the selected one, which stands first. */
export function useStories(jobId: string, hasTracks: boolean): Stories {
  const track = param("track");
  const names = hasTracks
    ? [...new Set([...(track === null ? [] : [track]), ...keptTracks()])].slice(0, MOST_RIBBONS)
    : [];
  const asked = useResource(
    () => Promise.all(names.map((name) => storyFrom(jobId, name))),
    [jobId, names.join("\u0000")],
  );
  const found = asked.data?.find(({ story }) => story.track === track)?.story;
  return { told: asked.data, error: asked.error, reload: asked.reload, selected: found };
}

interface Props {
  job: Job;
  report: Report;
  clock: Clock;
  stories: Stories;
  causes: Cause[];
}

export function Strips({ job, report, clock, stories, causes }: Props): JSX.Element | null {
  const map = useResource(() => getAssociationMap(job.id), [job.id]);
  const shown = useRibbons(
    stories.told?.map(({ story }) => story).filter((story) => story.steps.length > 0),
    causes,
  );
  const file = job.id.slice(-12);
  const badges = stories.told?.flatMap(({ badge }) => badge ?? []) ?? [];
  const isOfLocals = partsOf(report).tuples !== undefined;
  if (isOfLocals) return null;
  return (
    <div class="pictures-under">
      {stories.error ? <ProblemBox error={stories.error} retry={stories.reload} /> : null}
      {param("track") !== null && !stories.told ? <Loading what="probabilities" /> : null}
      {shown.length ? (
        <Ribbons
          ribbons={shown}
          clock={clock}
          thresholds={thresholdsOf(report)}
          file={`probability-${shown.map(({ story }) => story.track).join("-")}-${file}`}
          badge={badges.join("; ") || undefined}
          choose={({ story }) => setParams({ track: story.track })}
        />
      ) : null}
      <KeptTracks selected={shown.length ? param("track") : null} />
      {map.error ? <ProblemBox error={map.error} retry={map.reload} /> : null}
      {map.data ? <TrackMap map={map.data} clock={clock} file={file} /> : null}
    </div>
  );
}
