// Truths and tracks that are boxes in a video: they have no place in the plane, and only the data
// sets that a job read know of them.

import { getDataset } from "../api/client";
import type { Report } from "../api/types";

export interface Boxes {
  truths: number;
  tracks: number;
}

const OF_BOXES = "mot";

export async function boxesOf(report: Report): Promise<Boxes> {
  const boxes = { truths: 0, tracks: 0 };
  const read = report.inputs.filter((input) => input.dataset_id);
  // A data set may have been deleted since.
  const sets = await Promise.all(
    read.map((input) => getDataset(input.dataset_id ?? "").catch(() => undefined)),
  );
  sets.forEach((set, index) => {
    if (set?.format !== OF_BOXES) return;
    boxes[read[index]?.role === "truth" ? "truths" : "tracks"] += set.objects;
  });
  return boxes;
}
