// What a campaign says besides its means: differences run by run, and what deciding cost.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import type { CampaignCell, Report } from "../api/types";
import { CategoryDots } from "../charts/category-dots";
import { type Curve, Lines, lookOf, type Point } from "../charts/lines";
import { IntervalBar, type Span, scaleOf } from "../components/interval-bar";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, hiddenHead, numberHead, TableScroll } from "../components/table-parts";
import { count, intervalText, number, plural } from "../format";
import { type Axis, cellAt, combinations, isNumeric, pointsOf } from "./campaign-axes";

/** Curves that can be told apart. */
export const CURVES_UP_TO = 12;

export interface Campaign {
  axes: Axis[];
  cells: CampaignCell[];
  outcomes: string[];
  confidence: number;
  /** Of each cell, at most. */
  runs: number;
  times: NonNullable<Report["timing"]["cells"]>;
  file: string;
}

const DIFFERENCE_HEADS = [
  "Cell",
  "Less",
  ...["Pairs", "Mean difference", "Interval"].map(numberHead),
  hiddenHead("Picture"),
];

export function Differences({
  campaign,
  outcome,
}: {
  campaign: Campaign;
  outcome: string;
}): JSX.Element | null {
  const compared = campaign.cells.filter((cell) => cell.differences[outcome]);
  if (!compared.length) return null;
  const spans = compared.flatMap((cell) => cell.differences[outcome]?.interval ?? []);
  const scale = scaleOf(spans);
  const table = (): TableData => ({
    columns: ["cell", "compared with", "pairs", "mean difference", "low", "high"],
    rows: compared.map((cell) => {
      const { pairs = 0, mean = null, interval } = cell.differences[outcome] ?? {};
      return [
        cell.name,
        cell.compared_with ?? null,
        pairs,
        mean,
        interval?.low ?? null,
        interval?.high ?? null,
      ];
    }),
  });
  const note = (
    <p class="muted small frame-note">
      Run by run on the same scenes; {number(campaign.confidence * 100)} % interval of the mean
      difference. A filled bar does not touch zero.
    </p>
  );
  return (
    <TableFrame
      title={`Paired differences: ${outcome}`}
      file={`differences-${campaign.file}`}
      table={table}
      tools={note}
    >
      <TableScroll label={`Paired differences of ${outcome}`}>
        <table class="data">
          <HeadRow heads={DIFFERENCE_HEADS} />
          <tbody>
            {compared.map((cell) => (
              <Difference cell={cell} outcome={outcome} scale={scale} />
            ))}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}

function Difference({
  cell,
  outcome,
  scale,
}: {
  cell: CampaignCell;
  outcome: string;
  scale: ReturnType<typeof scaleOf>;
}): JSX.Element {
  const difference = cell.differences[outcome];
  const span: Span | undefined = difference?.interval ?? undefined;
  return (
    <tr>
      <td>{cell.name}</td>
      <td>{cell.compared_with ?? "–"}</td>
      <td class="num">{count(difference?.pairs)}</td>
      <td class="num">{number(difference?.mean)}</td>
      <td class="num">{span ? intervalText(span) : "–"}</td>
      <td class="interval-cell">
        {span && typeof difference?.mean === "number" ? (
          <IntervalBar mean={difference.mean} span={span} scale={scale} />
        ) : null}
      </td>
    </tr>
  );
}

/**
 * The slope of log y over log x by least squares, and its standard error where more than two points
 * tell of one.
 */
export function slope(points: [number, number][]): { slope: number; error: number | null } | null {
  const logs = points
    .filter(([x, y]) => x > 0 && y > 0)
    .map(([x, y]) => [Math.log(x), Math.log(y)] as const);
  if (logs.length < 2) return null;
  const mean = (of: (point: readonly [number, number]) => number) =>
    logs.reduce((sum, point) => sum + of(point), 0) / logs.length;
  const [x, y] = [mean((point) => point[0]), mean((point) => point[1])];
  const spread = mean((point) => (point[0] - x) ** 2);
  if (spread === 0) return null;
  const steep = mean((point) => (point[0] - x) * (point[1] - y)) / spread;
  const rest = mean((point) => (point[1] - y - steep * (point[0] - x)) ** 2);
  return {
    slope: steep,
    error: logs.length > 2 ? Math.sqrt(rest / spread / (logs.length - 2)) : null,
  };
}

function slopeText(points: [number, number][]): string {
  const fit = slope(points);
  if (!fit) return "";
  const error = fit.error === null ? "" : ` ± ${fit.error.toFixed(2)}`;
  return ` (slope ${fit.slope.toFixed(2)}${error})`;
}

/** How long deciding took in each cell along an axis, for every combination of the other axes. */
function timesAlong(campaign: Campaign, x: Axis): { name: string; times: (number | null)[] }[] {
  const others = campaign.axes.filter((axis) => axis !== x);
  const known = new Map(campaign.times.map((time) => [time.cell, time.decide_us_per_scan]));
  return combinations(others).map((points) => {
    const cellOf = (point: string) =>
      cellAt(campaign.cells, campaign.axes, { ...pointsOf(others, points), [x.name]: point });
    return {
      name: points.join(", ") || "all",
      times: x.points.map((point) => known.get(cellOf(point)?.name ?? "") ?? null),
    };
  });
}

function timeCurves(campaign: Campaign, x: Axis): Curve[] {
  return timesAlong(campaign, x).map(({ name, times }, order) => {
    const points = times
      .map((time, index): Point => [Number(x.points[index]), time])
      .sort((a, b) => a[0] - b[0]);
    const steep = slopeText(points.filter((point): point is [number, number] => point[1] !== null));
    return { name: `${name}${steep}`, points, ...lookOf(order) };
  });
}

const TIME_NAME = "time (µs a scan)";

interface TimePictureProps {
  campaign: Campaign;
  x: Axis;
  table: () => TableData;
}

function TimePicture(props: TimePictureProps): JSX.Element {
  return isNumeric(props.x) ? <TimeCurves {...props} /> : <TimeDots {...props} />;
}

function TimeCurves({ campaign, x, table }: TimePictureProps): JSX.Element {
  const curves = useMemo(() => timeCurves(campaign, x).slice(0, CURVES_UP_TO), [campaign, x]);
  const positive = x.points.every((point) => Number(point) > 0);
  return (
    <Lines
      title={`Time of deciding over ${x.name}`}
      file={`time-curves-${campaign.file}`}
      label={`Microseconds a scan over ${x.name}.`}
      curves={curves}
      xName={x.name}
      yName={TIME_NAME}
      logX={positive}
      logY
      table={table}
      tools={
        positive ? (
          <p class="muted small frame-note">
            The slope is that of the logarithms, by least squares, with its standard error where
            there are three points or more.
          </p>
        ) : null
      }
    />
  );
}

function TimeDots({ campaign, x, table }: TimePictureProps): JSX.Element {
  const series = timesAlong(campaign, x).slice(0, CURVES_UP_TO);
  const estimateAt = (time: number | null | undefined) =>
    typeof time === "number" && time > 0 ? { mean: time } : undefined;
  return (
    <CategoryDots
      title={`Time of deciding over ${x.name}`}
      file={`time-curves-${campaign.file}`}
      label={`Microseconds a scan for ${plural(x.points.length, "point")} of ${x.name}.`}
      rows={x.points.map((name, index) => ({
        name,
        estimates: series.map(({ times }) => estimateAt(times[index])),
      }))}
      series={series.map(({ name }) => name)}
      valueName={TIME_NAME}
      log
      table={table}
    />
  );
}

export function Times({ campaign, x }: { campaign: Campaign; x: Axis | undefined }): JSX.Element {
  const table = (): TableData => ({
    columns: ["cell", "µs a scan", "ratio", "timed runs"],
    rows: campaign.times.map((time) => [
      time.cell,
      time.decide_us_per_scan,
      time.ratio ?? null,
      time.timed_runs,
    ]),
  });
  return (
    <>
      <TableFrame title="Time of deciding" file={`times-${campaign.file}`} table={table}>
        <TableScroll label="Time of deciding">
          <table class="data">
            <HeadRow heads={["Cell", ...["µs a scan", "Ratio", "Timed runs"].map(numberHead)]} />
            <tbody>
              {campaign.times.map((time) => (
                <tr>
                  <td>{time.cell}</td>
                  <td class="num">{number(time.decide_us_per_scan)}</td>
                  <td class="num">{number(time.ratio)}</td>
                  <td class="num">{count(time.timed_runs)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      </TableFrame>
      {x && x.points.length > 1 ? <TimePicture campaign={campaign} x={x} table={table} /> : null}
    </>
  );
}
