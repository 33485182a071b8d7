// One live session: its picture as it is believed now, and what it became when it is closed.

import { type Signal, useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { asProblem, Empty, Icon, Link, Loading, ProblemBox } from "../components/basics";
import { Code } from "../components/code";
import { count, moment } from "../format";
import { closeSession, pauseSession, resumeSession, type Session } from "../session/api";
import { Confirm } from "../session/confirm";
import { pushExample } from "../session/example";
import { Follower } from "../session/follow";
import { LiveClock } from "../session/live-clock";
import { type LiveProps, PlanOfSession } from "../session/live-plan";
import { Counts, Events, Selected, SessionBadge, TrackTable } from "../session/parts";
import { pageHref } from "../state/url";

export function SessionPage({ id }: { id: string }): JSX.Element {
  const follower = useMemo(() => new Follower(id), [id]);
  const at = useSignal<number | undefined>(undefined);
  const error = useSignal<unknown>(undefined);
  useEffect(() => () => follower.stop(), [follower]);
  const session = follower.session.value;
  if (!session) return <Unknown follower={follower} />;
  return (
    <article>
      <Head session={session} follower={follower} error={error} />
      <BondNote follower={follower} />
      {error.value ? <ProblemBox error={error.value} /> : null}
      {session.state === "open" ? null : <Became session={session} />}
      <Live follower={follower} at={at} error={error} />
    </article>
  );
}

function Unknown({ follower }: { follower: Follower }): JSX.Element {
  const bond = follower.bond.value;
  if (bond === "asking") return <Loading what="the session" />;
  return (
    <>
      <h1>Session</h1>
      <ProblemBox error={follower.error.value} />
      {bond === "refused" ? null : <p role="status">It is asked for again.</p>}
      <Link href={pageHref({ view: "sessions" })}>All sessions</Link>
    </>
  );
}

interface HeadProps {
  session: Session;
  follower: Follower;
  error: Signal<unknown>;
}

function Head({ session, follower, error }: HeadProps): JSX.Element {
  const close = async () => {
    follower.session.value = await closeSession(session.id);
    error.value = undefined;
  };
  return (
    <header class="job-head">
      <p class="crumbs">
        <Link href={pageHref({ view: "sessions" })}>Sessions</Link>
        <span class="muted"> / </span>
        <span class="mono">{session.id}</span>
      </p>
      <div class="title-row">
        <h1>{session.name || "Session"}</h1>
        <SessionBadge state={session.state} />
        <Pausing follower={follower} error={error} />
        <div class="actions">
          {isLive(follower) ? (
            <Confirm
              name="Close the session"
              question="It takes no more scans; they become a data set, and a job tracks them."
              doIt="Close it"
              press={close}
              failed={(failure) => (error.value = failure)}
            />
          ) : null}
        </div>
      </div>
      <p class="job-meta">
        <span>begun {moment(session.created_at)}</span>
        {session.closed_at ? <span>closed {moment(session.closed_at)}</span> : null}
        <span>{methodsOf(session)}</span>
        {Object.entries(session.labels).map(([name, value]) => (
          <span>
            {name}: {value}
          </span>
        ))}
      </p>
    </header>
  );
}

const isLive = (follower: Follower): boolean =>
  follower.session.value?.state === "open" && follower.bond.value === "live";

/** Whether scans are taken, and the button that changes it. */
function Pausing({ follower, error }: Omit<HeadProps, "session">): JSX.Element | null {
  const isBusy = useSignal(false);
  if (!isLive(follower)) return null;
  const isPaused = follower.settled.value?.is_paused ?? false;
  const change = async () => {
    isBusy.value = true;
    try {
      await (isPaused ? resumeSession : pauseSession)(follower.id);
      error.value = undefined;
      follower.nudge();
    } catch (failure) {
      error.value = failure;
    }
    isBusy.value = false;
  };
  return (
    <>
      {isPaused ? (
        <span class="badge state-queued" role="status">
          <Icon name="pause" /> paused: pushes are refused
        </span>
      ) : null}
      <button type="button" disabled={isBusy.value} onClick={() => void change()}>
        {isPaused ? "Take scans again" : "Pause"}
      </button>
    </>
  );
}

function methodsOf({ request }: Session): string {
  const parts = request as Record<string, { method?: string } | undefined>;
  const names = [parts.associator?.method, parts.filter?.method].filter(Boolean);
  return names.join(", ").replaceAll("_", " ");
}

/** What stands between the page and the session. */
function BondNote({ follower }: { follower: Follower }): JSX.Element | null {
  const bond = follower.bond.value;
  if (bond !== "lost" && bond !== "elsewhere" && bond !== "refused") return null;
  const heard = follower.heard.value;
  const problem = asProblem(follower.error.value);
  const shown = heard ? ` Shown as of ${moment(heard.toISOString())}.` : "";
  const again = bond === "refused" ? "" : " It is asked for again.";
  const why = bond === "elsewhere" ? problem.detail : problem.title;
  return (
    <p class="stale" role="status">
      <Icon name="warning" /> {why}.{shown}
      {again}
    </p>
  );
}

const LOG_IS_KEPT =
  "It takes no more scans. Its log is kept: " +
  "POST /v1/sessions/{id}/recording makes a data set of it.";

function whatBecame({ state, dataset_id, entries }: Session): string {
  if (state === "failed") return LOG_IS_KEPT;
  if (!dataset_id) return "It took no scan, so there is no data set.";
  const became = `Its ${count(entries)} entries became a data set`;
  return `${became}, which a job tracks with the same settings.`;
}

function Became({ session }: { session: Session }): JSX.Element {
  const { dataset_id, job_id, fault } = session;
  const problem = fault as { detail?: string } | undefined;
  return (
    <section class="panel became" aria-label="What became of it">
      <h2>{session.state === "failed" ? "The session failed" : "The session is closed"}</h2>
      {problem ? <p class="error-text">{problem.detail ?? JSON.stringify(fault)}</p> : null}
      <p>{whatBecame(session)}</p>
      <p class="row">
        {job_id ? (
          <Link class="button primary" href={pageHref({ view: "job", job: job_id, tab: "plan" })}>
            The same views afterwards: the job
          </Link>
        ) : null}
        {dataset_id ? (
          <Link class="button" href={pageHref({ view: "dataset", dataset: dataset_id })}>
            The data set
          </Link>
        ) : null}
      </p>
    </section>
  );
}

function Live({ follower, at, error }: LiveProps & { error: Signal<unknown> }): JSX.Element | null {
  const picture = follower.settled.value;
  const session = follower.session.value;
  if (!session) return null;
  if (!picture) return session.state === "open" ? <Loading what="the picture" /> : null;
  if (picture.counts.entries === 0) return <NoScan session={session} />;
  const props = { follower, at };
  return (
    <>
      <div class="live-counts">
        <Counts follower={follower} />
      </div>
      <Warnings warnings={session.live?.warnings ?? []} />
      <div class="pictures live">
        <div class="pictures-main">
          <PlanOfSession {...props} />
          <LiveClock {...props} />
        </div>
        <div class="pictures-side">
          <Selected {...props} failed={(failure) => (error.value = failure)} />
          <Events follower={follower} />
        </div>
      </div>
      <TrackTable {...props} />
    </>
  );
}

function Warnings({ warnings }: { warnings: string[] }): JSX.Element | null {
  if (!warnings.length) return null;
  return (
    <details class="live-warnings">
      <summary>What is assumed of the sensors</summary>
      <ul>
        {warnings.map((warning) => (
          <li>{warning}</li>
        ))}
      </ul>
    </details>
  );
}

function NoScan({ session }: { session: Session }): JSX.Element {
  return (
    <div class="live-counts">
      <Empty title="No scan yet.">
        <p>The picture appears with the first scan that is pushed, for example:</p>
        <Code text={pushExample(session)} />
      </Empty>
    </div>
  );
}
