// A campaign from its first runs to its report: the same table and charts all the way, so that
// nothing jumps when it ends.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { ApiError, getCampaignCells, getReport, getSpec } from "../api/client";
import { type CampaignSoFar, type Job, partsOf, type Report } from "../api/types";
import { Empty, Loading, ProblemBox, ProgressBar } from "../components/basics";
import { useResource } from "../components/resource";
import { count } from "../format";
import { askOnNews, isActive } from "../state/live";
import { param } from "../state/url";
import { axesOf } from "./campaign-axes";
import type { Campaign } from "./campaign-parts";
import { JobCampaign } from "./job-campaign";
import { leftRuns, mayHaveRuns, type TabName, Tabs, Waiting } from "./job-parts";
import { JobSpec } from "./job-spec";
import { Inputs, Timing, Warnings } from "./job-summary";

type Spec = Record<string, unknown>;

const TABS: [TabName, string][] = [
  ["summary", "Summary"],
  ["spec", "Request and files"],
];

function campaignOf(
  job: Job,
  spec: Spec,
  result: Partial<CampaignSoFar["result"]>,
  times: Campaign["times"],
): Campaign {
  const { cells = [], outcomes = [], confidence = 0.95 } = result;
  return {
    axes: axesOf(spec, cells),
    cells,
    outcomes,
    confidence,
    runs: Number(spec.runs ?? 1),
    times,
    file: job.id.slice(-12),
  };
}

interface SoFar {
  data?: CampaignSoFar;
  /** There is no run. */
  none?: boolean;
  error?: unknown;
}

/** What the runs say; an answer stays until there is a newer one. The report says the rest. */
function useSoFar(job: Job): SoFar {
  const [soFar, setSoFar] = useState<SoFar>({});
  const asker = useRef<ReturnType<typeof askOnNews> | undefined>(undefined);
  useEffect(() => {
    const failed = (error: unknown) => {
      const none = error instanceof ApiError && error.problem.code === "result_not_ready";
      setSoFar((before) => ({ ...before, none, error: none ? undefined : error }));
      if (!none) throw error;
    };
    asker.current = askOnNews(() =>
      getCampaignCells(job.id).then((data) => setSoFar({ data }), failed),
    );
    return () => asker.current?.stop();
  }, [job.id]);
  useEffect(() => {
    if (job.state !== "succeeded" && mayHaveRuns(job)) asker.current?.news();
  }, [job.id, job.state, job.progress?.done]);
  return soFar;
}

interface Props {
  job: Job;
  rerun: () => void;
}

function plannedOf(campaign: Campaign, spec: Spec | undefined): string {
  return `${spec?.stop_at ? "at most " : ""}${count(campaign.cells.length * campaign.runs)}`;
}

/** Has to be another component for another job. */
export function CampaignPage({ job, rerun }: Props): JSX.Element {
  const hasReport = job.state === "succeeded";
  const spec = useResource(() => getSpec(job.id), [job.id]);
  const report = useResource(
    async () => (hasReport ? getReport(job.id) : undefined),
    [job.id, hasReport],
  );
  const soFar = useSoFar(job);
  const campaign = useMemo(() => {
    if (report.data)
      return campaignOf(
        job,
        report.data.spec as Spec,
        partsOf(report.data),
        report.data.timing.cells ?? [],
      );
    // Until all cells have a run there is nothing to compare.
    return spec.data && soFar.data?.runs
      ? campaignOf(job, spec.data, soFar.data.result, [])
      : undefined;
  }, [job.id, spec.data, report.data, soFar.data]);
  const error = report.error ? report : spec.error ? spec : undefined;
  if (error) return <ProblemBox error={error.error} retry={error.reload} />;
  const tab = report.data && param("tab") === "spec" ? "spec" : "summary";
  return (
    <>
      {report.data ? (
        <Tabs tabs={TABS} chosen={tab} />
      ) : (
        <HowFar
          job={job}
          soFar={soFar}
          planned={campaign && plannedOf(campaign, spec.data)}
          rerun={rerun}
        />
      )}
      {tab === "summary" && campaign ? (
        <Summary job={job} campaign={campaign} report={report.data} />
      ) : null}
      {tab === "spec" && report.data ? <JobSpec job={job} report={report.data} /> : null}
    </>
  );
}

function Summary({
  job,
  campaign,
  report,
}: {
  job: Job;
  campaign: Campaign;
  report: Report | undefined;
}): JSX.Element {
  return (
    <div class="summary">
      <Warnings all={[...job.warnings, ...(report?.warnings ?? [])]} />
      <JobCampaign campaign={campaign} />
      {report ? (
        <div class="panels">
          <Timing timing={report.timing} />
          <Inputs report={report} />
        </div>
      ) : null}
    </div>
  );
}

interface HowFarProps extends Props {
  soFar: SoFar;
  /** Runs of all cells; nothing while there is no run of each. */
  planned: string | undefined;
}

/** What stands in the place of the tabs until there is a report. */
function HowFar({ job, soFar, planned, rerun }: HowFarProps): JSX.Element {
  const runs = planned === undefined ? undefined : `${count(soFar.data?.runs)} of ${planned}`;
  if (isActive(job))
    return runs === undefined ? <Waiting job={job} /> : <Growing job={job} runs={runs} />;
  if (job.state === "succeeded")
    return runs === undefined ? <Loading what="the report" /> : <Growing job={job} runs={runs} />;
  const problem = job.error ?? {
    type: "about:blank",
    title: "The job failed",
    status: 0,
    code: "failed",
  };
  return (
    <>
      {job.state === "failed" ? <ProblemBox error={new ApiError(problem)} /> : null}
      {leftRuns(job) && !soFar.none ? (
        <Kept job={job} runs={runs ?? count(job.progress?.done)} rerun={rerun} />
      ) : job.state === "canceled" ? (
        <Empty title="This job was canceled. It left no result." />
      ) : null}
      {soFar.error ? <ProblemBox error={soFar.error} /> : null}
    </>
  );
}

function Growing({ job, runs }: { job: Job; runs: string }): JSX.Element {
  return (
    <section class="how-far" aria-label="How far the campaign is">
      {isActive(job) && job.progress ? <ProgressBar progress={job.progress} /> : null}
      <p>
        <b>Runs so far: {runs}</b>
        {isActive(job) ? "; the numbers still move." : "; the report is on its way."}
      </p>
    </section>
  );
}

function Kept({ job, runs, rerun }: Props & { runs: string }): JSX.Element {
  return (
    <section class="how-far" aria-label="Runs that are kept">
      <p>
        {job.state === "canceled" ? "This job was canceled. " : ""}
        <b>Runs made: {runs}.</b> They are kept.
      </p>
      <button type="button" class="primary" onClick={rerun}>
        Rerun: make the missing runs
      </button>
    </section>
  );
}
