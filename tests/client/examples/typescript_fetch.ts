import { openAsBlob } from "node:fs";
import {
  Configuration,
  DatasetsApi,
  instanceOfAssociateReport,
  JobsApi,
  ResultsApi,
} from "./generated";

const service = new Configuration({ basePath: process.env.TRACKLOOM_URL });
const dataset = await new DatasetsApi(service).uploadRawDataset({
  body: await openAsBlob("detections.csv"),
  name: "trial 7",
});
const sensors = [{ sensorId: "radar", pD: 0.95, clutterPerM2: 1e-9, sigmaXM: 10, sigmaYM: 10 }];
const input = { source: "dataset" as const, datasetId: dataset.id };
const job = await new JobsApi(service).createAssociateJob({
  associateRequest: { input, sensors },
  prefer: "wait=30",
});
const report = await new ResultsApi(service).getJobReport({ id: job.id });
if (instanceOfAssociateReport(report))
  console.log(report.result.association.counts.detections, "detections");
