// The verdicts of the temporal automaton, one row a target; a row leads to the scan where its track
// went wrong.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import type { Job, TargetVerdict, Tfa } from "../api/types";
import { readTfaFiles } from "../charts/automaton";
import { AutomatonView } from "../charts/automaton-view";
import { type Curve, Lines, type Point } from "../charts/lines";
import { Empty, Icon, type IconName, Link, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { saveText } from "../components/save";
import { toCsv } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { capital, count, number, probability, words } from "../format";
import { useOrigin } from "../state/job-start";
import { go, hereHref, param, setParams } from "../state/url";
import { TfaNumbers } from "./job-summary";
import { placeOf, reason, sentence, took, tookKind } from "./verdicts";

const PAGE = 200;

type Key =
  | "truth_id"
  | "verdict"
  | "at_scan"
  | "expected"
  | "took"
  | "took_kind"
  | "errors"
  | "log_probability"
  | "track_id";

const COLUMNS: { key: Key; name: string; numeric?: boolean }[] = [
  { key: "truth_id", name: "Truth" },
  { key: "verdict", name: "Verdict" },
  { key: "at_scan", name: "At scan", numeric: true },
  { key: "expected", name: "Expected" },
  { key: "took", name: "Took" },
  { key: "took_kind", name: "Which is" },
  { key: "errors", name: "Errors", numeric: true },
  { key: "log_probability", name: "log P", numeric: true },
  { key: "track_id", name: "Followed by" },
];

const collator = new Intl.Collator("en", { numeric: true });

function compare(key: Key, a: TargetVerdict, b: TargetVerdict): number {
  const [left, right] = [a[key], b[key]];
  if (left === right) return 0;
  if (left === null || left === undefined) return 1;
  if (right === null || right === undefined) return -1;
  return typeof left === "number" && typeof right === "number"
    ? left - right
    : collator.compare(String(left), String(right));
}

function sorting(): { key: Key; down: boolean } {
  const text = param("sort") ?? "truth_id";
  const key = COLUMNS.find((column) => column.key === text.replace(/^-/, ""))?.key ?? "truth_id";
  return { key, down: text.startsWith("-") };
}

export function filtered(targets: TargetVerdict[]): TargetVerdict[] {
  const verdict = param("verdict");
  const text = (param("find") ?? "").toLowerCase();
  const { key, down } = sorting();
  return targets
    .filter((target) => !verdict || target.verdict === verdict)
    .filter(
      (target) =>
        !text ||
        [target.truth_id, target.track_id, target.took_truth_id].some((id) =>
          id?.toLowerCase().includes(text),
        ),
    )
    .sort(
      (a, b) => (down ? -1 : 1) * compare(key, a, b) || collator.compare(a.truth_id, b.truth_id),
    );
}

function SortHead({ column }: { column: (typeof COLUMNS)[number] }): JSX.Element {
  const { key, down } = sorting();
  const active = key === column.key;
  const next = active && !down ? `-${column.key}` : column.key;
  return (
    <th
      scope="col"
      class={column.numeric ? "num" : undefined}
      aria-sort={active ? (down ? "descending" : "ascending") : undefined}
    >
      <button
        type="button"
        class="sort"
        onClick={() => setParams({ sort: next === "truth_id" ? null : next, page: null })}
      >
        {column.name}
        <span aria-hidden="true">{active ? (down ? " ↓" : " ↑") : ""}</span>
      </button>
    </th>
  );
}

function VerdictRow({ verdict }: { verdict: TargetVerdict }): JSX.Element {
  const show = () => go(hereHref(placeOf(verdict)));
  const pressed = (event: MouseEvent) => {
    if (!(event.target as HTMLElement).closest("a, button")) show();
  };
  return (
    <tr
      class={`verdict-row selectable${param("truth") === verdict.truth_id ? " selected" : ""}`}
      onClick={pressed}
    >
      <td>
        <button
          type="button"
          class="link"
          onClick={show}
          aria-label={`Show ${verdict.truth_id} in the plan view`}
        >
          {verdict.truth_id}
        </button>
      </td>
      <td>
        <span class={`badge verdict-${verdict.verdict}`}>
          <Icon name={verdict.verdict as IconName} />
          {verdict.verdict}
        </span>
      </td>
      <td class="num">{count(verdict.at_scan)}</td>
      <td class="mono">{verdict.expected ?? "–"}</td>
      <td class="mono">{verdict.took_kind ? took(verdict) : "–"}</td>
      <td>{tookKind(verdict)}</td>
      <td class="num">{count(verdict.errors)}</td>
      <td class="num">{number(verdict.log_probability)}</td>
      <td>{verdict.track_id ?? verdict.matched_track_id ?? "–"}</td>
      <td class="reason">{reason(verdict)}</td>
    </tr>
  );
}

function Filter({ tfa, rows }: { tfa: Tfa; rows: TargetVerdict[] }): JSX.Element {
  const rowOf = (row: TargetVerdict) => [
    ...COLUMNS.map(({ key }) => row[key] ?? null),
    row.verdict === "correct" ? null : reason(row),
  ];
  const table = () => ({
    columns: [...COLUMNS.map((column) => column.key), "why"],
    rows: rows.map(rowOf),
  });
  const csv = () => saveText(toCsv(table()), "verdicts.csv", "text/csv");
  return (
    <form class="filters" role="search" onSubmit={(event) => event.preventDefault()}>
      <label>
        <span>Verdict</span>
        <select
          value={param("verdict") ?? ""}
          onChange={(event) => setParams({ verdict: event.currentTarget.value, page: null })}
        >
          <option value="">all {count(tfa.targets.length)}</option>
          {(["correct", "missed", "false"] as const).map((name) => (
            <option value={name}>
              {name} {count(tfa.counts[name])}
            </option>
          ))}
        </select>
      </label>
      <label class="grow">
        <span>Truth or track</span>
        <input
          type="search"
          data-filter
          value={param("find") ?? ""}
          placeholder="Press / to filter"
          onInput={(event) => setParams({ find: event.currentTarget.value, page: null })}
        />
      </label>
      <button type="button" onClick={csv}>
        <Icon name="download" /> CSV
      </button>
    </form>
  );
}

export function JobVerdicts({ job, tfa }: { job: Job; tfa: Tfa }): JSX.Element {
  const rows = filtered(tfa.targets);
  const pages = Math.max(1, Math.ceil(rows.length / PAGE));
  const page = Math.min(Math.max(Number(param("page")) || 1, 1), pages);
  const turn = (to: number) => () => setParams({ page: to === 1 ? null : to });
  return (
    <section class="verdicts">
      <TfaNumbers tfa={tfa} />
      <Sets tfa={tfa} />
      <WayOfTarget job={job} tfa={tfa} />
      <Shares tfa={tfa} file={job.id.slice(-12)} />
      <Tolerance tfa={tfa} file={job.id.slice(-12)} />
      <Filter tfa={tfa} rows={rows} />
      {rows.length ? (
        <div class="table-scroll">
          <table class="data">
            <caption class="visually-hidden">
              Verdicts; a row leads to the scan that decided it
            </caption>
            <thead>
              <tr>
                {COLUMNS.map((column) => (
                  <SortHead key={column.key} column={column} />
                ))}
                <th scope="col">Why</th>
              </tr>
            </thead>
            <tbody>
              {rows.slice((page - 1) * PAGE, page * PAGE).map((verdict) => (
                <VerdictRow key={verdict.truth_id} verdict={verdict} />
              ))}
            </tbody>
          </table>
        </div>
      ) : (
        <Empty
          title={
            tfa.targets.length ? "No verdict matches this filter." : "There was no target to judge."
          }
        />
      )}
      {pages > 1 ? (
        <p class="more">
          <button type="button" disabled={page === 1} onClick={turn(page - 1)}>
            Previous
          </button>
          <span class="muted">
            {(page - 1) * PAGE + 1} to {Math.min(page * PAGE, rows.length)} of {count(rows.length)}
          </span>
          <button type="button" disabled={page === pages} onClick={turn(page + 1)}>
            Next
          </button>
        </p>
      ) : null}
    </section>
  );
}

const SETS = ["correct", "missed", "false"] as const;
const CHIPS = 40;

/** The three sets, target by target. */
function Sets({ tfa }: { tfa: Tfa }): JSX.Element {
  return (
    <div class="sets">
      {SETS.map((name) => {
        const targets = tfa.targets.filter((target) => target.verdict === name);
        return (
          <section class={`panel set-${name}`} aria-label={`Targets: ${name}`}>
            <h2>
              <Icon name={name} /> {name} <span class="muted">{count(targets.length)}</span>
            </h2>
            {targets.length ? null : <p class="muted">None.</p>}
            <ul class="chips">
              {targets.slice(0, CHIPS).map((target) => (
                <li>
                  <Link
                    class={`chip${param("truth") === target.truth_id ? " chosen" : ""}`}
                    href={hereHref({ truth: target.truth_id })}
                    label={`Way of target ${target.truth_id}`}
                  >
                    {target.truth_id}
                  </Link>
                </li>
              ))}
            </ul>
            {targets.length > CHIPS ? (
              <p class="small">
                <Link href={hereHref({ verdict: name, page: null })}>
                  {count(targets.length - CHIPS)} more in the table
                </Link>
              </p>
            ) : null}
          </section>
        );
      })}
    </div>
  );
}

/** The way of the chosen target; without a choice, of the first that went wrong. */
function WayOfTarget({ job, tfa }: { job: Job; tfa: Tfa }): JSX.Element | null {
  const files = useResource(() => readTfaFiles(job.id), [job.id]);
  const origin = useOrigin(job.id);
  const { targets } = tfa;
  const asked = targets.find((target) => target.truth_id === param("truth"));
  const chosen = asked ?? targets.find((target) => target.verdict === "false") ?? targets[0];
  if (!chosen) return null;
  if (files.error) return <ProblemBox error={files.error} retry={files.reload} />;
  if (!files.data || origin === undefined) return <Loading what="the automaton" />;
  const { automaton, expected } = files.data;
  const steps = expected.get(chosen.truth_id);
  if (!automaton)
    return <p class="muted">The automaton was too large for a file, so that it is not drawn.</p>;
  if (!steps)
    return <p class="muted">{`Target ${chosen.truth_id} has no string: ${sentence(chosen)}`}</p>;
  const file = `way-${chosen.truth_id}-${job.id.slice(-12)}`;
  return (
    <div class="way-of-target">
      <p>
        <span class={`badge verdict-${chosen.verdict}`}>
          <Icon name={chosen.verdict as IconName} /> {chosen.verdict}
        </span>{" "}
        <b>{chosen.truth_id}</b> {sentence(chosen)}{" "}
        <Link href={hereHref(placeOf(chosen))}>Show in the plan view</Link>
      </p>
      <AutomatonView
        key={chosen.truth_id}
        verdict={chosen}
        expected={steps}
        automaton={automaton}
        file={file}
        origin={origin}
      />
    </div>
  );
}

/** Every probability, with what it is a share of. */
function Shares({ tfa, file }: { tfa: Tfa; file: string }): JSX.Element | null {
  const shares = tfa.shares ?? [];
  if (!shares.length) return null;
  const columns = ["name", "forgiven", "of", "numerator", "denominator", "value"];
  const rows = shares.map((of) => [
    of.name,
    of.forgiven,
    of.of,
    of.numerator,
    of.denominator,
    of.value ?? null,
  ]);
  return (
    <TableFrame title="Probabilities" file={`shares-${file}`} table={() => ({ columns, rows })}>
      <TableScroll label="Probabilities">
        <table class="data">
          <HeadRow
            heads={[
              "Verdict",
              numberHead("Errors forgiven"),
              "Share of",
              numberHead("Count"),
              numberHead("Of"),
              numberHead("P"),
            ]}
          />
          <tbody>
            {shares.map(({ name, forgiven, of, numerator, denominator, value }) => (
              <tr>
                <td>{capital(name)}</td>
                <td class="num">{forgiven}</td>
                <td>{words(of)}</td>
                <td class="num">{count(numerator)}</td>
                <td class="num">{count(denominator)}</td>
                <td class="num">{probability(value)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}

function Tolerance({ tfa, file }: { tfa: Tfa; file: string }): JSX.Element | null {
  const curves = useMemo((): Curve[] => {
    const points = tfa.tolerance.map(({ k, correct }): Point => [k, correct]);
    const name = "correct when up to k errors are forgiven";
    return [
      {
        name,
        points,
        color: (palette) => palette.good,
        look: "solid",
        symbol: "circle",
        step: true,
      },
    ];
  }, [tfa]);
  if (tfa.tolerance.length < 2) return null;
  const rows = tfa.tolerance.map(({ k, correct, probability: share }) => [
    k,
    correct,
    share ?? null,
  ]);
  const [first, last] = [tfa.tolerance[0], tfa.tolerance.at(-1)];
  const note = (
    <p class="muted small frame-note">
      P correct is {probability(first?.probability)} without errors and{" "}
      {probability(last?.probability)} when {last?.k} are forgiven.
    </p>
  );
  return (
    <Lines
      title="Tolerance"
      file={`tolerance-${file}`}
      label={`Correct targets over forgiven errors, 0 to ${last?.k}.`}
      curves={curves}
      xName="forgiven errors k"
      yName="correct targets"
      values="counts"
      table={() => ({ columns: ["k", "correct targets", "P correct"], rows })}
      tools={note}
    />
  );
}
