// The event stream of a job, shared by all tabs of the browser through a worker; a stream of our
// own where there is none.

export interface StreamEvent {
  type: "state" | "progress" | "done";
  /** As the service wrote it. */
  data: string;
}

export interface ToWorker {
  job: string;
  follow: boolean;
}

export interface FromWorker {
  job: string;
  /** The stream has been opened, or was lost. */
  isOpen?: boolean;
  event?: StreamEvent;
}

export interface Listener {
  opened(isOpen: boolean): void;
  heard(event: StreamEvent): void;
}

/** Where the build put the script of the worker. */
declare const STREAM_WORKER: string;

let shared: MessagePort | null | undefined;

/** The way to the worker; null where the browser has none. */
function worker(): MessagePort | null {
  if (shared !== undefined) return shared;
  try {
    shared = new SharedWorker(STREAM_WORKER, { name: "trackloom" }).port;
    shared.start();
  } catch {
    shared = null;
  }
  return shared;
}

/** Listens to the events of a job. Returns how to stop. */
export function listenTo(job: string, listener: Listener): () => void {
  const port = worker();
  return port ? bySharing(port, job, listener) : byItself(job, listener);
}

function bySharing(port: MessagePort, job: string, listener: Listener): () => void {
  const post = (follow: boolean) => port.postMessage({ job, follow } satisfies ToWorker);
  const take = ({ data }: MessageEvent<FromWorker>) => {
    if (data.job !== job) return;
    if (data.isOpen !== undefined) listener.opened(data.isOpen);
    if (data.event) listener.heard(data.event);
  };
  const leave = () => post(false);
  port.addEventListener("message", take);
  window.addEventListener("pagehide", leave);
  post(true);
  return () => {
    leave();
    port.removeEventListener("message", take);
    window.removeEventListener("pagehide", leave);
  };
}

function byItself(job: string, listener: Listener): () => void {
  const source = new EventSource(`/v1/jobs/${encodeURIComponent(job)}/events`);
  source.onopen = () => listener.opened(true);
  source.onerror = () => listener.opened(false);
  for (const type of ["state", "progress", "done"] as const) {
    source.addEventListener(type, (event: MessageEvent<string>) => {
      listener.heard({ type, data: event.data });
      if (type === "done") source.close();
    });
  }
  return () => source.close();
}
