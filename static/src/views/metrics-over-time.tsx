// The metrics over time: parts stacked where they add up to the metric, lines otherwise; a click
// moves the clock.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import { getMetricSeries } from "../api/client";
import type { Cell, MetricReport, MetricsSeries } from "../api/types";
import { reducedBadge } from "../charts/frame";
import { type Curve, Lines, lookOf, type Point } from "../charts/lines";
import { Empty, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { param, setParams } from "../state/url";
import { timeAxisName, timeText } from "../times";

/** A number without the dust of its binary digits: 0.15 for 0.15000000000000002. */
const clean = (value: number): number => Number(value.toPrecision(12));

function parameterText(value: unknown): string {
  if (typeof value === "string") return value;
  if (typeof value === "number") return String(clean(value));
  if (Array.isArray(value) && value.length > 2 && value.every((each) => typeof each === "number"))
    return listText(value);
  return JSON.stringify(value);
}

/** `0.05 to 0.95 in steps of 0.05`, where they are so. */
function listText(values: number[]): string {
  const step = ((values.at(-1) ?? 0) - (values[0] ?? 0)) / (values.length - 1);
  const isEven = values.every(
    (value, index) =>
      Math.abs(value - (values[0] ?? 0) - index * step) < 1e-9 * Math.max(Math.abs(value), 1),
  );
  if (!isEven || step === 0) return values.map(clean).join(", ");
  return `${clean(values[0] ?? 0)} to ${clean(values.at(-1) ?? 0)} in steps of ${clean(step)}`;
}

/** All that a metric was computed with. */
export function parametersText(metric: MetricReport): string {
  const parameters = Object.entries(metric.parameters as Record<string, unknown>);
  return parameters.map(([name, value]) => `${name} ${parameterText(value)}`).join(", ");
}

/**
 * The parts that add up to a metric, as exponents of the values of the series: GOSPA's are powers
 * already.
 */
function partsFor(
  name: string,
  metric: MetricReport | undefined,
): { parts: string[]; power: number } | undefined {
  const p = Number((metric?.parameters as { p?: unknown } | undefined)?.p ?? 2);
  if (/^gospa(_\d+)?$/.test(name))
    return { parts: ["localisation", "missed", "false", "switching"], power: 1 };
  return /^ospa(_\d+)?$/.test(name)
    ? { parts: ["localisation", "cardinality"], power: p }
    : undefined;
}

interface Shown {
  times: number[];
  values: Record<string, (number | null)[]>;
  units: Record<string, string>;
}

function rowsOf(series: MetricsSeries, sequence: string | undefined, names: string[]): Shown {
  const wanted = names.length ? (sequence ?? names[0]) : null;
  const { time_s, sequence: sequences, values } = series.columns;
  const rows = time_s
    .map((_, row) => row)
    .filter((row) => wanted === null || sequences[row] === wanted);
  const pick = <T,>(column: T[]): T[] => rows.map((row) => column[row] as T);
  const picked = Object.entries(values).map(([name, column]) => [name, pick(column)] as const);
  return { times: pick(time_s), values: Object.fromEntries(picked), units: series.units };
}

const PART_LOOKS: Record<string, number> = {
  localisation: 0,
  missed: 1,
  cardinality: 1,
  false: 2,
  switching: 3,
};

/** The metric's height, split in the proportion in which its parts add up to its p-th power. */
function stacked({ times, values }: Shown, { metric, stack }: Choice, origin: number): Curve[] {
  const { parts, power } = stack ?? { parts: [], power: 1 };
  const weight = (part: string, row: number) => (values[`${metric}.${part}`]?.[row] ?? 0) ** power;
  const there = parts.filter((part) => values[`${metric}.${part}`]?.some((value) => value !== 0));
  return there.map((part) => {
    const points = times.map((time, row): Point => {
      const total = values[`${metric}.${metric.replace(/_\d+$/, "")}`]?.[row];
      const sum = parts.reduce((all, name) => all + weight(name, row), 0);
      return [
        time - origin,
        total === null || total === undefined
          ? null
          : sum === 0
            ? 0
            : (total * weight(part, row)) / sum,
      ];
    });
    return { name: part, points, stack: true, ...lookOf(PART_LOOKS[part] ?? 0), look: "solid" };
  });
}

function plain({ times, values }: Shown, { columns }: Choice, origin: number): Curve[] {
  return columns.map((name, index) => {
    const points = times.map((time, row): Point => [time - origin, values[name]?.[row] ?? null]);
    return { name: name.split(".").slice(1).join("."), points, ...lookOf(index) };
  });
}

function curvesOf(shown: Shown | undefined, choice: Choice | undefined, origin: number): Curve[] {
  if (!shown || !choice) return [];
  return choice.stack ? stacked(shown, choice, origin) : plain(shown, choice, origin);
}

/**
 * What one chart can show: the columns of one metric that have one unit; the parts of a metric
 * together with it.
 */
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
    const choice = choices.get(name) ?? {
      name,
      metric,
      columns: [],
      unit: stack ? "m" : unit,
      ...(stack ? { stack } : {}),
    };
    choice.columns.push(column);
    choices.set(name, choice);
  }
  return [...choices.values()];
}

function nearestTime(times: number[], to: number): number {
  return times.reduce(
    (best, time) => (Math.abs(time - to) < Math.abs(best - to) ? time : best),
    times[0] ?? 0,
  );
}

interface MetricChoiceProps {
  choices: Choice[];
  choice: Choice;
  metric: MetricReport | undefined;
}

function MetricChoice({ choices, choice, metric }: MetricChoiceProps): JSX.Element {
  const parameters = metric ? parametersText(metric) : "";
  return (
    <div class="filters frame-filters">
      <label>
        <span>Metric</span>
        <select
          value={choice.name}
          onChange={(event) => setParams({ over: event.currentTarget.value })}
        >
          {choices.map((entry) => (
            <option value={entry.name}>{entry.name}</option>
          ))}
        </select>
      </label>
      <p class="muted small">
        {parameters}
        {parameters ? ". " : ""}A click moves the clock of all views.
        {choice.stack
          ? ` The height is ${choice.metric}; it is split as its parts add up to its p-th power.`
          : ""}
      </p>
    </div>
  );
}

interface OverTimeProps {
  jobId: string;
  metrics: Record<string, MetricReport>;
  names: string[];
  sequence: string | undefined;
  file: string;
  origin: number;
}

export function OverTime({
  jobId,
  metrics,
  names,
  sequence,
  file,
  origin,
}: OverTimeProps): JSX.Element {
  const series = useResource(() => getMetricSeries(jobId), [jobId]);
  const shown = useMemo(
    () => (series.data ? rowsOf(series.data, sequence, names) : undefined),
    [series.data, sequence],
  );
  const choices = useMemo(() => (shown ? choicesOf(shown, metrics) : []), [shown]);
  const choice = choices.find((entry) => entry.name === param("over")) ?? choices[0];
  const curves = useMemo(() => curvesOf(shown, choice, origin), [shown, choice, origin]);
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data || !shown) return <Loading what="the metrics over time" />;
  if (!choice || !shown.times.length)
    return <Empty title="These metrics have no values over time." />;
  const curveNames = curves.map((curve) => curve.name);
  const table = (): TableData => ({
    columns: [
      "time_s",
      ...choice.columns.map((name) =>
        shown.units[name] ? `${name} (${shown.units[name]})` : name,
      ),
    ],
    rows: shown.times.map((time, row): Cell[] => [
      time,
      ...choice.columns.map((name) => shown.values[name]?.[row] ?? null),
    ]),
    origin_s: origin,
  });
  return (
    <Lines
      title={`${choice.metric} over time`}
      file={`metric-${choice.metric}-${file}`}
      label={`${choice.metric} at ${shown.times.length} times: ${curveNames.join(", ")}.`}
      curves={curves}
      xName={timeAxisName(origin)}
      yName={choice.unit ? `${choice.metric} (${choice.unit})` : choice.metric}
      xText={(time) => timeText(time + origin, origin)}
      cursor={param("time") === null ? undefined : Number(param("time")) - origin}
      pick={(x) => setParams({ time: nearestTime(shown.times, x + origin) })}
      table={table}
      badge={reducedBadge([{ ...series.data, name: "times" }])}
      tools={<MetricChoice choices={choices} choice={choice} metric={metrics[choice.metric]} />}
    />
  );
}
