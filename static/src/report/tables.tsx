// The tables of the page of a job.

import type { JSX } from "preact";
import { type MetricReport, partsOf, type Report, type Tfa } from "../api/types";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { count, number, probability } from "../format";
import { timeText } from "../times";
import { metricTitle, quantityName } from "../views/metric-names";
import { reason } from "../views/verdicts";

export function Facts({ report }: { report: Report }): JSX.Element {
  const facts: [string, string][] = [
    ["Kind", report.kind],
    ["Job", report.job_id],
    ["Seed", String(report.seed)],
    ["Program", `trackloom ${report.engine_version}`],
  ];
  return (
    <>
      <p class="job-meta">
        {facts.map(([name, value]) => (
          <span>
            {name} {value}
          </span>
        ))}
      </p>
      {report.warnings.length ? (
        <ul class="warnings">
          {report.warnings.map((warning) => (
            <li>{warning}</li>
          ))}
        </ul>
      ) : null}
    </>
  );
}

interface Check {
  quantity: string;
  at_most?: number;
  at_least?: number;
  cell?: string;
  met: boolean;
  value?: number | null;
  reason?: string;
}

interface CheckReport {
  met: boolean;
  checks: Check[];
}

const bound = ({ at_most, at_least }: Check): string =>
  at_most === undefined ? `at least ${number(at_least)}` : `at most ${number(at_most)}`;

export function Limits({ report }: { report: Report }): JSX.Element | null {
  const { limits } = report.result as { limits?: CheckReport };
  const { requirements } = partsOf(report);
  if (!limits && !requirements) return null;
  return (
    <section class="panel">
      <h2>
        Limits{" "}
        {limits ? (
          <span class={`badge verdict-${limits.met ? "correct" : "false"}`}>
            {limits.met ? "all met" : "not met"}
          </span>
        ) : null}
      </h2>
      {limits ? (
        <TableScroll label="Limits">
          <table class="data">
            <HeadRow heads={["Quantity", "Limit", numberHead("Value"), "Met"]} />
            <tbody>
              {limits.checks.map((check) => (
                <tr>
                  <td>{[check.quantity, check.cell].filter(Boolean).join(", ")}</td>
                  <td>{bound(check)}</td>
                  <td class="num">{number(check.value)}</td>
                  <td>{check.met ? "yes" : `no${check.reason ? `: ${check.reason}` : ""}`}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      ) : null}
      {requirements ? (
        <TableScroll label="Requirements">
          <table class="data">
            <HeadRow heads={["Sector", "Requirement", "Verdict"]} />
            <tbody>
              {requirements.findings.map((finding) => (
                <tr>
                  <td>{finding.sector_id}</td>
                  <td>{finding.requirement}</td>
                  <td>{finding.verdict}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      ) : null}
    </section>
  );
}

export function Verdicts({ tfa, origin }: { tfa: Tfa; origin: number }): JSX.Element {
  const failures = tfa.targets.filter(({ verdict }) => verdict !== "correct");
  const targets = count(tfa.counts.targets);
  return (
    <section class="panel">
      <h2>Verdicts</h2>
      <p>
        {count(tfa.counts.correct)} correct, {count(tfa.counts.missed)} missed,{" "}
        {count(tfa.counts.false)} false of {targets} targets; correct per target{" "}
        {probability(tfa.ratios.correct_per_target)}.
      </p>
      {failures.length ? (
        <TableScroll label="Verdicts">
          <table class="data">
            <HeadRow heads={["Target", "Verdict", numberHead("At"), "Why"]} />
            <tbody>
              {failures.map((verdict) => (
                <tr>
                  <td class="mono">{verdict.truth_id}</td>
                  <td>{verdict.verdict}</td>
                  <td class="num">
                    {typeof verdict.at_time_s === "number"
                      ? timeText(verdict.at_time_s, origin)
                      : "–"}
                  </td>
                  <td>{reason(verdict)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      ) : null}
    </section>
  );
}

export function Metrics({ metrics }: { metrics: Record<string, MetricReport> }): JSX.Element {
  return (
    <section class="panel">
      <h2>Metrics</h2>
      <div class="report-metrics">
        {Object.entries(metrics).map(([name, metric]) => (
          <table class="data">
            <caption>{metricTitle(name)}</caption>
            <tbody>
              {Object.entries(metric.quantities).map(([quantity, { value, unit }]) => (
                <tr>
                  <td>{quantityName(name, quantity)}</td>
                  <td class="num">{number(value)}</td>
                  <td>{unit}</td>
                </tr>
              ))}
            </tbody>
          </table>
        ))}
      </div>
    </section>
  );
}
