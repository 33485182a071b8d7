// The grid of a campaign that is running: how many runs each cell has. The cells take turns, so that follows from their sum.

import type { JSX } from "preact";
import { getSpec } from "../api/client";
import type { Job } from "../api/types";
import { useResource } from "../components/resource";
import { count } from "../format";
import { axesOf, combinations, rowsAndColumns } from "./campaign-axes";

export function CampaignProgress({ job }: { job: Job }): JSX.Element | null {
  const spec = useResource(() => getSpec(job.id), [job.id]);
  if (!spec.data) return null;
  const axes = axesOf(spec.data);
  const { rows, columns } = rowsAndColumns(axes);
  const cells = combinations(axes).length;
  const runs = Number(spec.data["runs"] ?? 1);
  if (spec.data["stop_at"]) return <p class="muted">A cell ends as soon as its interval is narrow enough: {count(cells)} cells have {count(runs)} runs at most.</p>;
  const done = job.progress?.step === "run" ? job.progress.done : job.progress ? (job.progress.step === "write" ? cells * runs : 0) : 0;
  const doneIn = (index: number) => Math.floor(done / cells) + (index < done % cells ? 1 : 0);
  return (
    <div class="table-scroll" tabIndex={0} role="region" aria-label="Runs of every cell">
      <table class="grid">
        <thead>
          <tr>
            {rows.map((axis) => (
              <th scope="col">{axis.name}</th>
            ))}
            {columns.points.map((point) => (
              <th scope="col" class="num">
                {columns.name ? <span class="sub">{columns.name}</span> : null}
                {point}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {combinations(rows).map((points, row) => (
            <tr>
              {points.map((point) => (
                <th scope="row">{point}</th>
              ))}
              {columns.points.map((_, column) => {
                const ready = doneIn(row * columns.points.length + column);
                return (
                  <td class="num grid-cell" style={{ "--shade": (ready / runs).toFixed(3) }}>
                    <b>{count(ready)}</b>
                    <span class="sub">
                      of {count(runs)} {runs === 1 ? "run" : "runs"}
                    </span>
                  </td>
                );
              })}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
