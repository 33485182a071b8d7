// Everything that the metrics say: each quantity with its unit and parameters, the metrics over time, and the events behind the counts.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import { getMetricSeries } from "../api/client";
import { partsOf, type Cell, type Job, type MetricReport, type MetricsSeries, type Report } from "../api/types";
import { timeAxisName, timeOrigin, timeText } from "../charts/axes";
import { reducedBadge } from "../charts/frame";
import { Lanes, placeOf } from "../charts/lanes";
import { Lines, lookOf, type Curve, type Point } from "../charts/lines";
import { Empty, Link, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { capital, count, number, words } from "../format";
import { hereHref, param, setParams } from "../state/url";
import { lanesOf, readEvents, type EventLog } from "../charts/event-log";

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
const LANES_AT_ONCE = 40;
const EVENTS_AT_ONCE = 200;

export function JobMetrics({ job, report }: { job: Job; report: Report }): JSX.Element {
  const { metrics = {}, sequences, events } = partsOf(report);
  const file = job.id.slice(-12);
  const names = (sequences ?? []).map((sequence) => sequence.name);
  const sequence = names.find((name) => name === param("sequence"));
  const shown = sequences?.find((entry) => entry.name === sequence)?.metrics ?? metrics;
  return (
    <div class="summary">
      {names.length ? <SequenceChoice names={names} chosen={sequence} /> : null}
      <MetricTable metrics={shown} file={file} />
      <OverTime jobId={job.id} metrics={metrics} names={names} sequence={sequence} file={file} />
      <MetricCurves metrics={shown} file={file} />
      {events ? <EventViews job={job} sequence={names.length ? (sequence ?? names[0] ?? "") : ""} file={file} /> : null}
    </div>
  );
}

function SequenceChoice({ names, chosen }: { names: string[]; chosen: string | undefined }): JSX.Element {
  return (
    <div class="filters">
      <label>
        <span>Sequence</span>
        <select value={chosen ?? ""} onChange={(event) => setParams({ sequence: event.currentTarget.value })}>
          <option value="">all together</option>
          {names.map((name) => (
            <option value={name}>{name}</option>
          ))}
        </select>
      </label>
    </div>
  );
}

function parametersText(metric: MetricReport): string {
  return Object.entries(metric.parameters as Record<string, unknown>)
    .map(([name, value]) => `${name} ${typeof value === "string" ? value : JSON.stringify(value)}`)
    .join(", ");
}

function metricRows(metrics: Record<string, MetricReport>): Cell[][] {
  return Object.entries(metrics).flatMap(([name, metric]) => {
    const parameters = parametersText(metric);
    return Object.entries(metric.quantities).map(([quantity, { value, unit, reason }]): Cell[] => [name, quantity, value ?? null, unit, reason ?? null, parameters]);
  });
}

function MetricTable({ metrics, file }: { metrics: Record<string, MetricReport>; file: string }): JSX.Element {
  const find = (param("find") ?? "").toLowerCase();
  const table = (): TableData => ({ columns: ["metric", "quantity", "value", "unit", "reason", "parameters"], rows: metricRows(metrics) });
  const tools = (
    <div class="filters frame-filters" role="search">
      <label class="grow">
        <span>Metric or quantity</span>
        <input type="search" data-filter value={param("find") ?? ""} placeholder="Press / to filter" onInput={(event) => setParams({ find: event.currentTarget.value })} />
      </label>
    </div>
  );
  const groups = Object.entries(metrics).flatMap(([name, metric]) => {
    const kept = Object.entries(metric.quantities).filter(([quantity]) => !find || `${name} ${quantity}`.includes(find));
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

type Quantities = [string, MetricReport["quantities"][string]][];

function MetricGroup({ name, metric, kept }: { name: string; metric: MetricReport; kept: Quantities }): JSX.Element {
  return (
    <section class="metric-group" aria-label={name}>
      <h3>
        {name}
        <span class="metric-headline">
          {metric.value === null || metric.value === undefined ? "undefined" : number(metric.value)} {metric.unit}
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
            <dt title={quantity}>{quantity.replaceAll("_", " ")}</dt>
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

/** The parts that add up to a metric, as exponents of the values of the series: GOSPA's are powers already. */
function partsFor(name: string, metric: MetricReport | undefined): { parts: string[]; power: number } | undefined {
  const p = Number((metric?.parameters as { p?: unknown } | undefined)?.p ?? 2);
  if (/^gospa(_\d+)?$/.test(name)) return { parts: ["localisation", "missed", "false", "switching"], power: 1 };
  return /^ospa(_\d+)?$/.test(name) ? { parts: ["localisation", "cardinality"], power: p } : undefined;
}

interface Shown {
  times: number[];
  values: Record<string, (number | null)[]>;
  units: Record<string, string>;
}

function rowsOf(series: MetricsSeries, sequence: string | undefined, names: string[]): Shown {
  const wanted = names.length ? (sequence ?? names[0]) : null;
  const rows = series.columns.time_s.map((_, row) => row).filter((row) => wanted === null || series.columns.sequence[row] === wanted);
  const pick = <T,>(column: T[]): T[] => rows.map((row) => column[row] as T);
  return { times: pick(series.columns.time_s), values: Object.fromEntries(Object.entries(series.columns.values).map(([name, column]) => [name, pick(column)])), units: series.units };
}

const PART_LOOKS: Record<string, number> = { localisation: 0, missed: 1, cardinality: 1, false: 2, switching: 3 };

/** The metric's height, split in the proportion in which its parts add up to its p-th power. */
function stacked({ times, values }: Shown, metric: string, parts: string[], power: number): Curve[] {
  const origin = timeOrigin(times);
  const weight = (part: string, row: number) => (values[`${metric}.${part}`]?.[row] ?? 0) ** power;
  const there = parts.filter((part) => values[`${metric}.${part}`]?.some((value) => value !== 0));
  return there.map((part) => {
    const points = times.map((time, row): Point => {
      const total = values[`${metric}.${metric.replace(/_\d+$/, "")}`]?.[row];
      const sum = parts.reduce((all, name) => all + weight(name, row), 0);
      return [time - origin, total === null || total === undefined ? null : sum === 0 ? 0 : (total * weight(part, row)) / sum];
    });
    return { name: part, points, stack: true, ...lookOf(PART_LOOKS[part] ?? 0), look: "solid" };
  });
}

function plain({ times, values }: Shown, names: string[]): Curve[] {
  const origin = timeOrigin(times);
  return names.map((name, index) => ({ name: name.split(".").slice(1).join("."), points: times.map((time, row): Point => [time - origin, values[name]?.[row] ?? null]), ...lookOf(index) }));
}

/** What one chart can show: the columns of one metric that have one unit; the parts of a metric together with it. */
interface Choice {
  name: string;
  metric: string;
  columns: string[];
  unit: string;
  stack?: { parts: string[]; power: number };
}

function choicesOf(shown: Shown, metrics: Record<string, MetricReport>): Choice[] {
  const choices = new Map<string, Choice>();
  for (const column of Object.keys(shown.values)) {
    const metric = column.split(".")[0] ?? "";
    const stack = partsFor(metric, metrics[metric]);
    const unit = shown.units[column] ?? "";
    const name = stack ? metric : unit ? `${metric} (${unit})` : metric;
    const choice = choices.get(name) ?? { name, metric, columns: [], unit: stack ? "m" : unit, ...(stack ? { stack } : {}) };
    choice.columns.push(column);
    choices.set(name, choice);
  }
  return [...choices.values()];
}

function nearestTime(times: number[], to: number): number {
  return times.reduce((best, time) => (Math.abs(time - to) < Math.abs(best - to) ? time : best), times[0] ?? 0);
}

interface OverTimeProps {
  jobId: string;
  metrics: Record<string, MetricReport>;
  names: string[];
  sequence: string | undefined;
  file: string;
}

function OverTime({ jobId, metrics, names, sequence, file }: OverTimeProps): JSX.Element {
  const series = useResource(() => getMetricSeries(jobId), [jobId]);
  const shown = useMemo(() => (series.data ? rowsOf(series.data, sequence, names) : undefined), [series.data, sequence]);
  const choices = useMemo(() => (shown ? choicesOf(shown, metrics) : []), [shown]);
  const choice = choices.find((entry) => entry.name === param("over")) ?? choices[0];
  const curves = useMemo(() => (shown && choice ? (choice.stack ? stacked(shown, choice.metric, choice.stack.parts, choice.stack.power) : plain(shown, choice.columns)) : []), [shown, choice]);
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data || !shown) return <Loading what="the metrics over time" />;
  if (!choice || !shown.times.length) return <Empty title="These metrics have no values over time." />;
  const parameters = metrics[choice.metric] ? parametersText(metrics[choice.metric] as MetricReport) : "";
  const table = (): TableData => ({
    columns: ["time_s", ...choice.columns.map((name) => (shown.units[name] ? `${name} (${shown.units[name]})` : name))],
    rows: shown.times.map((time, row): Cell[] => [time, ...choice.columns.map((name) => shown.values[name]?.[row] ?? null)]),
  });
  const tools = (
    <div class="filters frame-filters">
      <label>
        <span>Metric</span>
        <select value={choice.name} onChange={(event) => setParams({ over: event.currentTarget.value })}>
          {choices.map((entry) => (
            <option value={entry.name}>{entry.name}</option>
          ))}
        </select>
      </label>
      <p class="muted small">
        {parameters}
        {parameters ? ". " : ""}A click moves the clock of all views.
        {choice.stack ? ` The height is ${choice.metric}; it is split as its parts add up to its p-th power.` : ""}
      </p>
    </div>
  );
  return (
    <Lines
      title={`${choice.metric} over time`}
      file={`metric-${choice.metric}-${file}`}
      label={`${choice.metric} at ${shown.times.length} times: ${curves.map((curve) => curve.name).join(", ")}.`}
      curves={curves}
      xName={timeAxisName(shown.times)}
      yName={choice.unit ? `${choice.metric} (${choice.unit})` : choice.metric}
      xText={(time) => timeText(time + timeOrigin(shown.times), shown.times)}
      cursor={param("time") === null ? undefined : Number(param("time")) - timeOrigin(shown.times)}
      pick={(x) => setParams({ time: nearestTime(shown.times, x + timeOrigin(shown.times)) })}
      table={table}
      badge={reducedBadge([{ ...series.data, name: "times" }])}
      tools={tools}
    />
  );
}

function MetricCurves({ metrics, file }: { metrics: Record<string, MetricReport>; file: string }): JSX.Element {
  const groups = Object.entries(metrics).flatMap(([name, metric]) => {
    const axes = [...new Set(metric.curves.map((curve) => curve.axis))];
    return axes.map((axis) => ({ name, axis, curves: metric.curves.filter((curve) => curve.axis === axis) }));
  });
  return (
    <>
      {groups.map(({ name, axis, curves }) => (
        <Lines
          key={`${name} ${axis}`}
          title={`${name} over ${words(axis)}`}
          file={`${name}-${axis}-${file}`}
          label={`${curves.length} curves of ${name} over ${axis}.`}
          curves={curves.map((curve, index) => ({ name: curve.name, points: curve.at.map((at, row): Point => [at, curve.values[row] ?? null]), ...lookOf(index) }))}
          xName={axis}
          yName={curves[0]?.unit ? `${name} (${curves[0].unit})` : name}
          table={() => ({ columns: [axis, ...curves.map((curve) => curve.name)], rows: (curves[0]?.at ?? []).map((at, row): Cell[] => [at, ...curves.map((curve) => curve.values[row] ?? null)]) })}
        />
      ))}
    </>
  );
}

function EventViews({ job, sequence, file }: { job: Job; sequence: string; file: string }): JSX.Element {
  const log = useResource(() => readEvents(job.id), [job.id]);
  if (log.error) return <ProblemBox error={log.error} retry={log.reload} />;
  if (!log.data) return <Loading what="the events" />;
  return (
    <>
      <LaneView log={log.data} sequence={sequence} file={file} />
      <EventTable log={log.data} sequence={sequence} file={file} />
    </>
  );
}

function LaneView({ log, sequence, file }: { log: EventLog; sequence: string; file: string }): JSX.Element | null {
  const all = useMemo(() => lanesOf(log.entries, sequence).sort((a, b) => b.marks.length - a.marks.length), [log, sequence]);
  const from = Math.max(Number(param("lanes")) || 0, 0);
  if (!all.length) return null;
  const lanes = all.slice(from, from + LANES_AT_ONCE);
  const turn = (to: number) => () => setParams({ lanes: to || null });
  return (
    <div>
      <Lanes lanes={lanes} total={all.length} file={`lanes-${file}`} />
      {all.length > LANES_AT_ONCE ? (
        <p class="more">
          <button type="button" disabled={from === 0} onClick={turn(Math.max(from - LANES_AT_ONCE, 0))}>
            Previous
          </button>
          <span class="muted">
            targets {from + 1} to {from + lanes.length} of {count(all.length)}, those with most marks first
          </span>
          <button type="button" disabled={from + LANES_AT_ONCE >= all.length} onClick={turn(from + LANES_AT_ONCE)}>
            Next
          </button>
        </p>
      ) : null}
    </div>
  );
}

function EventTable({ log, sequence, file }: { log: EventLog; sequence: string; file: string }): JSX.Element {
  const head = useRef<HTMLDivElement>(null);
  const chosen = param("event");
  useEffect(() => {
    // Who comes by the link of a number wants to see its events.
    if (chosen) head.current?.scrollIntoView({ block: "nearest" });
  }, [chosen]);
  const kinds = [...new Set(log.entries.map((entry) => entry.kind))].sort();
  const asked = (chosen ?? "switch,break").split(",");
  const found = log.entries.filter((entry) => entry.sequence === sequence && asked.includes(entry.kind));
  const table = (): TableData => ({ columns: ["step", "time_s", "event", "truth_id", "track_id", "distance"], rows: found.map((entry): Cell[] => [entry.step, entry.time, entry.kind, entry.truth || null, entry.track || null, entry.distance]) });
  const tools = (
    <div class="filters frame-filters" ref={head}>
      <label>
        <span>Events</span>
        <select value={asked.join(",")} onChange={(event) => setParams({ event: event.currentTarget.value })}>
          {kinds.includes(asked.join(",")) ? null : <option value={asked.join(",")}>{asked.map(words).join(", ")}</option>}
          {kinds.map((kind) => (
            <option value={kind}>{words(kind)}</option>
          ))}
        </select>
      </label>
      <p class="muted small">
        {count(found.length)} events, {count(Math.min(found.length, EVENTS_AT_ONCE))} shown
        {log.isCut ? "; the file has more than were read here" : ""}
      </p>
    </div>
  );
  return (
    <TableFrame title="Events" file={`events-${file}`} table={table} tools={tools}>
      {found.length ? (
        <div class="table-scroll tall" tabIndex={0} role="region" aria-label="Events">
          <table class="data">
            <thead>
              <tr>
                {["Time (s)", "Event", "Truth", "Track", "Distance"].map((name) => (
                  <th scope="col" class={name === "Time (s)" || name === "Distance" ? "num" : undefined}>
                    {name}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {found.slice(0, EVENTS_AT_ONCE).map((entry) => (
                <tr>
                  <td class="num">
                    <Link href={placeOf(entry.truth, entry.track, entry.time)} label={`Show ${words(entry.kind)} at ${number(entry.time)} s in the plan view`}>
                      {number(entry.time)}
                    </Link>
                  </td>
                  <td>{capital(words(entry.kind))}</td>
                  <td class="mono">{entry.truth || "–"}</td>
                  <td class="mono">{entry.track || "–"}</td>
                  <td class="num">{number(entry.distance)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      ) : (
        <Empty title="There is no such event." />
      )}
    </TableFrame>
  );
}
