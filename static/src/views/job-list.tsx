// The list of jobs: filters in the address, live progress, paging by cursor.

import { useSignal } from "@preact/signals";
import type { JSX, TargetedEvent } from "preact";
import { useEffect } from "preact/hooks";
import { cancelJob, listJobs } from "../api/client";
import type { Job, JobPage } from "../api/types";
import {
  asProblem,
  Empty,
  Icon,
  Link,
  Loading,
  ProblemBox,
  ProgressBar,
  StateBadge,
} from "../components/basics";
import { HeadRow, hiddenHead, numberHead } from "../components/table-parts";
import { duration, moment, seconds } from "../format";
import { isActive, poll } from "../state/live";
import { pageHref, param, setParams } from "../state/url";
import { compareHref } from "./compare";
import { UsageLine } from "./usage";

const STATES = ["queued", "running", "succeeded", "failed", "canceled"];
const KINDS = ["simulate", "associate", "evaluate", "group", "correlate", "campaign"];
const PAGE = 50;
const MOST_COMPARED = 20;
const LIVE_MS = 1000;
const QUIET_MS = 5000;

interface Listing {
  jobs: Job[];
  next?: string | null | undefined;
  updated: Date;
}

/** The first page as it is now, and what was loaded after it. */
function merged(first: JobPage, before: Listing | undefined): Listing {
  const known = new Set(first.items.map((job) => job.id));
  const later = (before?.jobs ?? []).slice(PAGE).filter((job) => !known.has(job.id));
  return {
    jobs: [...first.items, ...later],
    next: later.length ? before?.next : first.next_cursor,
    updated: new Date(),
  };
}

function Filters(): JSX.Element {
  const text = param("q") ?? "";
  const choose = (name: string) => (event: TargetedEvent<HTMLSelectElement>) =>
    setParams({ [name]: event.currentTarget.value });
  const select = (name: string, label: string, values: string[]) => (
    <label>
      <span>{label}</span>
      <select value={param(name) ?? ""} onChange={choose(name)}>
        <option value="">all</option>
        {values.map((value) => (
          <option value={value}>{value}</option>
        ))}
      </select>
    </label>
  );
  return (
    <form class="filters" role="search" onSubmit={(event) => event.preventDefault()}>
      {select("state", "State", STATES)}
      {select("kind", "Kind", KINDS)}
      <label class="grow">
        <span>Name or id</span>
        <input
          type="search"
          data-filter
          value={text}
          placeholder="Press / to filter"
          onInput={(event) => setParams({ q: event.currentTarget.value })}
        />
      </label>
    </form>
  );
}

function ticked(): string[] {
  return (param("ticked") ?? "").split(",").filter(Boolean);
}

function Tick({ job }: { job: Job }): JSX.Element {
  const ids = ticked();
  const isOn = ids.includes(job.id);
  const change = () =>
    setParams({ ticked: (isOn ? ids.filter((id) => id !== job.id) : [...ids, job.id]).join(",") });
  return (
    <input
      type="checkbox"
      checked={isOn}
      disabled={!isOn && ids.length >= MOST_COMPARED}
      aria-label={`Compare ${job.name || job.id}`}
      onChange={change}
    />
  );
}

function CompareBar(): JSX.Element | null {
  const ids = ticked();
  if (!ids.length) return null;
  return (
    <p class="compare-bar">
      {ids.length === 1 ? (
        <span class="muted">One job is ticked; another one makes a comparison.</span>
      ) : (
        <Link class="button primary" href={compareHref(ids)}>
          Compare {ids.length} jobs
        </Link>
      )}
      <button type="button" class="quiet" onClick={() => setParams({ ticked: null })}>
        Untick all
      </button>
    </p>
  );
}

function JobRow({ job, cancel }: { job: Job; cancel: (job: Job) => void }): JSX.Element {
  const live = isActive(job);
  return (
    <tr class={`row-${job.state}`}>
      <td class="cell-tick">{job.state === "succeeded" ? <Tick job={job} /> : null}</td>
      <td class="cell-name">
        <Link href={pageHref({ view: "job", job: job.id })}>
          {job.name || <span class="mono">{job.id}</span>}
        </Link>
        {job.name ? <span class="mono muted id">{job.id.slice(-12)}</span> : null}
        {job.pinned ? <span class="label">pinned</span> : null}
      </td>
      <td>{job.kind}</td>
      <td class="cell-state">
        <StateBadge state={job.state} canceling={live && Boolean(job.cancel_requested_at)} />
        {job.state === "running" && job.progress ? <ProgressBar progress={job.progress} /> : null}
        {job.error ? <span class="sub error-text">{job.error.title}</span> : null}
      </td>
      <td class="num">
        <time dateTime={job.created_at} title={job.created_at}>
          {moment(job.created_at)}
        </time>
      </td>
      <td class="num">
        {job.started_at ? duration(seconds(job.started_at, job.finished_at)) : "–"}
      </td>
      <td class="cell-action">
        {job.can_cancel && !job.cancel_requested_at ? (
          <button
            type="button"
            class="quiet"
            onClick={() => cancel(job)}
            aria-label={`Cancel ${job.name || job.id}`}
          >
            Cancel
          </button>
        ) : null}
      </td>
    </tr>
  );
}

function Nothing(): JSX.Element {
  if (param("state") || param("kind") || param("q")) {
    return (
      <Empty title="No job matches these filters.">
        <button type="button" onClick={() => setParams({ state: null, kind: null, q: null })}>
          Clear the filters
        </button>
      </Empty>
    );
  }
  return (
    <Empty title="No jobs yet.">
      <p>Start from a published scene or from your own recording.</p>
      <Link class="button primary" href={pageHref({ view: "new" })}>
        New job
      </Link>
    </Empty>
  );
}

const HEADS = [
  hiddenHead("Compare"),
  "Name",
  "Kind",
  "State",
  numberHead("Created"),
  numberHead("Duration"),
  hiddenHead("Action"),
];

function Rows({ jobs, cancel }: { jobs: Job[]; cancel: (job: Job) => void }): JSX.Element {
  return (
    <div class="table-scroll">
      <table class="jobs">
        <HeadRow heads={HEADS} />
        <tbody>
          {jobs.map((job) => (
            <JobRow key={job.id} job={job} cancel={cancel} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

export function JobList(): JSX.Element {
  const listing = useSignal<Listing | undefined>(undefined);
  const error = useSignal<unknown>(undefined);
  const round = useSignal(0);
  const query = {
    state: param("state") ?? undefined,
    kind: param("kind") ?? undefined,
    q: param("q") ?? undefined,
    limit: PAGE,
  };
  const key = JSON.stringify(query);
  useEffect(() => {
    listing.value = undefined;
  }, [key]);
  useEffect(() => {
    let current = true;
    const stop = poll(async () => {
      try {
        const first = await listJobs(clean(query));
        if (!current) return null;
        listing.value = merged(first, listing.peek());
        error.value = undefined;
        return first.items.some(isActive) ? LIVE_MS : QUIET_MS;
      } catch (failure) {
        if (current) error.value = failure;
        return QUIET_MS;
      }
    });
    return () => {
      current = false;
      stop();
    };
  }, [key, round.value]);
  const again = () => (round.value += 1);
  const cancel = (job: Job) =>
    void cancelJob(job.id).then(again, (failure: unknown) => (error.value = failure));
  const more = async () => {
    const before = listing.peek();
    if (!before?.next) return;
    try {
      const page = await listJobs({ ...clean(query), cursor: before.next });
      const known = new Set(before.jobs.map((job) => job.id));
      listing.value = {
        ...before,
        jobs: [...before.jobs, ...page.items.filter((job) => !known.has(job.id))],
        next: page.next_cursor,
      };
    } catch (failure) {
      error.value = failure;
    }
  };
  return (
    <section>
      <div class="title-row">
        <h1>Jobs</h1>
        <Link class="button primary" href={pageHref({ view: "new" })}>
          <Icon name="plus" /> New job
        </Link>
      </div>
      <Filters />
      <CompareBar />
      <Body listing={listing.value} error={error.value} again={again} cancel={cancel} more={more} />
    </section>
  );
}

interface BodyProps {
  listing: Listing | undefined;
  error: unknown;
  again: () => void;
  cancel: (job: Job) => void;
  more: () => void;
}

function Body({ listing, error, again, cancel, more }: BodyProps): JSX.Element {
  if (!listing) return error ? <ProblemBox error={error} retry={again} /> : <Loading what="jobs" />;
  return (
    <>
      {error ? (
        <p class="stale" role="status">
          <Icon name="warning" /> {asProblem(error).title}. Shown as of{" "}
          {moment(listing.updated.toISOString())}; trying again.
        </p>
      ) : null}
      <UsageLine />
      {listing.jobs.length ? <Rows jobs={listing.jobs} cancel={cancel} /> : <Nothing />}
      {listing.next ? (
        <p class="more">
          <button type="button" onClick={more}>
            Load more
          </button>
          <span class="muted">{listing.jobs.length} shown</span>
        </p>
      ) : null}
    </>
  );
}

function clean<T extends object>(query: T): T {
  return Object.fromEntries(
    Object.entries(query).filter(([, value]) => value !== undefined && value !== ""),
  ) as T;
}
