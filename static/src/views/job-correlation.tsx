// Which tracks were put together: the cost and how far it may be above the least, every tuple with
// its statistic, and the search.

import type { JSX, TargetedEvent } from "preact";
import { useMemo } from "preact/hooks";
import type { Cell, CorrelateResult, CorrelationTuple, Job, Report } from "../api/types";
import { NO_EVENT } from "../charts/event-moment";
import { type Curve, Lines, type Point } from "../charts/lines";
import { TupleChart } from "../charts/tuple-chart";
import { Empty, Icon } from "../components/basics";
import { type Figure, Figures } from "../components/figures";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { type Head, HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { capital, count, number, plural, probability, words } from "../format";
import type { Palette } from "../state/theme";
import { go, hereHref, param, setParams } from "../state/url";

const ROWS = 200;
const FILTERS = ["all", "right", "wrong", "below the threshold"];

export function JobCorrelation({ job, report }: { job: Job; report: Report }): JSX.Element {
  const result = report.result as CorrelateResult;
  const { alpha } = ((report.spec as Record<string, unknown>).statistic ?? {}) as {
    alpha?: number;
  };
  const file = job.id.slice(-12);
  const all = plural(result.counts.tuples, "tuple");
  const shown = `Shown: ${count(result.tuples.length)} of ${all}; all are in tuples.csv`;
  const badge = result.tuples_left_out ? shown : undefined;
  const table = () => tupleTable(result, result.tuples);
  return (
    <div class="summary">
      <Figures label="Cost and quality" figures={figures(result)} />
      {result.tuples.length ? (
        <>
          <Matrix result={result} alpha={alpha} file={file} badge={badge} />
          <TupleChart
            tuples={result.tuples}
            alpha={alpha}
            file={`tuples-${file}`}
            table={table}
            badge={badge}
            pick={(tuple) => go(placeOf(tuple))}
          />
        </>
      ) : (
        <Empty title="No two tracks were put together." />
      )}
      {result.search ? <Search result={result} file={file} /> : <NoSearch result={result} />}
      <Alone result={result} />
    </div>
  );
}

/** Where the plan view shows a tuple. */
function placeOf(tuple: CorrelationTuple): string {
  const selected = { track: tuple.system_track_id, truth: tuple.truth_id ?? null };
  return hereHref({
    ...NO_EVENT,
    tab: "plan",
    ...selected,
    centre: "selection",
    span: null,
    time: null,
  });
}

/** Sums of costs are rounded: a gap below this is none. */
const ROUNDING = 1e-9;

function gapFigure(gap: number | null | undefined): Figure {
  if (gap === null || gap === undefined)
    return { name: "Gap", value: "not known", note: "without a bound" };
  if (Math.abs(gap) < ROUNDING)
    return { name: "Gap", value: "0 %", note: "proved to be the least" };
  return { name: "Gap", value: `${number(gap * 100)} %`, note: "at most, above the least" };
}

function figures(result: CorrelateResult): Figure[] {
  const { counts, truth, gap } = result;
  const known = (value: number | null | undefined) =>
    value === null || value === undefined ? "not known" : number(value);
  const list: Figure[] = [
    {
      name: "Cost J",
      value: number(result.cost),
      note: `${words(result.correlator)}, ${words(result.statistic)}`,
    },
    { name: "Dual bound", value: known(result.dual_bound), note: "no division costs less" },
    gapFigure(gap),
    {
      name: "Tuples",
      value: count(counts.tuples),
      note: `of ${plural(counts.tracks, "track")} of ${plural(counts.sensors, "sensor")}`,
    },
    {
      name: "Alone",
      value: count(counts.unassociated),
      note: `${plural(counts.system_tracks, "system track")} in all`,
    },
    {
      name: "Common times",
      value: count(counts.common_times),
      note: `${plural(counts.dimensions, "number")}, ${plural(counts.links, "link")}`,
    },
  ];
  if (!truth) return list;
  return [
    ...list,
    {
      name: "Tuples right",
      value: `${count(truth.tuples_right)} of ${count(truth.tuples)}`,
      note: `share ${probability(truth.share_right)} of targets that two sensors or more saw`,
    },
    {
      name: "Pairs",
      value: probability(truth.pairwise_precision),
      note: `precision; recall ${probability(truth.pairwise_recall)}`,
    },
    { name: "False tracks", value: count(truth.false_tracks), note: "of no target" },
  ];
}

function columnsOf(result: CorrelateResult): string[] {
  const known = result.truth ? ["truth", "right"] : [];
  return [
    "system track",
    ...result.sensors.map((sensor) => `track of ${sensor.sensor_id}`),
    "cost",
    "b",
    "Q",
    "d.o.f.",
    "p-value",
    "found",
    ...known,
  ];
}

function rowOf(result: CorrelateResult, tuple: CorrelationTuple): Cell[] {
  const known = result.truth ? [tuple.truth_id ?? null, tuple.right ? "right" : "wrong"] : [];
  const { cost = null, b = null, statistic, degrees_of_freedom, p_value = null, found } = tuple;
  return [
    tuple.system_track_id,
    ...tuple.tracks,
    cost,
    b,
    statistic,
    degrees_of_freedom,
    p_value,
    found,
    ...known,
  ];
}

function tupleTable(result: CorrelateResult, tuples: CorrelationTuple[]): TableData {
  return { columns: columnsOf(result), rows: tuples.map((tuple) => rowOf(result, tuple)) };
}

function isBelow(tuple: CorrelationTuple, alpha: number | undefined): boolean {
  return alpha !== undefined && typeof tuple.p_value === "number" && tuple.p_value < alpha;
}

function kept(tuples: CorrelationTuple[], alpha: number | undefined): CorrelationTuple[] {
  const filter = param("tuples");
  if (filter === "right") return tuples.filter((tuple) => tuple.right === true);
  if (filter === "wrong") return tuples.filter((tuple) => tuple.right === false);
  return filter === "below the threshold"
    ? tuples.filter((tuple) => isBelow(tuple, alpha))
    : tuples;
}

function headsOf(result: CorrelateResult): Head[] {
  return columnsOf(result).map((name, column) => {
    const isNumber = column > result.sensors.length && !["truth", "right"].includes(name);
    return isNumber ? numberHead(name) : name;
  });
}

function Matrix({
  result,
  alpha,
  file,
  badge,
}: {
  result: CorrelateResult;
  alpha: number | undefined;
  file: string;
  badge: string | undefined;
}): JSX.Element {
  const tuples = kept(result.tuples, alpha);
  const choose = ({ currentTarget: { value } }: TargetedEvent<HTMLSelectElement>) =>
    setParams({ tuples: value === "all" ? null : value });
  const tools = (
    <div class="filters frame-filters">
      <label>
        <span>Tuples</span>
        <select value={param("tuples") ?? "all"} onChange={choose}>
          {FILTERS.map((name) => (
            <option value={name}>{name}</option>
          ))}
        </select>
      </label>
      <p class="muted small">
        {count(Math.min(tuples.length, ROWS))} of {count(result.counts.tuples)} shown
        {alpha === undefined ? "" : ` · p below α = ${alpha} is marked`}
        {badge ? ` · ${badge}` : ""}
        {result.truth ? ` · ${rightText(result)}` : ""}
      </p>
    </div>
  );
  return (
    <TableFrame
      title="Tuples"
      file={`tuples-${file}`}
      table={() => tupleTable(result, tuples)}
      tools={tools}
    >
      <TableScroll label="Tuples and sensors">
        <table class="data tuples">
          <HeadRow heads={headsOf(result)} />
          <tbody>
            {tuples.slice(0, ROWS).map((tuple) => (
              <Row key={tuple.system_track_id} tuple={tuple} result={result} alpha={alpha} />
            ))}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}

/** When a tuple is right, and what those lack that are not. */
function rightText({ truth, tuples }: CorrelateResult): string {
  const rule = "A tuple is right when it holds every track of one target and no other track.";
  const wrong = tuples.filter((tuple) => tuple.right === false).length;
  if (!truth || !wrong) return rule;
  const which = wrong === 1 ? "the wrong tuple" : `each of the ${count(wrong)} wrong tuples`;
  if (truth.pairwise_precision !== 1) {
    const fault = "holds tracks of several targets or of none, or lacks some of its target";
    return `${rule} ${capital(which)} ${fault}.`;
  }
  const pairs = "No two tracks of different targets were put together (pair precision 1)";
  const rest = "other pieces of it stand alone or in another tuple";
  return `${rule} ${pairs}, so ${which} lacks tracks of its target: ${rest}.`;
}

function Row({
  tuple,
  result,
  alpha,
}: {
  tuple: CorrelationTuple;
  result: CorrelateResult;
  alpha: number | undefined;
}): JSX.Element {
  const show = () => go(placeOf(tuple));
  const below = isBelow(tuple, alpha);
  const pressed = (event: MouseEvent) => {
    if (!(event.target as HTMLElement).closest("button")) show();
  };
  return (
    <tr class="selectable" onClick={pressed}>
      <td>
        <button
          type="button"
          class="link"
          onClick={show}
          aria-label={`Show system track ${tuple.system_track_id} in the plan view`}
        >
          {tuple.system_track_id}
        </button>
      </td>
      {tuple.tracks.map((track) => (
        <td class={track === null ? "absent-track" : "mono"}>{track ?? "absent"}</td>
      ))}
      <td class="num">{number(tuple.cost)}</td>
      <td class="num">{number(tuple.b)}</td>
      <td class="num">{number(tuple.statistic)}</td>
      <td class="num">{tuple.degrees_of_freedom}</td>
      <td class={`num${below ? " below" : ""}`}>
        {below ? <span class="visually-hidden">below the threshold: </span> : null}
        {below ? "▾ " : ""}
        {number(tuple.p_value)}
      </td>
      <td class="num">
        {tuple.found}/{result.confirm.of}
      </td>
      {result.truth ? (
        <>
          <td>{tuple.truth_id ?? "none"}</td>
          <td>
            <span class={`badge verdict-${tuple.right ? "correct" : "missed"}`}>
              <Icon name={tuple.right ? "correct" : "false"} /> {tuple.right ? "right" : "wrong"}
            </span>
          </td>
        </>
      ) : null}
    </tr>
  );
}

const muted = (palette: Palette) => palette.muted;
const track = (palette: Palette) => palette.track;
const chosen = (palette: Palette) => palette.selected;

function searchCurves(result: CorrelateResult): Curve[] {
  const { search, dual_bound } = result;
  const points = (values: number[]): Point[] => values.map((value, index) => [index + 1, value]);
  const curves: Curve[] = [
    {
      name: "best",
      points: points(search?.best ?? []),
      color: track,
      look: "solid",
      symbol: "circle",
    },
    {
      name: "mean",
      points: points(search?.mean ?? []),
      color: muted,
      look: "dashed",
      symbol: "triangle",
    },
  ];
  if (dual_bound === null || dual_bound === undefined) return curves;
  const ends = [1, Math.max(search?.generations ?? 1, 2)];
  return [
    ...curves,
    {
      name: "dual bound",
      points: ends.map((x): Point => [x, dual_bound]),
      color: chosen,
      look: "dotted",
    },
  ];
}

function Search({ result, file }: { result: CorrelateResult; file: string }): JSX.Element {
  const curves = useMemo(() => searchCurves(result), [result]);
  const { search } = result;
  if (!search) return <NoSearch result={result} />;
  if (search.generations < 2) {
    return (
      <p class="muted">
        The search ended with its first answers ({words(search.stop)}): best{" "}
        {number(search.best[0])}
        {search.evaluations
          ? `, mean ${number(search.mean[0])} of ${plural(search.evaluations, "solution")}`
          : ""}
        .
      </p>
    );
  }
  const rows = search.best.map((best, index): Cell[] => [
    index + 1,
    best,
    search.mean[index] ?? null,
  ]);
  const note = (
    <p class="muted small frame-note">
      {plural(search.generations, "generation")}, {plural(search.evaluations, "solution")}{" "}
      evaluated; it ended because: {words(search.stop)}.
    </p>
  );
  return (
    <Lines
      title="Search"
      file={`search-${file}`}
      label={`Best and mean cost of ${plural(search.generations, "generation")}.`}
      curves={curves}
      xName="generation"
      yName="cost J"
      table={() => ({ columns: ["generation", "best", "mean"], rows })}
      tools={note}
    />
  );
}

function NoSearch({ result }: { result: CorrelateResult }): JSX.Element {
  return (
    <p class="muted">
      {capital(words(result.correlator))} does not search by generations: there is no trace.
    </p>
  );
}

function Alone({ result }: { result: CorrelateResult }): JSX.Element | null {
  if (!result.unassociated.length) return null;
  const left = result.unassociated_left_out;
  return (
    <details class="panel">
      <summary>
        {count(result.counts.unassociated)}{" "}
        {result.counts.unassociated === 1 ? "track is" : "tracks are"} alone
      </summary>
      <ul class="chips">
        {result.unassociated.map(({ sensor_id, track_id }) => (
          <li class="chip">
            {sensor_id} <b>{track_id}</b>
          </li>
        ))}
      </ul>
      {left ? <p class="muted small">{count(left)} more are in tuples.csv.</p> : null}
    </details>
  );
}
