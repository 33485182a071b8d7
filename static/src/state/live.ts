// Staying up to date: polling that rests while the tab is hidden, and following one job.

import { getJob } from "../api/client";
import type { Job, Progress } from "../api/types";
import { listenTo, type StreamEvent } from "./stream";

/**
 * Runs `task` at once and again after the milliseconds it answers (null: no more). Returns how to
 * stop.
 */
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

/**
 * Of the time that an answer takes, how many times as long the service is left alone after it; and
 * how long at least, and after a failure.
 */
const REST = { times: 10, least_ms: 1000, failed_ms: 5000 };

/**
 * Asks once there is news, but not while the page is hidden, and with a rest after each answer.
 * What failed is asked again.
 */
export function askOnNews(ask: () => Promise<unknown>): { news(): void; stop(): void } {
  let isDue = false;
  let isResting = false;
  let stopped = false;
  const run = async () => {
    if (stopped || isResting || !isDue || document.hidden) return;
    isDue = false;
    isResting = true;
    const begun = performance.now();
    const answered = await ask().then(
      () => true,
      () => false,
    );
    isDue ||= !answered;
    const rest_ms = answered
      ? Math.max(REST.least_ms, REST.times * (performance.now() - begun))
      : REST.failed_ms;
    window.setTimeout(() => {
      isResting = false;
      void run();
    }, rest_ms);
  };
  const seen = () => void run();
  document.addEventListener("visibilitychange", seen);
  return {
    news: () => {
      isDue = true;
      void run();
    },
    stop: () => {
      stopped = true;
      document.removeEventListener("visibilitychange", seen);
    },
  };
}

export function isActive(job: Job): boolean {
  return job.state === "queued" || job.state === "running";
}

interface Follower {
  job(job: Job): void;
  failed(error: unknown): void;
}

/**
 * Without a stream, with one, and while nobody looks. What has not changed costs a tag and no body.
 */
const POLL_MS = { alone: 2000, streaming: 10_000, hidden: 15_000 };

/**
 * Follows one job until it ends: by its event stream while the page is looked at, and by asking now
 * and then where the stream does not come through or the page is hidden.
 */
export function followJob(id: string, follower: Follower): () => void {
  let current: Job | undefined;
  let isStreaming = false;
  let stopListening: (() => void) | undefined;
  let timer: number | undefined;
  let stopped = false;
  const take = (job: Job) => {
    current = job;
    follower.job(job);
  };
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
    timer = window.setTimeout(
      ask,
      document.hidden ? POLL_MS.hidden : isStreaming ? POLL_MS.streaming : POLL_MS.alone,
    );
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
