// What the service puts into the page of a job.

import type { AssociationMap, Plan, Report, TrackProbability } from "../api/types";

export interface Data {
  name: string;
  report: Report;
  plan: Plan;
  association_map: AssociationMap;
  /** Of the most doubtful tracks. */
  probabilities: TrackProbability[];
  /** As CSV. */
  causes: string;
  /** What the job has more of, in words. */
  left_out: string[];
}
