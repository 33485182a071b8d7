// The event streams of all tabs of this browser: one a job, whoever looks at it. Browsers allow six
// connections to a host, so that a stream a tab would leave none for anything else.

import type { FromWorker, StreamEvent, ToWorker } from "./stream";

/** Streams at the same time; tabs of further jobs ask now and then instead. */
const MOST_STREAMS = 4;
const RETRY_MS = 5000;
const TYPES = ["state", "progress", "done"] as const;

interface Followed {
  ports: Set<MessagePort>;
  source: EventSource | undefined;
}

const followed = new Map<string, Followed>();

function tell(ports: Iterable<MessagePort>, message: FromWorker): void {
  for (const port of ports) port.postMessage(message);
}

function open(job: string, entry: Followed): void {
  // A connection that is lost comes back by itself, with the number of the last event, so that none
  // is missed.
  const source = new EventSource(`/v1/jobs/${encodeURIComponent(job)}/events`);
  entry.source = source;
  source.onopen = () => tell(entry.ports, { job, isOpen: true });
  source.onerror = () => {
    tell(entry.ports, { job, isOpen: false });
    if (source.readyState !== EventSource.CLOSED) return;
    // The service refused instead of being away: then the browser does not try again.
    entry.source = undefined;
    setTimeout(arrange, RETRY_MS);
  };
  for (const type of TYPES) {
    source.addEventListener(type, (event: MessageEvent<string>) => {
      const told: StreamEvent = { type, data: event.data };
      tell(entry.ports, { job, event: told });
      if (type === "done") close(job);
    });
  }
}

function close(job: string): void {
  followed.get(job)?.source?.close();
  followed.delete(job);
  arrange();
}

/** Opens what is followed, as far as there is room. */
function arrange(): void {
  let room = MOST_STREAMS - [...followed.values()].filter((entry) => entry.source).length;
  for (const [job, entry] of followed) {
    if (entry.source || room <= 0) continue;
    open(job, entry);
    room -= 1;
  }
}

function follow(job: string, port: MessagePort): void {
  const entry = followed.get(job) ?? { ports: new Set(), source: undefined };
  followed.set(job, entry);
  entry.ports.add(port);
  // Who joins a stream that is open has missed its beginning, and asks once.
  if (entry.source?.readyState === EventSource.OPEN) tell([port], { job, isOpen: true });
  arrange();
}

function leave(job: string, port: MessagePort): void {
  const entry = followed.get(job);
  if (entry?.ports.delete(port) && entry.ports.size === 0) close(job);
}

const scope = globalThis as unknown as { onconnect: (event: MessageEvent) => void };
scope.onconnect = (event) => {
  const port = event.ports[0];
  if (!port) return;
  port.onmessage = ({ data }: MessageEvent<ToWorker>) =>
    data.follow ? follow(data.job, port) : leave(data.job, port);
};
