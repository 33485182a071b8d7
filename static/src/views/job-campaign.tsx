// A campaign: every cell of its grid, curves over an axis, differences run by run, and what
// deciding cost.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import type { CampaignCell, Cell } from "../api/types";
import { CategoryDots, type Estimate, type Row } from "../charts/category-dots";
import { type Curve, Lines, lookOf, type Point } from "../charts/lines";
import { Empty } from "../components/basics";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { count, intervalText, number, plural } from "../format";
import { param, setParams } from "../state/url";
import {
  type Axis,
  cellAt,
  combinations,
  isNumeric,
  pointsOf,
  rowsAndColumns,
} from "./campaign-axes";
import { type Campaign, CURVES_UP_TO, Differences, Times } from "./campaign-parts";
import { CellTable } from "./cell-table";

export function JobCampaign({ campaign }: { campaign: Campaign }): JSX.Element {
  const outcome =
    campaign.outcomes.find((name) => name === param("outcome")) ?? campaign.outcomes[0];
  if (!outcome) return <Empty title="No run gave a number." />;
  const x =
    campaign.axes.find((axis) => axis.name === param("x")) ??
    campaign.axes.find(isNumeric) ??
    campaign.axes[0];
  return (
    <div class="summary">
      <Choices campaign={campaign} outcome={outcome} x={x} />
      <Grid campaign={campaign} outcome={outcome} />
      {x && x.points.length > 1 ? <Curves campaign={campaign} outcome={outcome} x={x} /> : null}
      <Differences campaign={campaign} outcome={outcome} />
      {campaign.times.length ? <Times campaign={campaign} x={x} /> : null}
      <Everything campaign={campaign} />
    </div>
  );
}

function Choices({
  campaign,
  outcome,
  x,
}: {
  campaign: Campaign;
  outcome: string;
  x: Axis | undefined;
}): JSX.Element {
  const select = (name: string, label: string, values: string[], value: string) => (
    <label>
      <span>{label}</span>
      <select value={value} onChange={(event) => setParams({ [name]: event.currentTarget.value })}>
        {values.map((each) => (
          <option value={each}>{each}</option>
        ))}
      </select>
    </label>
  );
  return (
    <div class="filters">
      {select("outcome", "Outcome", campaign.outcomes, outcome)}
      {campaign.axes.length > 1 && x
        ? select(
            "x",
            "Over",
            campaign.axes.map((axis) => axis.name),
            x.name,
          )
        : null}
      {x && isNumeric(x) && x.points.every((point) => Number(point) > 0) ? (
        <label class="check-label">
          <input
            type="checkbox"
            checked={param("log") === "1"}
            onChange={(event) => setParams({ log: event.currentTarget.checked ? "1" : null })}
          />{" "}
          logarithmic axis
        </label>
      ) : null}
    </div>
  );
}

function meanOf(cell: CampaignCell | undefined, outcome: string): number | null {
  return cell?.outcomes[outcome]?.mean ?? null;
}

function Grid({ campaign, outcome }: { campaign: Campaign; outcome: string }): JSX.Element {
  const { rows, columns } = rowsAndColumns(campaign.axes);
  const means = campaign.cells.map((cell) => meanOf(cell, outcome)).filter((mean) => mean !== null);
  const [low, high] = [Math.min(...means), Math.max(...means)];
  const shade = (mean: number | null) =>
    mean === null || high === low ? 0 : (mean - low) / (high - low);
  const table = (): TableData => ({
    columns: [...rows.map((axis) => axis.name), ...columns.points],
    rows: combinations(rows).map((points) => [
      ...points,
      ...columns.points.map((point) => meanOf(find(points, point), outcome)),
    ]),
  });
  const find = (points: string[], point: string) =>
    campaign.axes.length
      ? cellAt(campaign.cells, campaign.axes, { ...pointsOf(rows, points), [columns.name]: point })
      : campaign.cells[0];
  return (
    <TableFrame title={`Cells: ${outcome}`} file={`grid-${campaign.file}`} table={table}>
      <CellTable
        axes={campaign.axes}
        label={`Mean of ${outcome} in every cell`}
        class="tall"
        cell={(points, point) => (
          <GridCell
            cell={find(points, point)}
            outcome={outcome}
            shade={shade}
            planned={campaign.runs}
          />
        )}
      />
    </TableFrame>
  );
}

interface GridCellProps {
  cell: CampaignCell | undefined;
  outcome: string;
  shade: (mean: number | null) => number;
  planned: number;
}

function runsOf(cell: CampaignCell, withNumber: number, planned: number): string {
  if (cell.ended === "not_yet") return `${count(cell.runs)} of ${count(planned)} runs`;
  return plural(withNumber, "run");
}

function GridCell({ cell, outcome, shade, planned }: GridCellProps): JSX.Element {
  const summary = cell?.outcomes[outcome];
  if (!cell || !summary) return <td class="num muted">no run</td>;
  const { mean, interval, missing, method } = summary;
  return (
    <td
      class="num grid-cell"
      style={{ "--shade": shade(mean ?? null).toFixed(3) }}
      title={`${cell.name}: ${method} interval of ${summary.count} runs`}
    >
      <b>{number(mean)}</b>
      <span class="sub">{interval ? intervalText(interval) : "no interval"}</span>
      <span class="sub">
        {runsOf(cell, summary.count, planned)}
        {missing ? `, ${count(missing)} without` : ""}
        {cell.ended === "half_width" ? ", narrow enough" : ""}
      </span>
    </td>
  );
}

function curvesOf(campaign: Campaign, outcome: string, x: Axis): Curve[] {
  const others = campaign.axes.filter((axis) => axis !== x);
  return combinations(others).map((points, order) => {
    const cells = x.points.map((point) =>
      cellAt(campaign.cells, campaign.axes, { ...pointsOf(others, points), [x.name]: point }),
    );
    const place = (index: number) => Number(x.points[index]);
    const sorted = cells.map((_, index) => index).sort((a, b) => place(a) - place(b));
    return {
      name: points.join(", ") || outcome,
      points: sorted.map((index): Point => [place(index), meanOf(cells[index], outcome)]),
      band: sorted.map((index) => {
        const interval = cells[index]?.outcomes[outcome]?.interval;
        return interval ? ([interval.low, interval.high] as [number, number]) : null;
      }),
      ...lookOf(order),
    };
  });
}

const CURVE_COLUMNS = ["mean", "low", "high"];

function curveTable(curves: Curve[], x: Axis): TableData {
  const rowsOf = ({ name, points, band }: Curve) =>
    points.map(([at, mean], index): Cell[] => [
      name,
      at,
      mean,
      band?.[index]?.[0] ?? null,
      band?.[index]?.[1] ?? null,
    ]);
  return { columns: ["curve", x.name, ...CURVE_COLUMNS], rows: curves.flatMap(rowsOf) };
}

interface CurvesProps {
  campaign: Campaign;
  outcome: string;
  x: Axis;
}

function Curves(props: CurvesProps): JSX.Element {
  return isNumeric(props.x) ? <NumericCurves {...props} /> : <Dots {...props} />;
}

function NumericCurves({ campaign, outcome, x }: CurvesProps): JSX.Element {
  const all = useMemo(() => curvesOf(campaign, outcome, x), [campaign, outcome, x]);
  const curves = useMemo(() => all.slice(0, CURVES_UP_TO), [all]);
  const badge =
    all.length > curves.length
      ? `Shown: ${curves.length} of ${all.length} curves; the table below has all`
      : undefined;
  const percent = number(campaign.confidence * 100);
  const title = `${outcome} over ${x.name}`;
  return (
    <Lines
      title={title}
      file={`curves-${campaign.file}`}
      label={`${title}: ${plural(curves.length, "curve")} with ${percent} % bands.`}
      curves={curves}
      xName={x.name}
      yName={outcome}
      logX={param("log") === "1"}
      table={() => curveTable(all, x)}
      badge={badge}
      tools={
        <p class="muted small frame-note">
          Mean of the runs of a cell; the band is its {percent} % interval.
        </p>
      }
      class="curves-canvas"
    />
  );
}

function estimateOf(cell: CampaignCell | undefined, outcome: string): Estimate | undefined {
  const summary = cell?.outcomes[outcome];
  if (summary?.mean === null || summary?.mean === undefined) return undefined;
  return {
    mean: summary.mean,
    low: summary.interval?.low,
    high: summary.interval?.high,
    runs: summary.count,
  };
}

/** The points of an axis of names have no order, and nothing between them. */
function Dots({ campaign, outcome, x }: CurvesProps): JSX.Element {
  const others = campaign.axes.filter((axis) => axis !== x);
  const combined = combinations(others);
  const shown = combined.slice(0, CURVES_UP_TO);
  const rowOf = (point: string, series: string[][]): Row => {
    const cell = (points: string[]) =>
      cellAt(campaign.cells, campaign.axes, { ...pointsOf(others, points), [x.name]: point });
    return { name: point, estimates: series.map((points) => estimateOf(cell(points), outcome)) };
  };
  const nameOf = (points: string[]) => points.join(", ") || outcome;
  const table = (): TableData => {
    const rows = x.points.flatMap((point) =>
      rowOf(point, combined).estimates.map((estimate, index): Cell[] => {
        const { mean = null, low = null, high = null, runs = null } = estimate ?? {};
        return [nameOf(combined[index] ?? []), point, mean, low, high, runs];
      }),
    );
    return { columns: ["curve", x.name, ...CURVE_COLUMNS, "runs"], rows };
  };
  const percent = number(campaign.confidence * 100);
  const points = plural(x.points.length, "point");
  return (
    <CategoryDots
      title={`${outcome} over ${x.name}`}
      file={`curves-${campaign.file}`}
      label={`${outcome} of ${points} of ${x.name}, with ${percent} % intervals.`}
      rows={x.points.map((point) => rowOf(point, shown))}
      series={shown.map(nameOf)}
      valueName={outcome}
      table={table}
      badge={
        combined.length > shown.length
          ? `Shown: ${shown.length} of ${combined.length} series; the table below has all`
          : undefined
      }
      tools={
        <p class="muted small frame-note">
          Mean of the runs of a cell, the greatest above; the whisker is its {percent} % interval.
        </p>
      }
    />
  );
}

function Everything({ campaign }: { campaign: Campaign }): JSX.Element {
  const { axes, cells, outcomes } = campaign;
  const table = (): TableData => ({
    columns: [
      ...(axes.length ? axes.map((axis) => axis.name) : ["cell"]),
      "runs",
      ...outcomes.flatMap((name) => [name, `${name} low`, `${name} high`]),
    ],
    rows: cells.map((cell) => [
      ...(axes.length ? axes.map((axis) => cell.parameters[axis.name] ?? null) : [cell.name]),
      cell.runs,
      ...outcomes.flatMap((name): Cell[] => {
        const summary = cell.outcomes[name];
        return [
          summary?.mean ?? null,
          summary?.interval?.low ?? null,
          summary?.interval?.high ?? null,
        ];
      }),
    ]),
  });
  return (
    <TableFrame title="All outcomes" file={`cells-${campaign.file}`} table={table}>
      <TableScroll label="All cells and outcomes">
        <table class="data">
          <HeadRow heads={["Cell", ...["Runs", ...outcomes].map(numberHead)]} />
          <tbody>
            {cells.map((cell) => (
              <tr>
                <th scope="row">{cell.name}</th>
                <td class="num">{count(cell.runs)}</td>
                {outcomes.map((name) => {
                  const interval = cell.outcomes[name]?.interval;
                  return (
                    <td class="num">
                      {number(cell.outcomes[name]?.mean)}
                      {interval ? <span class="sub">{intervalText(interval)}</span> : null}
                    </td>
                  );
                })}
              </tr>
            ))}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}
