import { openAsBlob } from "node:fs";
import { createAssociateJob, getJobReport, streamJobEvents, uploadRawDataset } from "./generated";
import { client } from "./generated/client.gen";

client.setConfig({ baseUrl: process.env.TRACKLOOM_URL, throwOnError: true });
const file = { body: await openAsBlob("detections.csv"), query: { name: "trial 7" } };
const dataset = await uploadRawDataset<true>(file);
const sensors = [
  { sensor_id: "radar", p_d: 0.95, clutter_per_m2: 1e-9, sigma_x_m: 10, sigma_y_m: 10 },
];
const job = await createAssociateJob<true>({
  body: { input: { source: "dataset", dataset_id: dataset.data.id }, sensors },
});
for await (const event of (await streamJobEvents({ path: { id: job.data.id } })).stream)
  console.error(event.type);
const report = await getJobReport<true>({ path: { id: job.data.id } });
if (report.data.kind === "associate")
  console.log(report.data.result.association.counts.detections, "detections");
