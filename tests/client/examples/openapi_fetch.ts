import { readFile } from "node:fs/promises";
import createClient from "openapi-fetch";
import type { paths } from "./generated/api";

const client = createClient<paths>({ baseUrl: process.env.TRACKLOOM_URL });
const file = {
  body: await readFile("detections.csv", "utf8"),
  bodySerializer: (text: string) => text,
};
const headers = { "Content-Type": "application/octet-stream" };
const dataset = await client.POST("/v1/datasets/raw", {
  ...file,
  headers,
  params: { query: { name: "trial 7" } },
});
if (!dataset.data) throw new Error(dataset.error.detail);
const sensors = [
  { sensor_id: "radar", p_d: 0.95, clutter_per_m2: 1e-9, sigma_x_m: 10, sigma_y_m: 10 },
];
const body = { input: { source: "dataset" as const, dataset_id: dataset.data.id }, sensors };
const job = await client.POST("/v1/jobs/associate", {
  body,
  params: { header: { Prefer: "wait=30" } },
});
if (!job.data) throw new Error(job.error.detail);
const report = await client.GET("/v1/jobs/{id}/report", { params: { path: { id: job.data.id } } });
if (report.data?.kind === "associate")
  console.log(report.data.result.association.counts.detections, "detections");
