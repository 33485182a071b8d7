// Staying up to date: polling that rests while the tab is hidden, and the event stream of one job.

import { getJob } from "../api/client";
import type { Job, Progress } from "../api/types";

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

const POLL_MS = 2000;

/** Follows one job until it ends: by its event stream, and by polling where the stream does not come through. */
export function followJob(id: string, follower: Follower): () => void {
  let current: Job | undefined;
  let stream: EventSource | undefined;
  const take = (job: Job) => follower.job((current = job));
  const refresh = () => getJob(id).then(take, follower.failed);
  const close = () => {
    stream?.close();
    stream = undefined;
  };
  const open = () => {
    stream = new EventSource(`/v1/jobs/${encodeURIComponent(id)}/events`);
    stream.addEventListener("progress", (event) => {
      const progress = progressOf(event);
      if (current && progress && isActive(current)) take({ ...current, progress });
    });
    stream.addEventListener("state", () => void refresh());
    stream.addEventListener("done", () => {
      close();
      void refresh();
    });
  };
  const stopPolling = poll(async () => {
    await refresh();
    if (current && !isActive(current)) {
      close();
      return null;
    }
    if (current && !stream) open();
    return POLL_MS;
  });
  const hide = () => {
    if (document.hidden) close();
  };
  document.addEventListener("visibilitychange", hide);
  return () => {
    stopPolling();
    close();
    document.removeEventListener("visibilitychange", hide);
  };
}

function progressOf(event: MessageEvent<string>): Progress | undefined {
  try {
    return (JSON.parse(event.data) as { data: Progress }).data;
  } catch {
    return undefined; // the next poll brings the truth
  }
}
