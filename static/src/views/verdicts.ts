// What a verdict says in words, and where it sends the reader.

import type { TargetVerdict } from "../api/types";
import { NO_EVENT } from "../charts/event-moment";

/** What it took, as a cell shows it. */
export function took(verdict: TargetVerdict): string {
  if (verdict.took_kind === "ended") return "nothing";
  if (verdict.took_kind === "epsilon") return "ε";
  return verdict.took ?? "–";
}

export function tookKind(verdict: TargetVerdict): string {
  if (verdict.took_kind === "target") return `target ${verdict.took_truth_id ?? ""}`;
  if (verdict.took_kind === "epsilon") return "no detection";
  if (verdict.took_kind === "ended") return "string ended";
  return verdict.took_kind ?? "–";
}

/** Why no track speaks for a target that was missed. */
function missed({ start_scan, matched_track_id }: TargetVerdict): string {
  if (!start_scan) return "The target was never detected.";
  const late = matched_track_id ? ` Track ${matched_track_id} took it up later.` : "";
  return `No track began with the target's first detection, at scan ${start_scan}.${late}`;
}

function tookText(verdict: TargetVerdict): string {
  if (verdict.took_kind === "epsilon") return "took no detection (ε)";
  if (verdict.took_kind === "target")
    return `took ${verdict.took ?? "–"} of target ${verdict.took_truth_id ?? ""}`;
  return `took ${verdict.took ?? "–"}, which is clutter`;
}

/**
 * The automaton reads a track in strings: a long gap or a long way off ends one, though the track
 * may live on.
 */
function stringEnded({ at_scan, track_id }: TargetVerdict, isAlive: boolean | undefined): string {
  const where = `scan ${at_scan ?? "–"}`;
  if (isAlive === false) return `Before ${where} track ${track_id ?? ""} had ended`;
  const goesOn = isAlive
    ? ", though the track lives on: it was beyond the gate, or without a detection, for too long"
    : "";
  return `Before ${where} the string of track ${track_id ?? ""} had ended${goesOn}`;
}

function wrong(verdict: TargetVerdict, isAlive: boolean | undefined): string {
  const expected = verdict.expected ?? "nothing, since the target had ended";
  if (verdict.took_kind === "ended")
    return `${stringEnded(verdict, isAlive)}; expected ${expected}.`;
  const who = `At scan ${verdict.at_scan ?? "–"} track ${verdict.track_id ?? ""}`;
  return `${who} ${tookText(verdict)}; expected ${expected}.`;
}

/**
 * A verdict with its reason; `isAlive` says whether the track that speaks has a point at that time,
 * where that is known.
 */
export function sentence(verdict: TargetVerdict, isAlive?: boolean): string {
  const track = verdict.track_id ?? verdict.matched_track_id ?? "";
  if (verdict.verdict === "correct") return `Track ${track} followed the target all its way.`;
  return verdict.verdict === "missed" ? missed(verdict) : wrong(verdict, isAlive);
}

/** Why a target is not correct, for the table. */
export function reason(verdict: TargetVerdict): string {
  return verdict.verdict === "correct" ? "–" : sentence(verdict);
}

/** Address parameters that show where a verdict was decided. */
export function placeOf(verdict: TargetVerdict): Record<string, string | number | null> {
  return {
    ...NO_EVENT,
    tab: "plan",
    time: verdict.at_time_s ?? null,
    truth: verdict.truth_id,
    track: verdict.track_id ?? verdict.matched_track_id ?? null,
    centre: "selection",
    span: null,
  };
}
