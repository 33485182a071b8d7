// How a search went: what the method says of its own work, how its cost fell, and of a clustering
// who belongs to whom.

import type { JSX, TargetedEvent } from "preact";
import { useMemo } from "preact/hooks";
import { getArtifactText, getPlanAt, listArtifacts } from "../api/client";
import { type Cell, type Job, partsOf, type Report } from "../api/types";
import { type CentrePath, CentrePaths, type Place } from "../charts/centre-paths";
import { type Curve, Lines, type Point } from "../charts/lines";
import { Empty, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { capital, number, probability, words } from "../format";
import { param, setParams } from "../state/url";
import { type Iteration, type Problem, readTrace } from "./search-trace";

const TRACES = ["association_trace.csv", "grouping_trace.csv"];
const PROBLEMS_LISTED = 2000;

async function loadTrace(id: string): Promise<ReturnType<typeof readTrace> | null> {
  const file = (await listArtifacts(id)).find((artifact) => TRACES.includes(artifact.name));
  return file ? readTrace(await getArtifactText(id, file.name)) : null;
}

export function JobSearch({ job, report }: { job: Job; report: Report }): JSX.Element {
  const trace = useResource(() => loadTrace(job.id), [job.id]);
  return (
    <div class="summary">
      <Diagnostics report={report} />
      {trace.error ? <ProblemBox error={trace.error} retry={trace.reload} /> : null}
      {trace.data === undefined && !trace.error ? <Loading what="the trace" /> : null}
      {trace.data === null ? (
        <Empty title="There is no trace of a search.">
          <p>
            A job whose method has the setting “trace” on keeps every iteration of every search.
          </p>
        </Empty>
      ) : null}
      {trace.data ? (
        <Trace
          jobId={job.id}
          problems={trace.data.problems}
          isCut={trace.data.isCut}
          file={job.id.slice(-12)}
        />
      ) : null}
    </div>
  );
}

/** Every number of a free object, with the names on the way to it. */
function leaves(value: unknown, path: string[] = []): [string, string][] {
  if (typeof value === "object" && value !== null)
    return Object.entries(value).flatMap(([name, inner]) => leaves(inner, [...path, words(name)]));
  const text = typeof value === "number" ? number(value) : value === null ? "–" : String(value);
  return [[path.join(", "), text]];
}

function Diagnostics({ report }: { report: Report }): JSX.Element {
  const { association, grouping } = partsOf(report);
  const told = association?.diagnostics ?? grouping?.search;
  const method = association?.method ?? grouping?.method ?? "";
  return (
    <section class="panel diagnostics">
      <h2>What {words(method)} says of its own work</h2>
      <dl class="facts">
        {leaves(told).map(([name, value]) => (
          <>
            <dt>{capital(name)}</dt>
            <dd>{value}</dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Trace({
  jobId,
  problems,
  isCut,
  file,
}: {
  jobId: string;
  problems: Problem[];
  isCut: boolean;
  file: string;
}): JSX.Element {
  const longest = useMemo(
    () =>
      problems.reduce<Problem | undefined>(
        (best, problem) =>
          problem.iterations.length > (best?.iterations.length ?? 0) ? problem : best,
        undefined,
      ),
    [problems],
  );
  const chosen = problems.find((problem) => problem.name === param("problem")) ?? longest;
  if (!chosen) return <Empty title="No search was needed: every problem had one answer." />;
  const last = chosen.iterations.length - 1;
  const asked = param("iteration");
  const at = asked === null ? last : Math.min(Math.max(Number(asked) || 0, 0), last);
  const iteration = chosen.iterations[at];
  return (
    <>
      <div class="filters">
        <label>
          <span>Search</span>
          <select
            value={chosen.name}
            onChange={(event) => setParams({ problem: event.currentTarget.value, iteration: null })}
          >
            {problems.slice(0, PROBLEMS_LISTED).map((problem) => (
              <option value={problem.name}>
                {problem.name} ({problem.iterations.length})
              </option>
            ))}
          </select>
        </label>
        {isCut || problems.length > PROBLEMS_LISTED ? (
          <p class="muted small">The file holds more than are listed here.</p>
        ) : null}
      </div>
      <Convergence problem={chosen} file={file} at={iteration?.number} />
      {iteration?.memberships.size ? (
        <Memberships iteration={iteration} at={at} last={last} file={file} />
      ) : null}
      {iteration?.centres.size ? (
        <CentrePicture jobId={jobId} problem={chosen} at={at} file={file} />
      ) : null}
      {iteration?.centres.size ? <Centres problem={chosen} file={file} /> : null}
    </>
  );
}

function curvesOf(problem: Problem): Curve[] {
  const points = (of: (iteration: Iteration) => number | null): Point[] =>
    problem.iterations.map((iteration) => [iteration.number, of(iteration)]);
  const all: Curve[] = [
    {
      name: "best",
      points: points((iteration) => iteration.best),
      color: (palette) => palette.track,
      look: "solid",
      symbol: "circle",
    },
    {
      name: "mean",
      points: points((iteration) => iteration.mean),
      color: (palette) => palette.muted,
      look: "dashed",
      symbol: "triangle",
    },
    {
      name: "optimum",
      points: points((iteration) => iteration.optimal),
      color: (palette) => palette.selected,
      look: "dotted",
      symbol: "diamond",
    },
  ];
  return all.filter((curve) => curve.points.some(([, value]) => value !== null));
}

function Convergence({
  problem,
  file,
  at,
}: {
  problem: Problem;
  file: string;
  at: number | undefined;
}): JSX.Element {
  const curves = useMemo(() => curvesOf(problem), [problem]);
  const table = (): TableData => ({
    columns: ["iteration", ...curves.map((curve) => curve.name)],
    rows: problem.iterations.map((iteration, row): Cell[] => [
      iteration.number,
      ...curves.map((curve) => curve.points[row]?.[1] ?? null),
    ]),
  });
  return (
    <Lines
      title={`Convergence, ${problem.name}`}
      file={`convergence-${file}`}
      label={`Objective of ${problem.iterations.length} iterations.`}
      curves={curves}
      xName="iteration"
      yName="objective J"
      cursor={problem.iterations.some((each) => each.memberships.size) ? at : undefined}
      table={table}
    />
  );
}

function Memberships({
  iteration,
  at,
  last,
  file,
}: {
  iteration: Iteration;
  at: number;
  last: number;
  file: string;
}): JSX.Element {
  const groups = [
    ...new Set([...iteration.memberships.values()].flatMap((row) => [...row.keys()])),
  ].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
  const table = (): TableData => ({
    columns: ["detection", ...groups.map((group) => group || "noise")],
    rows: [...iteration.memberships].map(([detection, row]): Cell[] => [
      detection,
      ...groups.map((group) => row.get(group) ?? null),
    ]),
  });
  const drag = (event: TargetedEvent<HTMLInputElement>) =>
    setParams({
      iteration: Number(event.currentTarget.value) === last ? null : event.currentTarget.value,
    });
  const tools = (
    <div class="filters frame-filters">
      <label class="grow">
        <span>
          Iteration {iteration.number} of {last}
        </span>
        <input type="range" min={0} max={last} value={at} onInput={drag} />
      </label>
    </div>
  );
  return (
    <TableFrame title="Memberships" file={`memberships-${file}`} table={table} tools={tools}>
      <TableScroll label="Memberships of detections">
        <table class="grid">
          <HeadRow heads={["Detection", ...groups.map((group) => numberHead(group || "noise"))]} />
          <tbody>
            {[...iteration.memberships].map(([detection, row]) => (
              <tr>
                <th scope="row" class="mono">
                  {detection}
                </th>
                {groups.map((group) => (
                  <td class="num grid-cell" style={{ "--shade": (row.get(group) ?? 0).toFixed(3) }}>
                    {row.has(group) ? probability(row.get(group)) : "–"}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}

/**
 * Where the reports lie that were grouped then; of tracks only their measurements' space is known.
 */
async function detectionsAt(
  jobId: string,
  problem: Problem,
): Promise<{ id: string; place: Place }[]> {
  if (problem.time_s === undefined) return [];
  const { detection_id, x_m, y_m } = (await getPlanAt(jobId, problem.time_s)).detections.columns;
  return detection_id.flatMap((id, row) =>
    typeof x_m[row] === "number" && typeof y_m[row] === "number"
      ? [{ id, place: [x_m[row], y_m[row]] as Place }]
      : [],
  );
}

function CentrePicture({
  jobId,
  problem,
  at,
  file,
}: {
  jobId: string;
  problem: Problem;
  at: number;
  file: string;
}): JSX.Element | null {
  const detections = useResource(() => detectionsAt(jobId, problem), [jobId, problem]).data;
  const paths = useMemo(() => pathsOf(problem, at), [problem, at]);
  const inPlane = problem.time_s !== undefined;
  if (!detections || !paths.length) return null;
  return (
    <CentrePaths
      title={`Ways of the centres, ${problem.name}`}
      file={`ways-${file}`}
      paths={paths}
      detections={detections}
      xName={inPlane ? "x, east (m)" : "first value"}
      yName={inPlane ? "y, north (m)" : "second value"}
    />
  );
}

/** The ways up to an iteration; none where centres have one value, which is no place. */
function pathsOf(problem: Problem, at: number): CentrePath[] {
  const ways = new Map<string, Place[]>();
  for (const { centres } of problem.iterations.slice(0, at + 1)) {
    for (const [group, [first, second]] of centres) {
      if (first !== undefined && second !== undefined)
        ways.set(group, [...(ways.get(group) ?? []), [first, second]]);
    }
  }
  return [...ways].map(([group, places]) => ({ group, places }));
}

function Centres({ problem, file }: { problem: Problem; file: string }): JSX.Element {
  const rows = problem.iterations.flatMap((iteration) =>
    [...iteration.centres].map(([group, centre]): Cell[] => [
      iteration.number,
      group,
      centre[0] ?? null,
      centre[1] ?? null,
    ]),
  );
  const last = problem.iterations.at(-1);
  const first = problem.iterations[0];
  return (
    <TableFrame
      title="Centres"
      file={`centres-${file}`}
      table={() => ({ columns: ["iteration", "group", "first", "second"], rows })}
    >
      <TableScroll label="Centres at the first and the last iteration">
        <table class="data">
          <HeadRow
            heads={["Group", ...["First iteration", "Last iteration", "Moved"].map(numberHead)]}
          />
          <tbody>
            {[...(last?.centres ?? [])].map(([group, end]) => {
              const begin = first?.centres.get(group) ?? end;
              return (
                <tr>
                  <td class="mono">{group}</td>
                  <td class="num">{begin.map(number).join(", ")}</td>
                  <td class="num">{end.map(number).join(", ")}</td>
                  <td class="num">
                    {number(
                      Math.hypot(...end.map((value, axis) => value - (begin[axis] ?? value))),
                    )}
                  </td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
  );
}
