// One metric over time, a line a job: what the paired differences are made of.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import { getMetricSeries } from "../api/client";
import type { Cell, Comparison, MetricsSeries } from "../api/types";
import { type Curve, Lines, lookOf, type Point } from "../charts/lines";
import { Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { param, setParams } from "../state/url";
import { originOf, timeAxisName, timeText } from "../times";

interface Side {
  name: string;
  series: MetricsSeries;
}

/**
 * The series of the jobs that have metrics over time; a job of several sequences has no single one.
 */
async function load(comparison: Comparison, names: string[]): Promise<Side[]> {
  const all = await Promise.all(
    comparison.jobs.map(async (job, index) =>
      job.kind === "evaluate"
        ? { name: names[index] ?? "", series: await getMetricSeries(job.id) }
        : undefined,
    ),
  );
  return all
    .filter((side) => side !== undefined)
    .filter(
      ({ series }) =>
        series.columns.time_s.length > 0 &&
        series.columns.sequence.every((sequence) => sequence === null),
    );
}

function columnsOf(sides: Side[]): string[] {
  const first = Object.keys(sides[0]?.series.columns.values ?? {});
  return first.filter(
    (name) => sides.filter((side) => side.series.columns.values[name]).length > 1,
  );
}

/** `gospa.gospa`: what the metric is called after. */
function isHeadline(column: string): boolean {
  const [metric, quantity] = column.split(".");
  return metric === quantity;
}

function curvesOf(sides: Side[], column: string, origin: number): Curve[] {
  return sides.flatMap(({ name, series }, index) => {
    const values = series.columns.values[column];
    if (!values) return [];
    return {
      name,
      points: series.columns.time_s.map((time, row): Point => [time - origin, values[row] ?? null]),
      ...lookOf(index),
    };
  });
}

export function Overlay({
  comparison,
  names,
}: {
  comparison: Comparison;
  names: string[];
}): JSX.Element | null {
  const sides = useResource(() => load(comparison, names), [comparison]);
  const columns = useMemo(() => (sides.data ? columnsOf(sides.data) : []), [sides.data]);
  const column =
    columns.find((name) => name === param("over")) ?? columns.find(isHeadline) ?? columns[0];
  const times = sides.data?.[0]?.series.columns.time_s ?? [];
  const origin = originOf(times[0]);
  const curves = useMemo(
    () => (sides.data && column ? curvesOf(sides.data, column, origin) : []),
    [sides.data, column],
  );
  if (sides.error) return <ProblemBox error={sides.error} retry={sides.reload} />;
  if (!sides.data) return <Loading what="the metrics over time" />;
  if (!column) return null;
  const unit = sides.data[0]?.series.units[column];
  const rowsOf = ({ name, points }: Curve) =>
    points.map(([time, value]): Cell[] => [name, time + origin, value]);
  const columnNames = ["job", "time_s", unit ? `${column} (${unit})` : column];
  const table = (): TableData => ({
    columns: columnNames,
    rows: curves.flatMap(rowsOf),
    origin_s: origin,
  });
  const tools = (
    <div class="filters frame-filters">
      <label>
        <span>Metric</span>
        <select value={column} onChange={(event) => setParams({ over: event.currentTarget.value })}>
          {columns.map((name) => (
            <option value={name}>{name}</option>
          ))}
        </select>
      </label>
    </div>
  );
  return (
    <Lines
      title={`${column} of every job`}
      file={`compared-${column}`}
      label={`${column} over time for ${curves.length} jobs.`}
      curves={curves}
      xName={timeAxisName(origin)}
      yName={unit ? `${column} (${unit})` : column}
      xText={(time) => timeText(time + origin, origin)}
      table={table}
      tools={tools}
    />
  );
}
