// Every call to the service, one function each; failures become an ApiError with the service's own problem.

import createClient from "openapi-fetch";
import type { Artifact, Dataset, Job, JobKind, JobPage, Methods, Plan, Preset, Problem, Report, Series, Validation } from "./types";

// eslint-disable-next-line @typescript-eslint/no-explicit-any
const client = createClient<any>({ baseUrl: location.origin, cache: "no-cache" });

export class ApiError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail ?? problem.title);
  }
}

function unreachable(): ApiError {
  return new ApiError({ type: "about:blank", title: "The service does not answer", status: 0, code: "unreachable", detail: "It may be stopped or restarting." });
}

interface Answer {
  data?: unknown;
  error?: unknown;
  response: Response;
}

async function taken<T>(call: Promise<Answer>): Promise<T> {
  const answer = await call.catch(() => {
    throw unreachable();
  });
  if (answer.error === undefined && answer.response.ok) return answer.data as T;
  const problem = answer.error as Partial<Problem> | undefined;
  if (typeof problem?.title === "string") throw new ApiError(problem as Problem);
  throw new ApiError({ type: "about:blank", title: "Unexpected answer", status: answer.response.status, code: "unexpected", detail: `The service answered ${answer.response.status}.` });
}

export interface JobFilter {
  state?: string;
  kind?: string;
  q?: string;
  cursor?: string;
  limit?: number;
}

export const listJobs = (query: JobFilter): Promise<JobPage> => taken(client.GET("/v1/jobs", { params: { query } }));
export const getJob = (id: string): Promise<Job> => taken(client.GET("/v1/jobs/{id}", { params: { path: { id } } }));
export const cancelJob = (id: string): Promise<Job> => taken(client.POST("/v1/jobs/{id}/cancel", { params: { path: { id } } }));
export const rerunJob = (id: string): Promise<Job> => taken(client.POST("/v1/jobs/{id}/rerun", { params: { path: { id } } }));
export const getReport = (id: string): Promise<Report> => taken(client.GET("/v1/jobs/{id}/report", { params: { path: { id } } }));
export const getPlan = (id: string): Promise<Plan> => taken(client.GET("/v1/jobs/{id}/plan", { params: { path: { id } } }));
export const getMethods = (): Promise<Methods> => taken(client.GET("/v1/methods", {}));
export const getVersion = (): Promise<{ version: string }> => taken(client.GET("/v1/version", {}));

export async function listArtifacts(id: string): Promise<Artifact[]> {
  return (await taken<{ items: Artifact[] }>(client.GET("/v1/jobs/{id}/artifacts", { params: { path: { id } } }))).items;
}

export function getSeries(id: string, name: string, query: { track?: string } = {}): Promise<Series> {
  return taken(client.GET("/v1/jobs/{id}/series/{name}", { params: { path: { id, name }, query } }));
}

export async function listPresets(): Promise<Preset[]> {
  return (await taken<{ items: Preset[] }>(client.GET("/v1/presets", {}))).items;
}

export async function listDatasets(): Promise<Dataset[]> {
  return (await taken<{ items: Dataset[] }>(client.GET("/v1/datasets", { params: { query: { limit: 200 } } }))).items;
}

export const validate = (kind: JobKind, spec: unknown): Promise<Validation> => taken(client.POST("/v1/validate", { body: { kind, spec } }));

export function createJob(kind: JobKind, body: unknown): Promise<Job> {
  return taken(client.POST(`/v1/jobs/${kind}`, { body }));
}

/** The meta part goes first: the service reads the parts as they come. */
export function uploadDataset(meta: Record<string, string>, file: File): Promise<Dataset> {
  const form = new FormData();
  form.append("meta", new Blob([JSON.stringify(meta)], { type: "application/json" }));
  form.append("file", file, file.name);
  return taken(client.POST("/v1/datasets", { body: form, bodySerializer: (body: unknown) => body }));
}
