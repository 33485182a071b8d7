// Staying up to date: polling that rests while the tab is hidden, and following one job.

import { getJob } from "../api/client";
import type { Job, Progress } from "../api/types";
import { listenTo, type StreamEvent } from "./stream";

/** Runs `task` at once and again after the milliseconds it answers (null: no more). Returns how to stop. */
export function poll(task: () => Promise<number | null>): () => void {
  let timer: number | undefined;
  let stopped = false;
  let due = false;
  const run = async () => {
    timer = undefined;
    if (document.hidden) {
      due = true;
      return;
    }
    const pause = await task();
    if (!stopped && pause !== null) timer = window.setTimeout(run, pause);
  };
  const wake = () => {
    if (stopped || document.hidden || !due) return;
    due = false;
    void run();
  };
  document.addEventListener("visibilitychange", wake);
  void run();
  return () => {
    stopped = true;
    window.clearTimeout(timer);
    document.removeEventListener("visibilitychange", wake);
  };
}

export function isActive(job: Job): boolean {
  return job.state === "queued" || job.state === "running";
}

interface Follower {
  job(job: Job): void;
  failed(error: unknown): void;
}

/** Without a stream, with one, and while nobody looks. What has not changed costs a tag and no body. */
const POLL_MS = { alone: 2000, streaming: 10_000, hidden: 15_000 };

/**
 * Follows one job until it ends: by its event stream while the page is looked at, and by asking now and then where the
 * stream does not come through or the page is hidden.
 */
export function followJob(id: string, follower: Follower): () => void {
  let current: Job | undefined;
  let isStreaming = false;
  let stopListening: (() => void) | undefined;
  let timer: number | undefined;
  let stopped = false;
  const take = (job: Job) => follower.job((current = job));
  const silence = () => {
    stopListening?.();
    stopListening = undefined;
    isStreaming = false;
  };
  const heard = ({ type, data }: StreamEvent) => {
    const progress = type === "progress" ? progressOf(data) : undefined;
    if (current && progress && isActive(current)) take({ ...current, progress });
    if (type !== "progress") void ask();
  };
  const opened = (isOpen: boolean) => {
    if (isOpen === isStreaming) return;
    isStreaming = isOpen;
    // What happened before it was open, or while it is lost, is in the job.
    void ask();
  };
  const ask = async () => {
    window.clearTimeout(timer);
    await getJob(id).then((job) => {
      if (!stopped) take(job);
    }, follower.failed);
    if (stopped) return;
    if (current && !isActive(current)) return silence();
    if (document.hidden) silence();
    else if (current) stopListening ??= listenTo(id, { opened, heard });
    window.clearTimeout(timer);
    timer = window.setTimeout(ask, document.hidden ? POLL_MS.hidden : isStreaming ? POLL_MS.streaming : POLL_MS.alone);
  };
  const seen = () => {
    if (document.hidden) silence();
    if (!current || isActive(current)) void ask();
  };
  document.addEventListener("visibilitychange", seen);
  void ask();
  return () => {
    stopped = true;
    window.clearTimeout(timer);
    silence();
    document.removeEventListener("visibilitychange", seen);
  };
}

function progressOf(data: string): Progress | undefined {
  try {
    return (JSON.parse(data) as { data: Progress }).data;
  } catch {
    return undefined; // the next answer brings the truth
  }
}
