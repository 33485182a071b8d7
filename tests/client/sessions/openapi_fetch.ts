// A session with openapi-fetch and the types of openapi-typescript: upload, associate, evaluate,
// wait, report, a typed refusal.

import { deepStrictEqual as same } from "node:assert";
import { readFileSync } from "node:fs";
import createClient from "openapi-fetch";
import type { components, paths } from "./generated/api";

type Schemas = components["schemas"];

const [address = "", data = ""] = process.argv.slice(2);
const client = createClient<paths>({ baseUrl: address });
const PATIENT = { header: { Prefer: "wait=30" } };

/** The file itself is the body, which is text to the types. */
async function upload(
  name: string,
  kind: Schemas["DatasetInfo"]["kind"],
): Promise<Schemas["DatasetInfo"]> {
  const { data: dataset, error } = await client.POST("/v1/datasets/raw", {
    params: { query: { name, kind } },
    headers: { "Content-Type": "application/octet-stream" },
    body: readFileSync(`${data}/${name}`, "utf8"),
    bodySerializer: (text) => text,
  });
  if (!dataset) throw new Error(error.detail);
  return dataset;
}

function succeeded({
  data: job,
  error,
}: {
  data?: Schemas["Job"];
  error?: Schemas["Problem"];
}): Schemas["Job"] {
  if (!job) throw new Error(error?.detail);
  same(job.state, "succeeded");
  return job;
}

const [detections, truth] = [
  await upload("detections.csv", "detections"),
  await upload("truth.csv", "truth"),
];
same([detections.rows, truth.objects], [24, 2]);
const content = await client.GET("/v1/datasets/{id}/content", {
  params: { path: { id: truth.id } },
  parseAs: "text",
});
same(content.data, readFileSync(`${data}/truth.csv`, "utf8"));

const associated = succeeded(
  await client.POST("/v1/jobs/associate", {
    params: PATIENT,
    body: {
      input: { source: "dataset", dataset_id: detections.id },
      sensors: [
        { sensor_id: "radar", p_d: 0.95, clutter_per_m2: 1e-9, sigma_x_m: 10, sigma_y_m: 10 },
      ],
      associator: { method: "nearest_neighbour" },
      tracker: { initial_speed_sigma_mps: 60 },
    },
  }),
);
const spec: Schemas["JobSpec"] = {
  kind: "evaluate",
  tracks: { source: "job", job_id: associated.id },
  truth: { source: "dataset", dataset_id: truth.id },
};
same((await client.POST("/v1/validate", { body: spec })).data?.valid, true);
const judged = succeeded(await client.POST("/v1/jobs", { params: PATIENT, body: spec }));
const { data: report } = await client.GET("/v1/jobs/{id}/report", {
  params: { path: { id: judged.id } },
});
if (report?.kind !== "evaluate") throw new Error("not the report of an evaluation");
const counts = report.result.tfa?.counts;
same([counts?.targets, counts?.correct, counts?.missed, counts?.false], [2, 2, 0, 0]);

const refused = await client.POST("/v1/jobs/associate", {
  body: { input: { source: "dataset", dataset_id: detections.id }, seed: -1 },
});
const problem: Schemas["Problem"] | undefined = refused.error;
same(
  [problem?.status, problem?.code, problem?.errors?.map((fault) => [fault.pointer, fault.code])],
  [422, "validation", [["/seed", "out_of_range"]]],
);
// A live session.
const made = await client.POST("/v1/sessions", {
  body: {
    sensors: [
      { sensor_id: "radar", p_d: 0.95, clutter_per_m2: 1e-9, sigma_x_m: 10, sigma_y_m: 10 },
    ],
    tracker: { initial_speed_sigma_mps: 60 },
  },
});
if (!made.data) throw new Error(made.error.detail);
const params = { path: { id: made.data.id } };
for (let index = 0; index < 4; index++) {
  const detections = [{ x_m: 100 * index, y_m: 5 }];
  const body = { sensor_id: "radar", sequence: index, time_s: 2 * index, detections };
  const pushed = await client.POST("/v1/sessions/{id}/scans", { params, body });
  same([pushed.data?.entries, pushed.data?.scans[0]?.fate], [index + 1, "taken"]);
}
const live = await client.GET("/v1/sessions/{id}/tracks", { params });
same([live.data?.tracks.length, live.data?.tracks[0]?.status], [1, "confirmed"]);
const closed = await client.POST("/v1/sessions/{id}/close", { params });
same([closed.data?.state, closed.data?.track_ids], ["closed", ["1"]]);
console.log("openapi-typescript and openapi-fetch: ok");
