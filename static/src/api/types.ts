// The shapes that the dashboard reads from the service.

export type JobKind = "simulate" | "associate" | "evaluate";
export type JobState = "queued" | "running" | "succeeded" | "failed" | "canceled";

export interface Fault {
  pointer: string;
  code: string;
  detail: string;
  allowed?: string | null;
  line?: number | null;
  column?: string | null;
}

export interface Problem {
  type: string;
  title: string;
  status: number;
  detail?: string | null;
  code: string;
  request_id?: string | null;
  errors?: Fault[];
}

export interface Progress {
  step: string;
  done: number;
  total: number;
  fraction: number;
  eta_s?: number | null;
}

export interface Job {
  id: string;
  kind: JobKind;
  state: JobState;
  name?: string | null;
  labels: Record<string, string>;
  created_at: string;
  started_at?: string | null;
  finished_at?: string | null;
  cancel_requested_at?: string | null;
  can_cancel: boolean;
  progress?: Progress | null;
  error?: Problem | null;
  warnings: string[];
  depends_on: string[];
  seed: number;
  engine_version: string;
  spec_sha256: string;
  duplicate_of?: string | null;
  rerun_of?: string | null;
}

export interface JobPage {
  items: Job[];
  next_cursor?: string | null;
  total?: number | null;
}

export type Cell = number | string | null;
export type Columns = Record<string, Cell[]>;

export interface Reduced {
  columns: Columns;
  source_points: number;
  returned_points: number;
  method: string;
}

export interface Series extends Reduced {
  name: string;
  units: Record<string, string>;
}

export interface SensorSettings {
  sensor_id: string;
  x_m?: number | null;
  y_m?: number | null;
  max_range_m?: number | null;
}

export interface Plan {
  truth: Reduced;
  detections: Reduced;
  tracks: Reduced;
  extent: { x_min_m?: number; x_max_m?: number; y_min_m?: number; y_max_m?: number };
  scans: { number: number; time_s: number; sensor_id: string }[];
  sensors: SensorSettings[];
}

export type VerdictName = "correct" | "missed" | "false";

export interface TargetVerdict {
  truth_id: string;
  verdict: VerdictName;
  at_scan?: number | null;
  at_time_s?: number | null;
  expected?: string | null;
  took?: string | null;
  took_kind?: string | null;
  took_truth_id?: string | null;
  track_id?: string | null;
  errors: number;
  log_probability?: number | null;
  start_scan?: number | null;
  matched_track_id?: string | null;
}

export interface Tfa {
  counts: { targets: number; output_tracks: number; correct: number; missed: number; false: number; matched_tracks: number; redundant_tracks: number; false_tracks: number };
  ratios: { correct_per_target: number | null; output_tracks_per_target: number | null };
  missed_with_matched_track: number;
  violations: unknown[];
  warnings: string[];
  probability: { correct: number | null; missed: number | null; false: number | null };
  targets: TargetVerdict[];
  output_tracks: { track_id: string; class: string; follows?: string | null }[];
}

export interface ReportInput {
  role: string;
  source: string;
  dataset_id?: string | null;
  job_id?: string | null;
  sha256: string;
}

export interface Report {
  kind: JobKind;
  job_id: string;
  spec: unknown;
  seed: number;
  engine_version: string;
  inputs: ReportInput[];
  warnings: string[];
  timing: Record<string, number | null>;
  result: {
    counts?: Record<string, number>;
    sensors?: SensorSettings[];
    association?: { method: string; counts: Record<string, number>; sensors: SensorSettings[] };
    tfa?: Tfa;
  };
}

export interface Artifact {
  name: string;
  media_type: string;
  bytes: number;
  sha256: string;
  href: string;
}

export interface Dataset {
  id: string;
  name: string;
  kind: string;
  format: string;
  bytes: number;
  sensor_ids: string[];
  scans: number;
  rows: number;
  created_at: string;
  warnings: string[];
}

export interface Preset {
  name: string;
  summary: string;
  kind: JobKind;
  body: Record<string, unknown>;
}

/** JSON Schema as the catalogue writes it. */
export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string;
  title?: string;
  description?: string;
  default?: unknown;
  enum?: string[];
  const?: string;
  oneOf?: Schema[];
  properties?: Record<string, Schema>;
  additionalProperties?: boolean | Schema;
  required?: string[];
  items?: Schema;
  minItems?: number;
  maxItems?: number;
  maxLength?: number;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
  "x-unit"?: string;
  "x-allowed"?: string;
}

export interface Methods {
  requests: Record<JobKind, Schema>;
}

export interface Validation {
  valid: boolean;
  errors: Fault[];
  warnings: string[];
  estimate?: { detections: number; cost_s: number; bytes: number } | null;
}
