// The summary of a finished job: its numbers, warnings, inputs, timing, and what happened scan by
// scan.

import type { JSX } from "preact";
import {
  type EventCounts,
  type Grouping,
  type Job,
  type MetricReport,
  partsOf,
  type Report,
  type Tfa,
} from "../api/types";
import { ScanCounts } from "../charts/scan-counts";
import { Icon, type IconName, Link } from "../components/basics";
import { capital, count, duration, number, plural, probability, words } from "../format";
import { hereHref, pageHref } from "../state/url";

/** Jobs of these kinds leave no scans. */
export const SCANLESS = ["correlate"];

export function JobSummary({ job, report }: { job: Job; report: Report }): JSX.Element {
  const { tfa, association, counts, grouping, metrics, events } = partsOf(report);
  return (
    <div class="summary">
      <Warnings all={[...job.warnings, ...report.warnings, ...(tfa?.warnings ?? [])]} />
      {tfa ? <TfaNumbers tfa={tfa} /> : null}
      <div class="panels">
        {grouping ? <Groups grouping={grouping} /> : null}
        {tfa ? <OutputTracks tfa={tfa} /> : null}
        {association ? (
          <Counts title={`Association, ${words(association.method)}`} counts={association.counts} />
        ) : null}
        {counts ? <Counts title="Scene" counts={counts as Record<string, number>} /> : null}
        {metrics ? <Headlines metrics={metrics} /> : null}
        {events ? <Events events={events} /> : null}
        <Timing timing={report.timing} />
        <Inputs report={report} />
      </div>
      {SCANLESS.includes(job.kind) ? null : <ScanCounts jobId={job.id} />}
    </div>
  );
}

export function Warnings({ all }: { all: string[] }): JSX.Element | null {
  if (!all.length) return null;
  return (
    <ul class="warnings">
      {[...new Set(all)].map((warning) => (
        <li>
          <Icon name="warning" /> {warning}
        </li>
      ))}
    </ul>
  );
}

const VERDICTS = ["correct", "missed", "false"] as const;
type VerdictName = (typeof VERDICTS)[number];

/**
 * What a probability is the share of: the paper counts the correct ones among output tracks, the
 * others among targets.
 */
function divisorText({ counts }: Tfa, name: VerdictName): string {
  return name === "correct"
    ? plural(counts.output_tracks, "output track")
    : plural(counts.targets, "target");
}

/** Correct, missed and false: how many targets, and the probabilities as the paper defines them. */
export function TfaNumbers({ tfa }: { tfa: Tfa }): JSX.Element {
  const perTarget = probability(tfa.ratios.correct_per_target);
  const ofTargets = `correct per target ${perTarget}, of ${count(tfa.counts.targets)}`;
  return (
    <section aria-label="Verdicts">
      <div class="verdict-cards">
        {VERDICTS.map((name) => (
          <Link
            class={`verdict-card verdict-${name}`}
            href={hereHref({ tab: "verdicts", verdict: name, page: null })}
          >
            <span class="verdict-name">
              <Icon name={name as IconName} /> {name}
            </span>
            <span class="verdict-count">{count(tfa.counts[name])}</span>
            <span class="verdict-probability">
              P = <b>{probability(tfa.probability[name])}</b>
            </span>
            <span class="muted small">of {divisorText(tfa, name)}</span>
            {name === "correct" ? <span class="muted small">{ofTargets}</span> : null}
          </Link>
        ))}
      </div>
      <p class="muted small verdict-definition">
        P correct is the share of output tracks that follow one target all its way, so that
        redundant and false tracks lower it; P missed and P false are shares of targets. The three
        need not add up to 1. Correct per target is the share of targets that are followed all their
        way.
      </p>
    </section>
  );
}

function OutputTracks({ tfa }: { tfa: Tfa }): JSX.Element {
  const rows: [string, string][] = [
    ["Output tracks", count(tfa.counts.output_tracks)],
    ["Matched", count(tfa.counts.matched_tracks)],
    ["Redundant", count(tfa.counts.redundant_tracks)],
    ["False", count(tfa.counts.false_tracks)],
    ["Output tracks per target", number(tfa.ratios.output_tracks_per_target)],
    ["Correct per target", probability(tfa.ratios.correct_per_target)],
    ["Missed, but followed from later on", count(tfa.counts.late)],
    ["Missed, but matched by a track", count(tfa.missed_with_matched_track)],
    ["Violations of one detection, one track", count(tfa.counts.violations)],
  ];
  return (
    <section class="panel">
      <h2>Output tracks</h2>
      <dl class="facts">
        {rows.map(([name, value]) => (
          <>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Counts({
  title,
  counts,
}: {
  title: string;
  counts: Record<string, number | undefined>;
}): JSX.Element {
  return (
    <section class="panel">
      <h2>{capital(title)}</h2>
      <dl class="facts">
        {Object.entries(counts).map(([name, value]) => (
          <>
            <dt>{capital(words(name))}</dt>
            <dd>{count(value)}</dd>
          </>
        ))}
      </dl>
    </section>
  );
}

/** The headline of each metric; the tab has everything that it says. */
function Headlines({ metrics }: { metrics: Record<string, MetricReport> }): JSX.Element {
  return (
    <section class="panel">
      <h2>
        <Link href={hereHref({ tab: "metrics" })}>Metrics</Link>
      </h2>
      <dl class="facts">
        {Object.entries(metrics).map(([name, { value, unit }]) => (
          <>
            <dt>{name}</dt>
            <dd>
              {value === null || value === undefined ? "undefined" : `${number(value)} ${unit}`}
            </dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Events({ events }: { events: EventCounts }): JSX.Element {
  return (
    <section class="panel">
      <h2>Events</h2>
      <dl class="facts">
        {Object.entries(events.counts).map(([name, value]) => (
          <>
            <dt>{capital(words(name))}</dt>
            <dd>
              <Link
                href={hereHref({ tab: "metrics", event: name })}
                label={`${count(value)} events: ${words(name)}`}
              >
                {count(value)}
              </Link>
            </dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Groups({ grouping }: { grouping: Grouping }): JSX.Element {
  const rows: [string, string][] = [
    ["Accuracy", probability(grouping.accuracy)],
    ["Precision", probability(grouping.precision)],
    ["Recall", probability(grouping.recall)],
  ];
  return (
    <section class="panel">
      <h2>Grouping, {words(grouping.method)}</h2>
      <dl class="facts">
        {rows.map(([name, value]) => (
          <>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </>
        ))}
      </dl>
    </section>
  );
}

export function Timing({ timing }: { timing: Report["timing"] }): JSX.Element {
  return (
    <section class="panel">
      <h2>Computing time</h2>
      <dl class="facts">
        {Object.entries({ ...timing, cells: undefined })
          .filter(([, value]) => value !== undefined)
          .map(([name, value]) => (
            <>
              <dt>{capital(words(name))}</dt>
              <dd>{duration(value)}</dd>
            </>
          ))}
      </dl>
    </section>
  );
}

export function Inputs({ report }: { report: Report }): JSX.Element {
  return (
    <section class="panel">
      <h2>Inputs</h2>
      {report.inputs.length ? null : <p class="muted">None: the scene was simulated.</p>}
      <ul class="inputs">
        {report.inputs.map((input) => (
          <li>
            <b>{input.role}</b> from {input.source}{" "}
            {input.job_id ? (
              <Link href={pageHref({ view: "job", job: input.job_id })}>
                {input.job_id.slice(-12)}
              </Link>
            ) : null}
            {input.dataset_id ? (
              <Link href={pageHref({ view: "dataset", dataset: input.dataset_id })}>
                {input.dataset_id.slice(-12)}
              </Link>
            ) : null}
            <span class="sub mono" title={input.sha256}>
              sha256 {input.sha256.slice(0, 16)}…
            </span>
          </li>
        ))}
      </ul>
      <dl class="facts">
        <dt>Engine</dt>
        <dd>{report.engine_version}</dd>
        <dt>Seed</dt>
        <dd>{report.seed}</dd>
      </dl>
    </section>
  );
}
