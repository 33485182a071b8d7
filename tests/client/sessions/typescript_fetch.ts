// A session with the typescript-fetch client of openapi-generator: upload, associate, evaluate,
// wait, report, a typed refusal.

import { deepStrictEqual as same } from "node:assert";
import { readFileSync } from "node:fs";
import {
  Configuration,
  DatasetsApi,
  instanceOfEvaluateReport,
  type Job,
  JobsApi,
  ProblemFromJSON,
  ResponseError,
  ResultsApi,
  SessionsApi,
} from "./generated/index";

const [address = "", data = ""] = process.argv.slice(2);
const configuration = new Configuration({ basePath: address });
const [datasets, jobs, results] = [
  new DatasetsApi(configuration),
  new JobsApi(configuration),
  new ResultsApi(configuration),
];
const bytes = (name: string): Blob => new Blob([readFileSync(`${data}/${name}`)]);

function succeeded(job: Job): Job {
  same(job.state, "succeeded");
  return job;
}

const detections = await datasets.uploadRawDataset({
  body: bytes("detections.csv"),
  name: "detections",
  kind: "detections",
});
const truth = await datasets.uploadRawDataset({
  body: bytes("truth.csv"),
  name: "truth",
  kind: "truth",
});
same([detections.rows, truth.objects], [24, 2]);
same(
  await (await datasets.downloadDataset({ id: truth.id })).text(),
  readFileSync(`${data}/truth.csv`, "utf8"),
);

const associated = succeeded(
  await jobs.createAssociateJob({
    prefer: "wait=30",
    associateRequest: {
      input: { source: "dataset", datasetId: detections.id },
      sensors: [{ sensorId: "radar", pD: 0.95, clutterPerM2: 1e-9, sigmaXM: 10, sigmaYM: 10 }],
      associator: { method: "nearest_neighbour" },
      tracker: { initialSpeedSigmaMps: 60 },
    },
  }),
);
const judged = succeeded(
  await jobs.createJob({
    prefer: "wait=30",
    jobSpec: {
      kind: "evaluate",
      tracks: { source: "job", jobId: associated.id },
      truth: { source: "dataset", datasetId: truth.id },
    },
  }),
);
const report = await results.getJobReport({ id: judged.id });
if (!instanceOfEvaluateReport(report))
  throw new Error(`not the report of an evaluation: ${report.kind}`);
const counts = report.result.tfa?.counts;
same([counts?.targets, counts?.correct, counts?.missed, counts?._false], [2, 2, 0, 0]);

const refused = jobs.createAssociateJob({
  associateRequest: { input: { source: "dataset", datasetId: detections.id }, seed: -1 },
});
const refusal = await refused.then(
  () => undefined,
  (error: unknown) => error,
);
if (!(refusal instanceof ResponseError)) throw new Error("the request was not refused");
const problem = ProblemFromJSON(await refusal.response.json());
same(
  [problem.status, problem.code, problem.errors?.map((fault) => [fault.pointer, fault.code])],
  [422, "validation", [["/seed", "out_of_range"]]],
);
// A live session.
const sessions = new SessionsApi(configuration);
const { id } = await sessions.createSession({
  sessionRequest: {
    sensors: [{ sensorId: "radar", pD: 0.95, clutterPerM2: 1e-9, sigmaXM: 10, sigmaYM: 10 }],
    tracker: { initialSpeedSigmaMps: 60 },
  },
});
for (let index = 0; index < 4; index++) {
  const detections = [{ xM: 100 * index, yM: 5 }];
  const pushedScan = { sensorId: "radar", sequence: index, timeS: 2 * index, detections };
  const pushed = await sessions.pushScans({ id, pushedScan });
  same([pushed.entries, pushed.scans[0]?.fate], [index + 1, "taken"]);
}
const { tracks } = await sessions.listSessionTracks({ id });
same([tracks.length, tracks[0]?.status], [1, "confirmed"]);
const closed = await sessions.closeSession({ id });
same([closed.state, closed.trackIds], ["closed", ["1"]]);
console.log("openapi-generator, typescript-fetch: ok");
