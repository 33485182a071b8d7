// Every call to the service, one function each; failures become an ApiError with the service's own
// problem.

import createClient from "openapi-fetch";
import type { components, paths } from "../../generated/api";
import { isShut } from "../state/door";
import type {
  Artifact,
  AssociationMap,
  BearingTime,
  CampaignSoFar,
  Comparison,
  Dataset,
  DatasetPage,
  DatasetPreview,
  Gates,
  Inspection,
  Job,
  JobKind,
  JobPage,
  Methods,
  MetricsSeries,
  ModeProbability,
  Plan,
  Preset,
  Problem,
  Report,
  ScanCounts,
  TrackProbability,
  Usage,
  Validation,
} from "./types";

export const client = createClient<paths>({ baseUrl: location.origin, cache: "no-cache" });

export class ApiError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail ?? problem.title);
  }
}

function own(title: string, code: string, detail: string, status = 0): ApiError {
  return new ApiError({ type: "about:blank", title, status, code, detail });
}

interface Answer<T> {
  data?: T;
  error?: unknown;
  response: Response;
}

export async function taken<T>(call: Promise<Answer<T>>): Promise<T> {
  const answer = await call.catch(() => {
    throw own("The service does not answer", "unreachable", "It may be stopped or restarting.");
  });
  if (answer.data !== undefined && answer.response.ok) return answer.data;
  const problem = answer.error as Partial<Problem> | undefined;
  if (problem?.code === "unauthenticated") isShut.value = true;
  if (typeof problem?.title === "string") throw new ApiError(problem as Problem);
  const { status } = answer.response;
  throw own("Unexpected answer", "unexpected", `The service answered ${status}.`, status);
}

export interface JobFilter {
  state?: string;
  kind?: string;
  q?: string;
  cursor?: string;
  limit?: number;
}

const path = (id: string) => ({ params: { path: { id } } });

export const listJobs = (query: JobFilter): Promise<JobPage> =>
  taken(client.GET("/v1/jobs", { params: { query } }));
export const getJob = (id: string): Promise<Job> => taken(client.GET("/v1/jobs/{id}", path(id)));
export const cancelJob = (id: string): Promise<Job> =>
  taken(client.POST("/v1/jobs/{id}/cancel", path(id)));
export const rerunJob = (id: string): Promise<Job> =>
  taken(client.POST("/v1/jobs/{id}/rerun", path(id)));
export const pinJob = (id: string, pinned: boolean): Promise<Job> =>
  taken(client.PATCH("/v1/jobs/{id}", { ...path(id), body: { pinned } }));
export const getUsage = (): Promise<Usage> => taken(client.GET("/v1/usage"));
export const getReport = (id: string): Promise<Report> =>
  taken(client.GET("/v1/jobs/{id}/report", path(id)));
export const getCampaignCells = (id: string): Promise<CampaignSoFar> =>
  taken(client.GET("/v1/jobs/{id}/cells", path(id)));

const KEPT = 4;
const kept = new Map<string, Promise<unknown>>();

/**
 * The answer to a question whose answer never changes; the last few are kept, so that they can be
 * asked ahead of their view.
 */
function once<T>(question: string, ask: () => Promise<T>): Promise<T> {
  const answer = (kept.get(question) as Promise<T> | undefined) ?? ask();
  kept.delete(question);
  kept.set(question, answer);
  answer.catch(() => kept.delete(question));
  for (const oldest of [...kept.keys()].slice(0, -KEPT)) kept.delete(oldest);
  return answer;
}

export const getPlan = (id: string): Promise<Plan> =>
  once(`plan ${id}`, () => taken(client.GET("/v1/jobs/{id}/plan", path(id))));
/** Only what was there from one time to another. */
export function getPlanWindow(id: string, from: number, to: number): Promise<Plan> {
  return taken(client.GET("/v1/jobs/{id}/plan", { params: { path: { id }, query: { from, to } } }));
}
/** Only what was there at one time. */
export const getPlanAt = (id: string, time_s: number): Promise<Plan> =>
  getPlanWindow(id, time_s, time_s);
const MOST_TRACK_POINTS = 5000;
/** One track whole, among few of the other points. */
export const getPlanOfTrack = (id: string, track: string): Promise<Plan> =>
  taken(
    client.GET("/v1/jobs/{id}/plan", {
      params: { path: { id }, query: { track, max_points: MOST_TRACK_POINTS } },
    }),
  );
/** The request of a job, as the form of its kind shows it. */
export const getSpec = async (id: string): Promise<Record<string, unknown>> =>
  withoutKind(await taken(client.GET("/v1/jobs/{id}/spec", path(id))));

/** The schemas in it are free JSON to the API document; here they are read as what they are. */
export async function getMethods(): Promise<Methods> {
  return (await taken(client.GET("/v1/methods"))) as unknown as Methods;
}

export async function listArtifacts(id: string): Promise<Artifact[]> {
  return (await taken(client.GET("/v1/jobs/{id}/artifacts", path(id)))).items;
}

/** The text of a file of a job. */
export async function getArtifactText(id: string, name: string): Promise<string> {
  const at = { params: { path: { id, name } }, parseAs: "text" as const };
  return (await taken(client.GET("/v1/jobs/{id}/artifacts/{name}", at))) as unknown as string;
}

/** The series of one name has one shape, which the path cannot say. */
function series<T>(
  id: string,
  name: string,
  query: { track?: string; max_points?: number },
): Promise<T> {
  return taken(
    client.GET("/v1/jobs/{id}/series/{name}", { params: { path: { id, name }, query } }),
  ) as Promise<T>;
}

export const getTrackProbability = (id: string, track: string): Promise<TrackProbability> =>
  series(id, "track_probability", { track });
const MOST_MAP_POINTS = 400_000;
export const getAssociationMap = (id: string): Promise<AssociationMap> =>
  once(`map ${id}`, () => series(id, "association_map", { max_points: MOST_MAP_POINTS }));
export const getModeProbability = (id: string, track: string): Promise<ModeProbability> =>
  series(id, "mode_probability", { track });
export const getGates = (id: string, track: string): Promise<Gates> =>
  series(id, "gates", { track });
export const getMetricSeries = (id: string): Promise<MetricsSeries> => series(id, "metrics", {});
export const getBearingTime = (id: string): Promise<BearingTime> => series(id, "bearing_time", {});
export const getScanCounts = (id: string): Promise<ScanCounts> =>
  once(`scan_counts ${id}`, () => series(id, "scan_counts", {}));

export async function listPresets(): Promise<Preset[]> {
  return (await taken(client.GET("/v1/presets"))).items.map((preset) => ({
    ...preset,
    body: withoutKind(preset.body),
  }));
}

export function compareJobs(job: string[], baseline: string | undefined): Promise<Comparison> {
  return taken(
    client.GET("/v1/compare", { params: { query: { job, ...(baseline ? { baseline } : {}) } } }),
  );
}

export interface DatasetFilter {
  kind?: string;
  q?: string;
  cursor?: string;
  limit?: number;
}

export const pageOfDatasets = (query: DatasetFilter): Promise<DatasetPage> =>
  taken(client.GET("/v1/datasets", { params: { query } }));
export const previewDataset = (id: string, limit: number): Promise<DatasetPreview> =>
  taken(client.GET("/v1/datasets/{id}/preview", { params: { path: { id }, query: { limit } } }));

/** The text of a data set as it was uploaded. */
export async function getDatasetText(id: string): Promise<string> {
  return (await taken(
    client.GET("/v1/datasets/{id}/content", { ...path(id), parseAs: "text" }),
  )) as unknown as string;
}

/** The file of a data set in another format. */
export async function getDatasetAs(id: string, format: string): Promise<Blob> {
  const params = { path: { id }, query: { format } };
  return (await taken(
    client.GET("/v1/datasets/{id}/content", { params, parseAs: "blob" }),
  )) as unknown as Blob;
}

export async function deleteDataset(id: string): Promise<void> {
  const { error, response } = await client.DELETE("/v1/datasets/{id}", path(id));
  if (!response.ok) await taken(Promise.resolve({ error, response }));
}

export const getDataset = (id: string): Promise<Dataset> =>
  taken(client.GET("/v1/datasets/{id}", path(id)));

export async function listDatasets(kind: Dataset["kind"] | undefined): Promise<Dataset[]> {
  const query = { limit: 200, ...(kind ? { kind } : {}) };
  return (await taken(client.GET("/v1/datasets", { params: { query } }))).items;
}

function withoutKind({
  kind: _,
  ...body
}: components["schemas"]["JobSpec"]): Record<string, unknown> {
  return body;
}

/** The form does not promise a valid body: the service judges it. */
export const validate = (kind: JobKind, body: Record<string, unknown>): Promise<Validation> =>
  taken(client.POST("/v1/validate", { body: { ...body, kind } as never }));

export function createJob(kind: JobKind, body: Record<string, unknown>): Promise<Job> {
  return taken(client.POST(`/v1/jobs/${kind}`, { body: body as never }));
}

/** The meta part goes first, so that the service can read the file as it comes. */
function uploadForm(meta: object, file: File) {
  const form = new FormData();
  form.append("meta", new Blob([JSON.stringify(meta)], { type: "application/json" }));
  form.append("file", file, file.name);
  const body = form as unknown as components["schemas"]["DatasetUpload"];
  return { body, bodySerializer: () => form };
}

export const uploadDataset = (meta: object, file: File): Promise<Dataset> =>
  taken(client.POST("/v1/datasets", uploadForm(meta, file)));

/** What an upload of the file would give; nothing of it is kept. */
export async function inspectDataset(
  meta: object,
  file: File,
  signal: AbortSignal,
): Promise<Inspection> {
  const dry = "/v1/datasets?dry_run=true" as "/v1/datasets";
  const answer = await taken(client.POST(dry, { ...uploadForm(meta, file), signal }));
  return answer as unknown as Inspection;
}
