// Several jobs side by side: their numbers, differences pair by pair, verdicts, and where their
// requests differ.

import type { JSX } from "preact";
import { compareJobs, listJobs } from "../api/client";
import type { Cell, Comparison, Job } from "../api/types";
import { Empty, Icon, Link, Loading, ProblemBox } from "../components/basics";
import { IntervalBar, type Scale, scaleOf } from "../components/interval-bar";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, hiddenHead, numberHead, TableScroll } from "../components/table-parts";
import { count, duration, intervalText, moment, number, words } from "../format";
import { pageHref, param, setParams } from "../state/url";
import { Overlay } from "./compare-overlay";

const MOST_JOBS = 20;
const LISTED = 200;

export function chosenJobs(): string[] {
  return (param("jobs") ?? "").split(",").filter(Boolean);
}

export function Compare(): JSX.Element {
  const ids = chosenJobs();
  return (
    <section>
      <h1>Compare jobs</h1>
      <Chosen ids={ids} />
      {ids.length < 2 ? (
        <Empty title="Choose two jobs or more.">
          <p>Tick them in the list of jobs, or add them here.</p>
          <Link class="button" href={pageHref({})}>
            Go to the jobs
          </Link>
        </Empty>
      ) : (
        <Result ids={ids} />
      )}
    </section>
  );
}

function Chosen({ ids }: { ids: string[] }): JSX.Element {
  const jobs = useResource(() => listJobs({ state: "succeeded", limit: LISTED }), []);
  const others = (jobs.data?.items ?? []).filter((job) => !ids.includes(job.id));
  const text = (job: Job) =>
    `${job.name || job.id.slice(-12)} · ${job.kind} · ${moment(job.created_at)}`;
  return (
    <div class="filters">
      <label class="grow">
        <span>Add a job</span>
        <select
          value=""
          disabled={ids.length >= MOST_JOBS}
          onChange={(event) =>
            setParams({ jobs: [...ids, event.currentTarget.value].join(",") }, "push")
          }
        >
          <option value="">
            {ids.length >= MOST_JOBS ? `${MOST_JOBS} jobs at most` : "choose…"}
          </option>
          {others.map((job) => (
            <option value={job.id}>{text(job)}</option>
          ))}
        </select>
      </label>
    </div>
  );
}

function Result({ ids }: { ids: string[] }): JSX.Element {
  const baseline = param("baseline") ?? undefined;
  const result = useResource(() => compareJobs(ids, baseline), [ids.join(","), baseline]);
  if (result.error) return <ProblemBox error={result.error} retry={result.reload} />;
  if (!result.data) return <Loading what="the comparison" />;
  const comparison = result.data;
  return (
    <div class="summary">
      {comparison.notes.length ? (
        <ul class="warnings">
          {comparison.notes.map((note) => (
            <li>
              <Icon name="warning" /> {note}
            </li>
          ))}
        </ul>
      ) : null}
      <Jobs comparison={comparison} ids={ids} />
      <Numbers comparison={comparison} />
      <Differences comparison={comparison} />
      <Overlay
        comparison={comparison}
        names={comparison.jobs.map((_, index) => named(comparison, index))}
      />
      <Requests comparison={comparison} />
    </div>
  );
}

const letter = (index: number): string => String.fromCharCode(65 + index);
const named = (comparison: Comparison, index: number): string =>
  `${letter(index)}: ${comparison.jobs[index]?.name || comparison.jobs[index]?.id.slice(-12)}`;

function Jobs({ comparison, ids }: { comparison: Comparison; ids: string[] }): JSX.Element {
  const remove = (id: string) =>
    setParams(
      {
        jobs: ids.filter((other) => other !== id).join(","),
        ...(comparison.baseline === id ? { baseline: null } : {}),
      },
      "push",
    );
  const heads = [
    hiddenHead("Letter or action"),
    ...["Job", "Kind", "Seed", "Computed", "Baseline"],
    ...(comparison.verdicts ? ["Targets in both", "Correct in both", "Gained", "Lost"] : []),
    hiddenHead("Letter or action"),
  ];
  return (
    <TableScroll label="Compared jobs" class="table-scroll">
      <table class="data">
        <HeadRow heads={heads} />
        <tbody>
          {comparison.jobs.map((job, index) => (
            <tr>
              <th scope="row" class="letter">
                {letter(index)}
              </th>
              <td class="wrap">
                <Link href={pageHref({ view: "job", job: job.id })}>{job.name || job.id}</Link>
              </td>
              <td>{job.kind}</td>
              <td>{job.seed}</td>
              <td>{duration(job.total_s)}</td>
              <td>
                <input
                  type="radio"
                  name="baseline"
                  aria-label={`Compare with ${named(comparison, index)}`}
                  checked={job.id === comparison.baseline}
                  onChange={() => setParams({ baseline: index === 0 ? null : job.id })}
                />
              </td>
              {comparison.verdicts ? verdictCells(comparison, job.id) : null}
              <td>
                <button
                  type="button"
                  class="quiet"
                  onClick={() => remove(job.id)}
                  aria-label={`Remove ${named(comparison, index)}`}
                >
                  <Icon name="close" />
                </button>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </TableScroll>
  );
}

function verdictCells(comparison: Comparison, job: string): JSX.Element | JSX.Element[] {
  const verdict = comparison.verdicts?.find((each) => each.job_id === job);
  if (!verdict) {
    return (
      <td colSpan={4} class="muted">
        {job === comparison.baseline ? "the baseline" : "no verdicts"}
      </td>
    );
  }
  const { targets, both_correct, gained, lost } = verdict;
  return [targets, both_correct, gained, lost].map((value) => <td>{count(value)}</td>);
}

function matches(text: string): boolean {
  return text.toLowerCase().includes((param("find") ?? "").toLowerCase());
}

const short = (path: string): string => path.replace(/^metrics\./, "").replace(".quantities.", ".");

function Numbers({ comparison }: { comparison: Comparison }): JSX.Element {
  const differing = param("same") !== "1";
  const isSame = (values: (number | null)[]) => values.every((value) => value === values[0]);
  const kept = comparison.numbers.filter(
    (row) => matches(row.path) && !(differing && isSame(row.values)),
  );
  const table = (): TableData => ({
    columns: ["number", "unit", ...comparison.jobs.map((_, index) => named(comparison, index))],
    rows: kept.map((row): Cell[] => [row.path, row.unit, ...row.values]),
  });
  const tools = (
    <div class="filters frame-filters" role="search">
      <label class="grow">
        <span>Number</span>
        <input
          type="search"
          data-filter
          value={param("find") ?? ""}
          placeholder="Press / to filter"
          onInput={(event) => setParams({ find: event.currentTarget.value })}
        />
      </label>
      <label class="check-label">
        <input
          type="checkbox"
          checked={differing}
          onChange={(event) => setParams({ same: event.currentTarget.checked ? null : "1" })}
        />{" "}
        only what differs
      </label>
      <p class="muted small">
        {count(kept.length)} of {count(comparison.numbers.length)}
      </p>
    </div>
  );
  return (
    <TableFrame title="Numbers" file="compared-numbers" table={table} tools={tools}>
      {kept.length ? (
        <TableScroll label="Numbers side by side">
          <table class="data">
            <Head comparison={comparison} first="Number" />
            <tbody>
              {kept.map((row) => (
                <tr>
                  <th scope="row" title={row.path}>
                    {short(row.path)} <span class="muted">{row.unit}</span>
                  </th>
                  {row.values.map((value) => (
                    <td class="num">{number(value)}</td>
                  ))}
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      ) : (
        <Empty
          title={
            comparison.numbers.length
              ? "No number differs, or none matches the filter."
              : "These jobs have no number in common."
          }
        />
      )}
    </TableFrame>
  );
}

function Head({ comparison, first }: { comparison: Comparison; first: string }): JSX.Element {
  return (
    <thead>
      <tr>
        <th scope="col">{first}</th>
        {comparison.jobs.map((job, index) => (
          <th scope="col" class="num" title={job.name ?? job.id}>
            {letter(index)}
            {job.id === comparison.baseline ? " (baseline)" : ""}
          </th>
        ))}
      </tr>
    </thead>
  );
}

function pairedTable(comparison: Comparison, rows: Comparison["paired"]): TableData {
  const lines = rows.flatMap((row) =>
    row.differences.flatMap((difference, index): Cell[][] =>
      difference
        ? [
            [
              row.cell ?? null,
              row.name,
              row.unit,
              row.over,
              named(comparison, index),
              difference.pairs,
              difference.mean,
              difference.interval?.low ?? null,
              difference.interval?.high ?? null,
              difference.smaller,
              difference.larger,
            ],
          ]
        : [],
    ),
  );
  return {
    columns: [
      "cell",
      "number",
      "unit",
      "paired over",
      "job",
      "pairs",
      "mean difference",
      "low",
      "high",
      "smaller",
      "larger",
    ],
    rows: lines,
  };
}

const PAIRED_HEADS = [
  "Number",
  "Job",
  ...["Pairs", "Mean difference", "Interval"].map(numberHead),
  hiddenHead("Picture"),
  ...["Smaller", "Larger"].map(numberHead),
];

function Differences({ comparison }: { comparison: Comparison }): JSX.Element | null {
  if (!comparison.paired.length) return null;
  const kept = comparison.paired.filter((row) => matches(`${row.cell ?? ""} ${row.name}`));
  const base = named(
    comparison,
    comparison.jobs.findIndex((job) => job.id === comparison.baseline),
  );
  const note = (
    <p class="muted small frame-note">
      Each job less {base}, pair by pair: over the runs of campaigns, over targets, over the times
      at which truth and tracks were compared. {number(comparison.confidence * 100)} % interval;
      times follow each other, so theirs is from the means of batches. A filled bar does not touch
      zero.
    </p>
  );
  return (
    <TableFrame
      title="Paired differences"
      file="paired-differences"
      table={() => pairedTable(comparison, kept)}
      tools={note}
    >
      <TableScroll label="Paired differences">
        <table class="data">
          <HeadRow heads={PAIRED_HEADS} />
          <tbody>{kept.slice(0, LISTED).map((row) => pairedRows(comparison, row))}</tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}

function pairedRows(comparison: Comparison, row: Comparison["paired"][number]): JSX.Element[] {
  const scale: Scale = scaleOf(row.differences.flatMap((difference) => difference?.interval ?? []));
  return row.differences.flatMap((difference, index) =>
    difference
      ? [
          <tr>
            <th scope="row">
              {row.cell ? <span class="sub">{row.cell}</span> : null}
              {row.name} <span class="muted">{row.unit}</span>
            </th>
            <td title={named(comparison, index)}>{letter(index)}</td>
            <td class="num">
              {count(difference.pairs)} <span class="sub">{row.over}</span>
            </td>
            <td class="num">{number(difference.mean)}</td>
            <td class="num">{difference.interval ? intervalText(difference.interval) : "–"}</td>
            <td class="interval-cell">
              {difference.interval ? (
                <IntervalBar mean={difference.mean} span={difference.interval} scale={scale} />
              ) : null}
              {difference.verdict ? <span class="sub">{words(difference.verdict)}</span> : null}
            </td>
            <td class="num">{count(difference.smaller)}</td>
            <td class="num">{count(difference.larger)}</td>
          </tr>,
        ]
      : [],
  );
}

function Requests({ comparison }: { comparison: Comparison }): JSX.Element {
  const rows = comparison.request;
  const table = (): TableData => ({
    columns: ["place", ...comparison.jobs.map((_, index) => named(comparison, index))],
    rows: rows.map((row): Cell[] => [row.pointer, ...row.values]),
  });
  return (
    <TableFrame title="Where the requests differ" file="request-differences" table={table}>
      {rows.length ? (
        <TableScroll label="Differences of the requests">
          <table class="data">
            <Head comparison={comparison} first="Place in the request" />
            <tbody>
              {rows.map((row) => (
                <tr>
                  <th scope="row" class="mono">
                    {row.pointer}
                  </th>
                  {row.values.map((value) => (
                    <td class={`num wrap${value === null ? " absent-track" : " mono"}`}>
                      {value ?? "absent"}
                    </td>
                  ))}
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      ) : (
        <Empty title="The requests are the same." />
      )}
    </TableFrame>
  );
}

export function compareHref(ids: string[]): string {
  return pageHref({ view: "compare", jobs: ids.join(",") });
}
