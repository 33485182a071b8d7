// Requirements of air surveillance: a row per sector and requirement, with the targets that fail.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import type { RequirementFinding, RequirementsReport } from "../api/types";
import { Empty } from "../components/basics";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { count, number, plural, words } from "../format";
import { param, setParams } from "../state/url";

const TARGETS_AT_ONCE = 5;

const isFailed = ({ verdict }: RequirementFinding): boolean => verdict === "fail";

const verdictWord = ({ verdict, comparison }: RequirementFinding): string =>
  verdict ?? (comparison ? "no value" : "no threshold");

const withUnit = (value: number | null | undefined, unit: string): string =>
  value === null || value === undefined ? "–" : `${number(value)} ${unit}`.trim();

/** Why there is no value, or what was left out of it. */
function leftOut({ not_judged }: RequirementFinding): string {
  return Object.entries(not_judged)
    .map(([reason, updates]) => `${words(reason)} ${count(updates)}`)
    .join(", ");
}

function failedText({ failed_targets, failed_target_count }: RequirementFinding): string {
  const named = failed_targets.slice(0, TARGETS_AT_ONCE).map(({ truth_id }) => truth_id);
  const more = failed_target_count - named.length;
  return more > 0 ? `${named.join(", ")} and ${count(more)} more` : named.join(", ");
}

export function tableOf(findings: RequirementFinding[]): TableData {
  const columns = [
    ...["sector", "requirement", "phase", "verdict", "value", "unit", "comparison", "threshold"],
    ...["margin", "numerator", "denominator", "low", "high", "failed_targets"],
  ];
  const rows = findings.map((one) => [
    ...[one.sector_id, one.requirement, one.phase ?? "", verdictWord(one)],
    ...[one.value ?? null, one.unit, one.comparison ?? "", one.threshold ?? null],
    ...[one.margin ?? null, one.numerator, one.denominator],
    ...[one.interval_95?.low ?? null, one.interval_95?.high ?? null, one.failed_target_count],
  ]);
  return { columns, rows };
}

export function JobRequirements({
  report,
  file,
}: {
  report: RequirementsReport;
  file: string;
}): JSX.Element {
  const only = param("requirements") === "failed";
  const shown = useMemo(
    () => report.findings.filter((one) => !only || isFailed(one)),
    [report, only],
  );
  const failed = report.findings.filter(isFailed).length;
  const tools = (
    <label>
      <input
        type="checkbox"
        checked={only}
        onChange={(event) =>
          setParams({ requirements: event.currentTarget.checked ? "failed" : null })
        }
      />{" "}
      Failed only
    </label>
  );
  return (
    <TableFrame
      title="Requirements"
      file={`requirements-${file}`}
      table={() => tableOf(shown)}
      tools={tools}
    >
      <p class="muted small">
        {count(failed)} of {plural(report.findings.length, "requirement")} failed. Updates found
        their target by identity {count(report.updates.by_identity)}, by place{" "}
        {count(report.updates.by_place)}, by the rest of their track{" "}
        {count(report.updates.by_track)}; {count(report.updates.nobody)} are of nobody. Every fault
        is in requirement_events.csv.
      </p>
      {shown.length ? <Rows findings={shown} /> : <Empty title="No requirement failed." />}
    </TableFrame>
  );
}

function Rows({ findings }: { findings: RequirementFinding[] }): JSX.Element {
  const heads = [
    ...["Sector", "Requirement", "Verdict"],
    ...["Value", "95 %", "Wanted", "Margin", "Counts", "Failed targets"].map(numberHead),
    ...["Which", "Not judged"],
  ];
  return (
    <TableScroll label="Requirements">
      <table class="data">
        <HeadRow heads={heads} />
        <tbody>
          {findings.map((one) => (
            <Row one={one} />
          ))}
        </tbody>
      </table>
    </TableScroll>
  );
}

function Verdict({ one }: { one: RequirementFinding }): JSX.Element {
  const name = verdictWord(one);
  if (!one.verdict) return <span class="muted">{name}</span>;
  return <span class={`badge verdict-${isFailed(one) ? "false" : "correct"}`}>{name}</span>;
}

function Row({ one }: { one: RequirementFinding }): JSX.Element {
  const interval = one.interval_95;
  const wanted = one.comparison ? `${one.comparison} ${withUnit(one.threshold, one.unit)}` : "–";
  return (
    <tr>
      <td>{one.sector_id}</td>
      <td>{one.phase ? `${one.requirement}, ${one.phase}` : one.requirement}</td>
      <td>
        <Verdict one={one} />
      </td>
      <td class="num">{withUnit(one.value, one.unit)}</td>
      <td class="num">{interval ? `${number(interval.low)} to ${number(interval.high)}` : "–"}</td>
      <td class="num">{wanted}</td>
      <td class="num">{withUnit(one.margin, one.unit)}</td>
      <td class="num">
        {one.denominator
          ? `${count(one.numerator)} of ${count(one.denominator)}`
          : count(one.numerator)}
      </td>
      <td class="num">{count(one.failed_target_count)}</td>
      <td>{failedText(one)}</td>
      <td>{leftOut(one)}</td>
    </tr>
  );
}
