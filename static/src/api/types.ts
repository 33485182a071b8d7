// Names for the shapes of the service's answers, which are generated from the API document
// (`npm run types`), and the few that the document leaves open.

import type { components } from "../../generated/api";

export type Schemas = components["schemas"];

export type Artifact = Schemas["ArtifactInfo"];
export type Association = Schemas["Association"];
export type CampaignCell = Schemas["CampaignCell"];
export type CampaignSoFar = Schemas["CampaignSoFar"];
export type Comparison = Schemas["Comparison"];
export type CorrelationTuple = Schemas["CorrelationTuple"];
export type CorrelateResult = Schemas["CorrelateResult"];
export type Dataset = Schemas["DatasetInfo"];
export type DatasetPage = Schemas["DatasetPage"];
export type DatasetPreview = Schemas["DatasetPreview"];
export type CauseCount = Schemas["CauseCount"];
export type EventCounts = Schemas["EventCounts"];
export type Fault = Schemas["FaultItem"];
export type Gates = Schemas["GatesSeries"];
export type Grouping = Schemas["GroupingSummary"];
export type Job = Schemas["Job"];
export type JobKind = Schemas["JobKind"];
export type JobPage = Schemas["JobPage"];
export type JobState = Schemas["JobState"];
export type BearingTime = Schemas["BearingTimeSeries"];
export type MetricReport = Schemas["MetricReport"];
export type MetricsSeries = Schemas["MetricsSeries"];
export type Plan = Schemas["PlanView"];
export type Progress = Schemas["Progress"];
export type Report = Schemas["Report"];
export type SensorSettings = Schemas["SensorSettings"];
export type RequirementFinding = Schemas["RequirementFinding"];
export type RequirementsReport = Schemas["RequirementsReport"];
export type ScanCounts = Schemas["ScanCountsSeries"];
export type TargetVerdict = Schemas["TfaTarget"];
export type Tfa = Schemas["Tfa"];
export type TrackProbability = Schemas["TrackProbabilitySeries"] & { origins_known: boolean };
export type ModeProbability = Schemas["ModeProbabilitySeries"];
export type Validation = Schemas["ValidationResult"];

export type Units = Schemas["Units"];
export type Usage = Schemas["Usage"];

/** How the probability of every track was shared: a row a track, the most doubtful first. */
export interface AssociationMap {
  origins_known: boolean;
  time_s: number[];
  rows: AssociationMapRow[];
  source_tracks: number;
  returned_tracks: number;
  source_points: number;
  returned_points: number;
}

/** Shares in thousandths; what is left of 1000 is "no detection". */
export interface AssociationMapRow {
  track_id: string;
  truth_id: string | null;
  doubt: number;
  /** Places in `time_s`. */
  at: number[];
  own: number[];
  other: number[];
  clutter: number[];
}

export interface InspectedSensor {
  sensor_id: string;
  scans: number;
  detections: number;
  lat_deg?: number;
  lon_deg?: number;
  period_s?: number;
}

/** What a file holds, looked at and not kept. */
export interface Inspection {
  kind: Dataset["kind"];
  format: string;
  units: Units;
  scans: number;
  rows: number;
  objects: number;
  sensors: InspectedSensor[];
  time_base: "utc" | "assumed_date" | "relative";
  time?: { start_s: number; end_s: number };
  frame?: Schemas["Frame"];
  area?: { x_m: Span; y_m: Span; lat_deg?: Span; lon_deg?: Span };
  warnings: string[];
  suspicions: string[];
  /** A job to start from, which names the file by its path. */
  job: Record<string, unknown> & { kind: JobKind };
}

type Span = [number, number];

/**
 * A problem of the service, or one that the dashboard states itself (the service cannot be
 * reached).
 */
export type Problem = Pick<Schemas["Problem"], "type" | "title" | "status" | "code"> &
  Partial<Pick<Schemas["Problem"], "detail" | "request_id" | "errors">>;

export type Cell = number | string | null;
export type Columns = Record<string, Cell[]>;

/** What a report may hold, whatever its kind. */
export interface ReportParts extends Partial<Omit<CorrelateResult, "counts" | "sensors">> {
  sensors?: { sensor_id: string }[];
  counts?: object;
  grouping?: Grouping;
  metrics?: Record<string, MetricReport>;
  events?: EventCounts;
  requirements?: RequirementsReport;
  sequences?: Schemas["SequenceMetrics"][];
  detection?: Schemas["DetectionResult"];
  cells?: CampaignCell[];
  confidence?: number;
  outcomes?: string[];
  association?: Association;
  tfa?: Tfa;
}

export function partsOf(report: Report): ReportParts {
  return report.result;
}

export type Preset = Omit<Schemas["PresetInfo"], "body"> & { body: Record<string, unknown> };

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
