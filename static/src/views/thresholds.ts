// Lines that a request draws into the pictures of its job.

import type { Report } from "../api/types";
import type { Threshold } from "../charts/ribbon-paint";

/** Defaults of `undetected`, which a request may leave out as a whole. */
const [REPORTED, RECYCLED] = [0.5, 0.1];

/** The probabilities of existence at which tracks come and go, as the request says. */
export function thresholdsOf(report: Report): Threshold[] {
  const { tracker = {} } = report.spec as { tracker?: Record<string, unknown> };
  const { confirmation, undetected } = tracker as Record<string, Record<string, unknown>>;
  const named =
    tracker.method === "poisson_multi_bernoulli"
      ? {
          "told above": undetected?.report_existence ?? REPORTED,
          "undetected below": undetected?.recycle_existence ?? RECYCLED,
        }
      : {
          "confirmed at": confirmation?.confirm_existence,
          "deleted at": confirmation?.delete_existence,
        };
  return Object.entries(named).flatMap(([name, existence]) =>
    typeof existence === "number" ? [{ name, existence }] : [],
  );
}
