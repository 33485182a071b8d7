// Everything that the metrics say: each quantity with its unit and parameters, over time and over
// other axes, and what happened.

import type { JSX } from "preact";
import { type Cell, type Job, type MetricReport, partsOf, type Report } from "../api/types";
import { Lines, lookOf, type Point } from "../charts/lines";
import { Empty, Link, Loading } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { number, words } from "../format";
import { boxesOf } from "../state/boxes";
import { useOrigin } from "../state/job-start";
import { hereHref, param, setParams } from "../state/url";
import { EventViews } from "./metric-events";
import { isCount, isOfShares, metricTitle, quantityName } from "./metric-names";
import { OverTime, parametersText } from "./metrics-over-time";

/** The events behind a count: of CLEAR, whose numbers are counts of the one log. */
const EVENTS_OF: Record<string, string> = {
  "clear.tp": "match",
  "clear.fn": "miss",
  "clear.fp": "false_alarm,redundant,divergence",
  "clear.fp_false_alarm": "false_alarm",
  "clear.fp_redundant": "redundant",
  "clear.fp_divergence": "divergence",
  "clear.idsw": "switch",
  "clear.frag": "reacquisition",
};

export function JobMetrics({ job, report }: { job: Job; report: Report }): JSX.Element {
  const { metrics = {}, sequences, events } = partsOf(report);
  const file = job.id.slice(-12);
  const names = (sequences ?? []).map((sequence) => sequence.name);
  const sequence = names.find((name) => name === param("sequence"));
  const shown = sequences?.find((entry) => entry.name === sequence)?.metrics ?? metrics;
  const origin = useOrigin(job.id);
  const boxes = useResource(() => boxesOf(report), [job.id]).data;
  if (origin === undefined || !boxes) return <Loading what="the metrics" />;
  const hasPlan = boxes.truths + boxes.tracks === 0;
  const ofSequence = names.length ? (sequence ?? names[0] ?? "") : "";
  return (
    <div class="summary">
      {names.length ? <SequenceChoice names={names} chosen={sequence} /> : null}
      <MetricTable metrics={shown} file={file} />
      <OverTime
        jobId={job.id}
        metrics={metrics}
        names={names}
        sequence={sequence}
        file={file}
        origin={origin}
      />
      <MetricCurves metrics={shown} file={file} />
      {events ? (
        <EventViews
          job={job}
          sequence={ofSequence}
          file={file}
          origin={origin}
          causes={events.causes}
          hasPlan={hasPlan}
        />
      ) : null}
    </div>
  );
}

function SequenceChoice({
  names,
  chosen,
}: {
  names: string[];
  chosen: string | undefined;
}): JSX.Element {
  return (
    <div class="filters">
      <label>
        <span>Sequence</span>
        <select
          value={chosen ?? ""}
          onChange={(event) => setParams({ sequence: event.currentTarget.value })}
        >
          <option value="">all together</option>
          {names.map((name) => (
            <option value={name}>{name}</option>
          ))}
        </select>
      </label>
    </div>
  );
}

function metricRows(metrics: Record<string, MetricReport>): Cell[][] {
  return Object.entries(metrics).flatMap(([name, metric]) => {
    const parameters = parametersText(metric);
    const rowOf = ([quantity, { value, unit, reason }]: Quantities[number]): Cell[] => [
      name,
      quantity,
      value ?? null,
      unit,
      reason ?? null,
      parameters,
    ];
    return Object.entries(metric.quantities).map(rowOf);
  });
}

function MetricTable({
  metrics,
  file,
}: {
  metrics: Record<string, MetricReport>;
  file: string;
}): JSX.Element {
  const find = (param("find") ?? "").toLowerCase();
  const table = (): TableData => ({
    columns: ["metric", "quantity", "value", "unit", "reason", "parameters"],
    rows: metricRows(metrics),
  });
  const tools = (
    <div class="filters frame-filters" role="search">
      <label class="grow">
        <span>Metric or quantity</span>
        <input
          type="search"
          data-filter
          value={param("find") ?? ""}
          placeholder="Press / to filter"
          onInput={(event) => setParams({ find: event.currentTarget.value })}
        />
      </label>
    </div>
  );
  const groups = Object.entries(metrics).flatMap(([name, metric]) => {
    const kept = Object.entries(metric.quantities).filter(([quantity]) =>
      matches(find, name, quantity),
    );
    return kept.length ? [{ name, metric, kept }] : [];
  });
  return (
    <TableFrame title="Metrics" file={`metrics-${file}`} table={table} tools={tools}>
      {groups.length ? (
        <div class="metric-groups">
          {groups.map(({ name, metric, kept }) => (
            <MetricGroup key={name} name={name} metric={metric} kept={kept} />
          ))}
        </div>
      ) : (
        <Empty title="No quantity matches this filter." />
      )}
    </TableFrame>
  );
}

/** By the name in the report or by the one that the field uses. */
function matches(find: string, metric: string, quantity: string): boolean {
  return [quantity, quantityName(metric, quantity)].some((name) =>
    `${metric} ${name}`.toLowerCase().includes(find),
  );
}

type Quantities = [string, MetricReport["quantities"][string]][];

function MetricGroup({
  name,
  metric,
  kept,
}: {
  name: string;
  metric: MetricReport;
  kept: Quantities;
}): JSX.Element {
  const isMissing = metric.value === null || metric.value === undefined;
  return (
    <section class="metric-group" aria-label={name}>
      <h3>
        {name}
        <span class="metric-headline">
          {`${isMissing ? "undefined" : number(metric.value)} `}
          {metric.unit}
        </span>
      </h3>
      <p class="muted small">
        {metric.higher_is_better ? "higher is better" : "lower is better"}
        {parametersText(metric) ? ` · ${parametersText(metric)}` : ""}
        {metric.reason ? ` · ${metric.reason}` : ""}
      </p>
      <dl class="facts">
        {kept.map(([quantity, { value, unit, reason }]) => (
          <>
            <dt title={quantity}>{quantityName(name, quantity)}</dt>
            <dd>
              {value === null || value === undefined ? (
                <span class="muted">{reason ?? "undefined"}</span>
              ) : (
                <Value name={`${name}.${quantity}`} text={number(value)} unit={unit} />
              )}
            </dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Value({ name, text, unit }: { name: string; text: string; unit: string }): JSX.Element {
  const kinds = EVENTS_OF[name];
  const shown = unit ? `${text} ${unit}` : text;
  if (!kinds) return <>{shown}</>;
  return (
    <Link href={hereHref({ event: kinds })} label={`${shown}: show the events`}>
      {shown}
    </Link>
  );
}

type MetricCurve = MetricReport["curves"][number];

/** The curves of one picture: of one metric over one axis, shares and counts apart. */
interface Panel {
  name: string;
  axis: string;
  kind: "shares" | "counts" | "values";
  curves: MetricCurve[];
}

function panelsOf(name: string, metric: MetricReport): Panel[] {
  const axes = [...new Set(metric.curves.map((curve) => curve.axis))];
  const kindOf = (curve: MetricCurve): Panel["kind"] =>
    isCount(name, curve.name) ? "counts" : isOfShares(name) ? "shares" : "values";
  const panels = axes.flatMap((axis) =>
    (["values", "shares", "counts"] as const).map((kind) => {
      return {
        name,
        axis,
        kind,
        curves: metric.curves.filter((curve) => curve.axis === axis && kindOf(curve) === kind),
      };
    }),
  );
  return panels.filter(({ curves }) => curves.length > 0);
}

function MetricCurves({
  metrics,
  file,
}: {
  metrics: Record<string, MetricReport>;
  file: string;
}): JSX.Element {
  const panels = Object.entries(metrics).flatMap(([name, metric]) => panelsOf(name, metric));
  return (
    <>
      {panels.map((panel) => (
        <CurvePanel key={`${panel.name} ${panel.axis} ${panel.kind}`} panel={panel} file={file} />
      ))}
    </>
  );
}

function yNameOf({ name, kind, curves }: Panel): string {
  if (kind === "shares") return "share";
  if (kind === "counts") return "count";
  return curves[0]?.unit ? `${metricTitle(name)} (${curves[0].unit})` : metricTitle(name);
}

function CurvePanel({ panel, file }: { panel: Panel; file: string }): JSX.Element {
  const { name, axis, kind, curves } = panel;
  const title = `${metricTitle(name)} over ${words(axis)}${kind === "counts" ? ": counts" : ""}`;
  const names = curves.map((curve) => quantityName(name, curve.name));
  const drawn = curves.map((curve, index) => {
    const points = curve.at.map((at, row): Point => [at, curve.values[row] ?? null]);
    return { name: names[index] ?? "", points, ...lookOf(index) };
  });
  const rows = (curves[0]?.at ?? []).map((at, row): Cell[] => [
    at,
    ...curves.map((curve) => curve.values[row] ?? null),
  ]);
  return (
    <Lines
      title={title}
      file={`${name}-${axis}${kind === "counts" ? "-counts" : ""}-${file}`}
      label={`${title}: ${names.join(", ")}.`}
      curves={drawn}
      xName={axis}
      yName={yNameOf(panel)}
      values={kind}
      table={() => ({ columns: [axis, ...names], rows })}
    />
  );
}
