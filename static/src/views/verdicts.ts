// What a verdict says in words, and where it sends the reader.

import type { TargetVerdict } from "../api/types";

export function took(verdict: TargetVerdict): string {
  if (verdict.took_kind === "ended") return "the track had ended";
  if (verdict.took_kind === "epsilon") return "ε (no detection)";
  return verdict.took ?? "–";
}

export function tookKind(verdict: TargetVerdict): string {
  if (verdict.took_kind === "target") return `target ${verdict.took_truth_id ?? ""}`;
  if (verdict.took_kind === "epsilon") return "none";
  return verdict.took_kind ?? "–";
}

function missed(verdict: TargetVerdict): string {
  if (!verdict.start_scan) return "The target was never detected.";
  const late = verdict.matched_track_id ? ` Track ${verdict.matched_track_id} took it up later.` : "";
  return `No track began with the target's first detection, at scan ${verdict.start_scan}.${late}`;
}

export function sentence(verdict: TargetVerdict): string {
  if (verdict.verdict === "correct") return `Track ${verdict.track_id ?? verdict.matched_track_id ?? ""} followed the target all its way.`;
  if (verdict.verdict === "missed") return missed(verdict);
  const expected = verdict.expected ?? "nothing: the target had ended";
  return `At scan ${verdict.at_scan ?? "–"} track ${verdict.track_id ?? ""} took ${took(verdict)}${verdict.took_kind === "target" ? ` of target ${verdict.took_truth_id ?? ""}` : verdict.took_kind === "clutter" ? " (clutter)" : ""}; expected ${expected}.`;
}

/** Address parameters that show where a verdict was decided. */
export function placeOf(verdict: TargetVerdict): Record<string, string | number | null> {
  return {
    tab: "plan",
    time: verdict.at_time_s ?? null,
    truth: verdict.truth_id,
    track: verdict.track_id ?? verdict.matched_track_id ?? null,
    centre: "selection",
    span: null,
  };
}
