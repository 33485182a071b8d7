// What stands above the result of a job: how far it is, and the tabs.

import type { JSX } from "preact";
import type { Job } from "../api/types";
import { Link, ProgressBar } from "../components/basics";
import { isActive } from "../state/live";
import { hereHref, pageHref } from "../state/url";

function waitingFor(job: Job): string {
  if (job.state === "running") return "Starting…";
  return job.depends_on.length
    ? "Waiting for the job it reads from."
    : "Waiting for a free worker.";
}

export function Waiting({ job }: { job: Job }): JSX.Element {
  return (
    <section class="waiting" aria-live="polite">
      {job.progress ? (
        <ProgressBar progress={job.progress} />
      ) : (
        <p class="muted">{waitingFor(job)}</p>
      )}
      {job.progress ? (
        <p class="muted">
          Step {job.progress.step}: {job.progress.done} of {job.progress.total}
        </p>
      ) : null}
      {job.depends_on.map((id) => (
        <p>
          <Link href={pageHref({ view: "job", job: id })}>{id}</Link>
        </p>
      ))}
    </section>
  );
}

export type TabName =
  | "summary"
  | "correlation"
  | "plan"
  | "verdicts"
  | "metrics"
  | "requirements"
  | "search"
  | "spec";

/**
 * What leaves the address when a tab changes: the rest (clock, selection) is the same in every tab.
 */
const TAB_RESET = { page: null };

export function Tabs({
  tabs,
  chosen,
}: {
  tabs: [TabName, string][];
  chosen: TabName;
}): JSX.Element {
  return (
    <nav class="tabs" aria-label="Result">
      {tabs.map(([name, title]) => (
        <Link
          href={hereHref({ ...TAB_RESET, tab: name === "summary" ? null : name })}
          current={name === chosen}
        >
          {title}
        </Link>
      ))}
    </nav>
  );
}

/** Runs that are made, of this job or of the one that it runs again. */
export function mayHaveRuns(job: Job): boolean {
  return (
    (job.progress?.done ?? 0) > 0 || (!isActive(job) && Boolean(job.rerun_of && job.started_at))
  );
}

/** Whether runs were made that a rerun takes over. */
export function leftRuns(job: Job): boolean {
  return (
    job.kind === "campaign" &&
    (job.state === "failed" || job.state === "canceled") &&
    mayHaveRuns(job)
  );
}
