// One job: its head and live progress, and the tabs of its result. It opens on the summary;
// pictures load when asked.

import { useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import {
  ApiError,
  cancelJob,
  getPlan,
  getReport,
  getScanCounts,
  pinJob,
  rerunJob,
} from "../api/client";
import { type Job, partsOf, type Report } from "../api/types";
import { Empty, Link, Loading, ProblemBox, StateBadge } from "../components/basics";
import { later } from "../components/later";
import { useResource } from "../components/resource";
import { duration, moment, seconds } from "../format";
import { followJob, isActive } from "../state/live";
import { go, hereHref, pageHref, param } from "../state/url";
import { JobMetrics } from "./job-metrics";
import { leftRuns, type TabName, Tabs, Waiting } from "./job-parts";
import { JobSpec } from "./job-spec";
import { JobSummary, SCANLESS } from "./job-summary";
import { JobVerdicts } from "./job-verdicts";

export function JobPage({ id }: { id: string }): JSX.Element {
  const job = useSignal<Job | undefined>(undefined);
  const error = useSignal<unknown>(undefined);
  useEffect(
    () =>
      followJob(id, {
        job: (fresh) => {
          job.value = fresh;
          error.value = undefined;
        },
        failed: (failure) => (error.value = failure),
      }),
    [id],
  );
  if (!job.value) return error.value ? <Lost error={error.value} /> : <Loading what="the job" />;
  const failed = (failure: unknown) => (error.value = failure);
  const { kind } = job.value;
  // A campaign that goes on keeps what was chosen to look at.
  const hrefOf = (fresh: Job) =>
    kind === "campaign"
      ? hereHref({ job: fresh.id, tab: null })
      : pageHref({ view: "job", job: fresh.id });
  const rerun = () => void rerunJob(id).then((fresh) => go(hrefOf(fresh)), failed);
  return (
    <article>
      <Head
        job={job.value}
        rerun={rerun}
        failed={failed}
        changed={(fresh) => (job.value = fresh)}
      />
      {error.value ? <ProblemBox error={error.value} /> : null}
      {kind === "campaign" ? (
        <CampaignPage key={job.value.id} job={job.value} rerun={rerun} />
      ) : (
        <Outcome job={job.value} />
      )}
    </article>
  );
}

function Lost({ error }: { error: unknown }): JSX.Element {
  return (
    <>
      <h1>Job</h1>
      <ProblemBox error={error} />
      <Link href={pageHref({})}>All jobs</Link>
    </>
  );
}

interface HeadProps {
  job: Job;
  rerun: () => void;
  failed: (error: unknown) => void;
  changed: (job: Job) => void;
}

const PIN = "A pinned job stays when old jobs make room";

function Head({ job, rerun, failed, changed }: HeadProps): JSX.Element {
  const cancel = () => void cancelJob(job.id).then(changed, failed);
  const pin = () => void pinJob(job.id, !job.pinned).then(changed, failed);
  const canceling = isActive(job) && Boolean(job.cancel_requested_at);
  return (
    <header class="job-head">
      <p class="crumbs">
        <Link href={pageHref({})}>Jobs</Link> <span class="muted">/</span>{" "}
        <span class="mono">{job.id}</span>
      </p>
      <div class="title-row">
        <h1>{job.name || `${job.kind} job`}</h1>
        <StateBadge state={job.state} canceling={canceling} />
        <div class="actions">
          <button type="button" class="quiet" aria-pressed={job.pinned} title={PIN} onClick={pin}>
            {job.pinned ? "Pinned" : "Pin"}
          </button>
          {job.can_cancel && !canceling ? (
            <button type="button" onClick={cancel}>
              Cancel
            </button>
          ) : null}
          {isActive(job) ? null : (
            <>
              <Link class="button" href={pageHref({ view: "new", from: job.id })}>
                Change and run
              </Link>
              {leftRuns(job) ? null : (
                <button type="button" onClick={rerun}>
                  Rerun
                </button>
              )}
            </>
          )}
        </div>
      </div>
      <p class="job-meta">
        <span>{job.kind}</span>
        <span>seed {job.seed}</span>
        <span>created {moment(job.created_at)}</span>
        {job.started_at ? (
          <span>took {duration(seconds(job.started_at, job.finished_at))}</span>
        ) : null}
        {job.rerun_of ? (
          <span>
            rerun of{" "}
            <Link href={pageHref({ view: "job", job: job.rerun_of })}>
              {job.rerun_of.slice(-12)}
            </Link>
          </span>
        ) : null}
        {job.duplicate_of ? (
          <span>
            same request as{" "}
            <Link href={pageHref({ view: "job", job: job.duplicate_of })}>
              {job.duplicate_of.slice(-12)}
            </Link>
          </span>
        ) : null}
        {Object.entries(job.labels).map(([key, value]) => (
          <span class="label">
            {key}={value}
          </span>
        ))}
      </p>
    </header>
  );
}

function Outcome({ job }: { job: Job }): JSX.Element {
  if (isActive(job)) return <Waiting job={job} />;
  if (job.state === "succeeded") return <Result job={job} />;
  if (job.state === "canceled") return <Empty title="This job was canceled. It left no result." />;
  const problem = job.error ?? {
    type: "about:blank",
    title: "The job failed",
    status: 0,
    code: "failed",
  };
  return <ProblemBox error={new ApiError(problem)} />;
}

function tabsOf(report: Report): [TabName, string][] {
  const { tuples, tfa, metrics, requirements } = partsOf(report);
  const tabs: [TabName, string, boolean][] = [
    ["summary", "Summary", true],
    ["correlation", "Correlation", tuples !== undefined],
    ["plan", "Plan view", true],
    ["verdicts", "Verdicts", tfa !== undefined],
    ["metrics", "Metrics", metrics !== undefined],
    ["requirements", "Requirements", requirements !== undefined],
    ["search", "Method", hasTrace(report)],
    ["spec", "Request and files", true],
  ];
  return tabs.flatMap(([name, title, there]) => (there ? [[name, title]] : []));
}

/** Asks for what the tab will draw while the report is on its way. */
function askAhead(job: Job): void {
  if (param("tab") === "spec") return;
  void import("../charts/echarts");
  if (param("tab") === "plan") void import("./job-pictures");
  // Who draws it says what went wrong.
  const answer =
    param("tab") === "plan"
      ? getPlan(job.id)
      : param("tab") === null && !SCANLESS.includes(job.kind)
        ? getScanCounts(job.id)
        : undefined;
  answer?.catch(() => undefined);
}

/** Whether a search wrote down its way. */
function hasTrace(report: Report): boolean {
  const { association, grouping } = partsOf(report);
  return association?.diagnostics !== undefined || grouping?.search !== undefined;
}

// Lists do without the code of these, and most jobs without that of all but the plan.
const CampaignPage = later(
  "the campaign",
  async () => (await import("./campaign-page")).CampaignPage,
);
const Plan = later("the plan", async () => (await import("./job-pictures")).JobPictures);
const JobCorrelation = later(
  "the tuples",
  async () => (await import("./job-correlation")).JobCorrelation,
);
const JobRequirements = later(
  "the requirements",
  async () => (await import("./job-requirements")).JobRequirements,
);
const JobSearch = later("the search", async () => (await import("./job-search")).JobSearch);

function Result({ job }: { job: Job }): JSX.Element {
  useEffect(() => askAhead(job), [job.id]);
  const report = useResource(() => getReport(job.id), [job.id]);
  const tabs = useMemo(() => (report.data ? tabsOf(report.data) : []), [report.data]);
  if (report.error) return <ProblemBox error={report.error} retry={report.reload} />;
  if (!report.data) return <Loading what="the report" />;
  const parts = partsOf(report.data);
  const { tfa, requirements } = parts;
  const asked = param("tab") ?? "summary";
  const tab = tabs.find(([name]) => name === asked)?.[0] ?? "summary";
  return (
    <>
      <Tabs tabs={tabs} chosen={tab} />
      {tab === "summary" ? <JobSummary job={job} report={report.data} /> : null}
      {tab === "correlation" ? <JobCorrelation job={job} report={report.data} /> : null}
      {tab === "plan" ? <Plan job={job} report={report.data} /> : null}
      {tab === "verdicts" && tfa ? <JobVerdicts job={job} tfa={tfa} /> : null}
      {tab === "metrics" ? <JobMetrics job={job} report={report.data} /> : null}
      {tab === "requirements" && requirements ? (
        <JobRequirements report={requirements} file={job.id.slice(-12)} />
      ) : null}
      {tab === "search" ? <JobSearch job={job} report={report.data} /> : null}
      {tab === "spec" ? <JobSpec job={job} report={report.data} /> : null}
    </>
  );
}
