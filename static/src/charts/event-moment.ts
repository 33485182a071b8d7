// An event at its moment: what it says in words, and where it is shown.

import { hereHref, param } from "../state/url";

/** What happened to whom when. */
export interface EventMoment {
  kind: string;
  time: number;
  truth: string;
  track: string;
  /** Of a switch: the track that followed the target before. */
  before: string;
}

/**
 * In the plan view, with the event beside it. The former track of a switch is known to the log
 * alone, so that the address has it.
 */
export function planHref({ kind, time, truth, track, before }: EventMoment): string {
  const event = { mark: `${kind}@${time}`, former: before || null };
  return hereHref({
    tab: "plan",
    truth: truth || null,
    track: track || null,
    time,
    centre: "selection",
    span: null,
    ...event,
  });
}

/** Among the lanes, where there is no plan. */
export function laneHref({ time, truth, track }: EventMoment): string {
  return hereHref({ truth: truth || null, track: track || null, time });
}

/** What takes the event out of the address when something else is chosen. */
export const NO_EVENT = { mark: null, former: null };

/** The event that the address names: its time stays when the clock goes on. */
export function addressedEvent(): EventMoment | undefined {
  const [kind, time] = (param("mark") ?? "").split("@");
  if (!kind || !time || !Number.isFinite(Number(time))) return undefined;
  return {
    kind,
    time: Number(time),
    truth: param("truth") ?? "",
    track: param("track") ?? "",
    before: param("former") ?? "",
  };
}

export function eventSentence({ kind, truth, track, before }: EventMoment): string | undefined {
  const other = before ? `; before it was track ${before}` : ", another than before";
  const last = track ? `; until here it was track ${track}` : "";
  const from = `From here on track ${track}`;
  const gate = `the gate of ${truth || "its target"}`;
  const sentences: Record<string, string> = {
    match: `Track ${track} follows ${truth} here.`,
    miss: `No track follows ${truth} here.`,
    switch: `${from} follows ${truth}${other}.`,
    break: `From here on no track follows ${truth}${last}.`,
    reacquisition: `${from} follows ${truth}, which no track followed just before.`,
    redundant: `Track ${track} is near ${truth}, which another track follows.`,
    divergence: `Track ${track} is beyond ${gate}, which it followed before.`,
    false_alarm: `Track ${track} follows no target here.`,
  };
  return sentences[kind];
}
