// The grid of a campaign that is running: how many runs each cell has. The cells take turns, so that follows from their sum.

import type { JSX } from "preact";
import { getSpec } from "../api/client";
import type { Job } from "../api/types";
import { useResource } from "../components/resource";
import { count } from "../format";
import { axesOf, combinations } from "./campaign-axes";
import { CellTable } from "./cell-table";

export function CampaignProgress({ job }: { job: Job }): JSX.Element | null {
  const spec = useResource(() => getSpec(job.id), [job.id]);
  if (!spec.data) return null;
  const axes = axesOf(spec.data);
  const cells = combinations(axes).length;
  const runs = Number(spec.data["runs"] ?? 1);
  if (spec.data["stop_at"]) return <p class="muted">A cell ends as soon as its interval is narrow enough: {count(cells)} cells have {count(runs)} runs at most.</p>;
  const done = job.progress?.step === "run" ? job.progress.done : job.progress ? (job.progress.step === "write" ? cells * runs : 0) : 0;
  const doneIn = (index: number) => Math.floor(done / cells) + (index < done % cells ? 1 : 0);
  const cell = (_: string[], __: string, index: number) => {
    const ready = doneIn(index);
    return (
      <td class="num grid-cell" style={{ "--shade": (ready / runs).toFixed(3) }}>
        <b>{count(ready)}</b>
        <span class="sub">
          of {count(runs)} {runs === 1 ? "run" : "runs"}
        </span>
      </td>
    );
  };
  return <CellTable axes={axes} label="Runs of every cell" cell={cell} />;
}
