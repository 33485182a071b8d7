// Following a live session: a picture after the other, each asked for when the one before was
// taken in, so that a slow page gets fewer pictures; and the events beside them.

import { signal } from "@preact/signals";
import { ApiError } from "../api/client";
import {
  getEvents,
  getPicture,
  getSession,
  type Picture,
  type Session,
  type SessionEvent,
} from "./api";
import { Memory } from "./memory";

/** How the page stands to the session. */
export type Bond = "asking" | "live" | "lost" | "elsewhere" | "ended" | "refused";

const MOST_EVENTS = 500;
/** Between two pictures at least: more would not be seen. */
const REST_MS = 40;
const AGAIN_MS = { lost: 1000, elsewhere: 5000, most: 8000 };
/** Whole pictures, after late scans changed the past. */
const WHOLE_EVERY_MS = 2000;

const SETTLE_MS = 400;

const rest = (ms: number) => new Promise((wake) => window.setTimeout(wake, ms));

export class Follower {
  readonly session = signal<Session | undefined>(undefined);
  readonly bond = signal<Bond>("asking");
  readonly error = signal<unknown>(undefined);
  /** The latest; what it adds is in the memory by then. */
  readonly picture = signal<Picture | undefined>(undefined);
  /** Newest first. */
  readonly events = signal<SessionEvent[]>([]);
  readonly memory = new Memory();
  /** The latest, but seldom: for tables, which nobody reads ten times a second. */
  readonly settled = signal<Picture | undefined>(undefined);
  readonly heard = signal<Date | undefined>(undefined);
  private readonly stopping = new AbortController();
  private asking: AbortController | undefined;
  private isWhole = true;
  private wholeAt = 0;
  private failures = 0;
  private settling = 0;

  constructor(readonly id: string) {
    document.addEventListener("visibilitychange", this.seen);
    void this.run();
  }

  stop(): void {
    this.stopping.abort();
    this.asking?.abort();
    document.removeEventListener("visibilitychange", this.seen);
  }

  /** Asks at once, after something was done by hand. */
  nudge(): void {
    this.asking?.abort();
  }

  private readonly seen = () => {
    if (document.hidden) this.asking?.abort();
    // What the service kept in the meantime may not be all.
    else this.isWhole = true;
  };

  private async run(): Promise<void> {
    const { signal: stopped } = this.stopping;
    while (!stopped.aborted) {
      if (document.hidden) await untilSeen(stopped);
      const goesOn = await this.round().catch((failure: unknown) => this.failed(failure));
      if (!goesOn) return;
      await rest(REST_MS);
    }
  }

  /** One picture with its events; false where there is no more to come. */
  private async round(): Promise<boolean> {
    if (!this.session.peek() || this.bond.peek() === "lost") await this.askSession();
    const session = this.session.peek();
    if (session?.state !== "open") {
      this.bond.value = "ended";
      return false;
    }
    this.asking = new AbortController();
    const after = this.isWhole ? undefined : this.picture.peek()?.last_scan;
    const picture = await getPicture(this.id, after, this.asking.signal);
    this.isWhole = false;
    this.failures = 0;
    this.memory.take(picture);
    await this.askEvents(picture.last_event);
    this.heard.value = new Date();
    this.bond.value = "live";
    this.error.value = undefined;
    this.picture.value = picture;
    this.settling ||= window.setTimeout(() => {
      this.settling = 0;
      this.settled.value = this.picture.peek();
    }, SETTLE_MS);
    return true;
  }

  private async askSession(): Promise<void> {
    this.session.value = await getSession(this.id);
  }

  private async askEvents(last: number): Promise<void> {
    const known = this.events.peek()[0]?.id ?? 0;
    if (last <= known) return;
    const after = Math.max(known, last - MOST_EVENTS);
    const { items } = await getEvents(this.id, after);
    this.events.value = [...items.toReversed(), ...this.events.peek()].slice(0, MOST_EVENTS);
    const isRevised = items.some((event) => event.kind === "revised");
    if (isRevised && performance.now() - this.wholeAt > WHOLE_EVERY_MS) {
      this.wholeAt = performance.now();
      this.isWhole = true;
    }
  }

  /** Whether it is worth asking again; then after a while. */
  private async failed(failure: unknown): Promise<boolean> {
    if (this.stopping.signal.aborted) return false;
    // We broke it off ourselves: something was done by hand, or the page was hidden.
    if (this.asking?.signal.aborted) {
      this.isWhole = true;
      return true;
    }
    const { code = "", status = 0 } = failure instanceof ApiError ? failure.problem : {};
    if (code === "session_closed") return this.ended();
    const isLost = status === 0 || status === 429 || status >= 500;
    if (!isLost && code !== "session_elsewhere") {
      [this.bond.value, this.error.value] = ["refused", failure];
      return false;
    }
    this.bond.value = isLost ? "lost" : "elsewhere";
    this.error.value = failure;
    const least = isLost ? AGAIN_MS.lost : AGAIN_MS.elsewhere;
    await rest(Math.min(least * 2 ** this.failures++, AGAIN_MS.most));
    return true;
  }

  private async ended(): Promise<boolean> {
    await this.askSession();
    // One that is open once more was only read from its log.
    if (this.session.peek()?.state === "open") {
      await rest(AGAIN_MS.lost);
      return true;
    }
    this.bond.value = "ended";
    return false;
  }
}

function untilSeen(stopped: AbortSignal): Promise<void> {
  return new Promise((seen) => {
    const look = () => {
      if (document.hidden && !stopped.aborted) return;
      document.removeEventListener("visibilitychange", look);
      seen();
    };
    document.addEventListener("visibilitychange", look);
    stopped.addEventListener("abort", look);
    look();
  });
}
