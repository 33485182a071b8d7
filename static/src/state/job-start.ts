// When the data of a job begin: its first scan, or where there are none its first point of truth or
// track.

import { getPlan, getScanCounts } from "../api/client";
import { useResource } from "../components/resource";
import { originOf } from "../times";

async function startOf(jobId: string): Promise<number | undefined> {
  const scans = (await getScanCounts(jobId)).columns.time_s;
  if (scans.length) return scans[0];
  const { truth, tracks } = await getPlan(jobId);
  const times = [...truth.columns.time_s, ...tracks.columns.time_s];
  return times.length ? times.reduce((least, time) => Math.min(least, time)) : undefined;
}

/** Where the times of a job count from; `undefined` until it is known. */
export function useOrigin(jobId: string): number | undefined {
  const start = useResource(async () => ({ origin: originOf(await startOf(jobId)) }), [jobId]);
  // Without an answer the times stand as they are.
  return start.error ? 0 : start.data?.origin;
}
