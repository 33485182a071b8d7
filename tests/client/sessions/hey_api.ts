// A session with the client of @hey-api/openapi-ts: upload, associate, evaluate, wait by its
// events, report, a typed refusal.

import { deepStrictEqual as same } from "node:assert";
import { readFileSync } from "node:fs";
import type { DatasetInfo, Job, Problem } from "./generated";
import {
  closeSession,
  createAssociateJob,
  createJob,
  createSession,
  downloadDataset,
  getJob,
  getJobReport,
  listSessionTracks,
  pushScans,
  streamJobEvents,
  streamSessionEvents,
  uploadRawDataset,
} from "./generated";
import { client } from "./generated/client.gen";

const [address = "", data = ""] = process.argv.slice(2);
client.setConfig({ baseUrl: address, throwOnError: false });

async function upload(name: string, kind: DatasetInfo["kind"]): Promise<DatasetInfo> {
  const body = new Blob([readFileSync(`${data}/${name}`)]);
  return (await uploadRawDataset({ body, query: { name, kind }, throwOnError: true })).data;
}

/** Follows the job to its end. */
async function succeeded(job: Job): Promise<Job> {
  const { stream } = await streamJobEvents({ path: { id: job.id } });
  const types: string[] = [];
  for await (const event of stream) {
    same(event.job_id, job.id);
    types.push(event.type);
    if (event.type === "done") same(event.data.state, "succeeded");
  }
  same(types.at(-1), "done");
  return (await getJob({ path: { id: job.id }, throwOnError: true })).data;
}

const [detections, truth] = [
  await upload("detections.csv", "detections"),
  await upload("truth.csv", "truth"),
];
same([detections.rows, truth.objects], [24, 2]);
const content = await downloadDataset({
  path: { id: truth.id },
  parseAs: "text",
  throwOnError: true,
});
same(content.data as unknown, readFileSync(`${data}/truth.csv`, "utf8"));

const queued = await createAssociateJob({
  body: {
    input: { source: "dataset", dataset_id: detections.id },
    sensors: [
      { sensor_id: "radar", p_d: 0.95, clutter_per_m2: 1e-9, sigma_x_m: 10, sigma_y_m: 10 },
    ],
    associator: { method: "nearest_neighbour" },
    tracker: { initial_speed_sigma_mps: 60 },
  },
  throwOnError: true,
});
const associated = await succeeded(queued.data);
const asked = await createJob({
  body: {
    kind: "evaluate",
    tracks: { source: "job", job_id: associated.id },
    truth: { source: "dataset", dataset_id: truth.id },
  },
  throwOnError: true,
});
const judged = await succeeded(asked.data);
const report = (await getJobReport({ path: { id: judged.id }, throwOnError: true })).data;
if (report.kind !== "evaluate") throw new Error("not the report of an evaluation");
const counts = report.result.tfa?.counts;
same([counts?.targets, counts?.correct, counts?.missed, counts?.false], [2, 2, 0, 0]);

const refused = await createAssociateJob({
  body: { input: { source: "dataset", dataset_id: detections.id }, seed: -1 },
});
const problem: Problem | undefined = refused.error;
same(
  [problem?.status, problem?.code, problem?.errors?.map((fault) => [fault.pointer, fault.code])],
  [422, "validation", [["/seed", "out_of_range"]]],
);
// A live session, its events followed while scans are pushed.
const session = (
  await createSession({
    body: {
      sensors: [
        { sensor_id: "radar", p_d: 0.95, clutter_per_m2: 1e-9, sigma_x_m: 10, sigma_y_m: 10 },
      ],
      tracker: { initial_speed_sigma_mps: 60 },
    },
    throwOnError: true,
  })
).data;
const path = { id: session.id };
async function pushAll(): Promise<void> {
  for (let index = 0; index < 4; index++) {
    const detections = [{ x_m: 100 * index, y_m: 5 }];
    const body = { sensor_id: "radar", sequence: index, time_s: 2 * index, detections };
    const pushed = (await pushScans({ path, body, throwOnError: true })).data;
    same([pushed.entries, pushed.scans[0]?.fate], [index + 1, "taken"]);
  }
}
const pushing = pushAll();
const kinds: string[] = [];
const { stream } = await streamSessionEvents({ path });
for await (const event of stream) {
  kinds.push(event.kind);
  if (event.kind === "confirmed") break;
}
await pushing;
same(kinds, ["started", "confirmed"]);
const live = (await listSessionTracks({ path, query: { at_s: 8 }, throwOnError: true })).data;
same([live.tracks.length, Math.round((live.tracks[0]?.x_m ?? 0) / 10)], [1, 40]);
const closed = (await closeSession({ path, throwOnError: true })).data;
same([closed.state, closed.track_ids], ["closed", ["1"]]);
console.log("@hey-api/openapi-ts: ok");
