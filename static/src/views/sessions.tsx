// The live sessions: how each stands, newest first.

import { useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { asProblem, Empty, Icon, Link, Loading, ProblemBox } from "../components/basics";
import { Code } from "../components/code";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { count, duration, moment, seconds } from "../format";
import { listSessions, type Session } from "../session/api";
import { beginExample } from "../session/example";
import { SessionBadge } from "../session/parts";
import { poll } from "../state/live";
import { pageHref } from "../state/url";

const PAGE = 50;
const LIVE_MS = 1000;
const QUIET_MS = 5000;

interface Listing {
  sessions: Session[];
  next: string | undefined;
  updated: Date;
}

export function Sessions(): JSX.Element {
  const listing = useSignal<Listing | undefined>(undefined);
  const error = useSignal<unknown>(undefined);
  const pages = useSignal(1);
  useEffect(() => {
    let current = true;
    const stop = poll(async () => {
      try {
        const fresh = await listed(pages.peek());
        if (!current) return null;
        [listing.value, error.value] = [fresh, undefined];
        return fresh.sessions.some((session) => session.state === "open") ? LIVE_MS : QUIET_MS;
      } catch (failure) {
        if (current) error.value = failure;
        return QUIET_MS;
      }
    });
    return () => {
      current = false;
      stop();
    };
  }, [pages.value]);
  return (
    <section>
      <div class="title-row">
        <h1>Sessions</h1>
      </div>
      {listing.value ? (
        <>
          {error.value ? <Stale error={error.value} updated={listing.value.updated} /> : null}
          <List listing={listing.value} more={() => (pages.value += 1)} />
        </>
      ) : error.value ? (
        <ProblemBox error={error.value} />
      ) : (
        <Loading what="sessions" />
      )}
    </section>
  );
}

/** As many pages as are shown, as they are now. */
async function listed(pages: number): Promise<Listing> {
  const sessions: Session[] = [];
  let next: string | undefined;
  for (let page = 0; page < pages; page++) {
    const answer = await listSessions({ limit: PAGE, ...(next ? { cursor: next } : {}) });
    sessions.push(...answer.items);
    next = answer.next_cursor;
    if (!next) break;
  }
  return { sessions, next, updated: new Date() };
}

function Stale({ error, updated }: { error: unknown; updated: Date }): JSX.Element {
  return (
    <p class="stale" role="status">
      <Icon name="warning" /> {asProblem(error).title}. Shown as of {moment(updated.toISOString())}.
    </p>
  );
}

const HEADS = [
  ...["Name", "State"],
  ...["Scans", "Tracks", "Confirmed", "Begun", "Age"].map(numberHead),
];

function Row({ session }: { session: Session }): JSX.Element {
  const { live } = session;
  return (
    <tr>
      <td class="cell-name">
        <Link href={pageHref({ view: "session", session: session.id })}>
          {session.name || <span class="mono">{session.id}</span>}
        </Link>
        {session.name ? <span class="sub mono">{session.id.slice(-12)}</span> : null}
      </td>
      <td>
        <SessionBadge state={session.state} />
      </td>
      <td class="num">{count(live?.counts.scans ?? session.entries)}</td>
      <td class="num">{count(live?.tracks)}</td>
      <td class="num">{count(live?.confirmed)}</td>
      <td class="num">
        <time dateTime={session.created_at}>{moment(session.created_at)}</time>
      </td>
      <td class="num">{duration(seconds(session.created_at, session.closed_at))}</td>
    </tr>
  );
}

function List({ listing, more }: { listing: Listing; more: () => void }): JSX.Element {
  if (!listing.sessions.length)
    return (
      <Empty title="No sessions yet.">
        <p>A session tracks a live feed: begin one, then push its scans.</p>
        <Code text={beginExample()} />
      </Empty>
    );
  return (
    <>
      <TableScroll label="Sessions" class="table-scroll">
        <table class="data">
          <HeadRow heads={HEADS} />
          <tbody>
            {listing.sessions.map((session) => (
              <Row key={session.id} session={session} />
            ))}
          </tbody>
        </table>
      </TableScroll>
      {listing.next ? (
        <p class="more">
          <button type="button" onClick={more}>
            Load more
          </button>
          <span class="muted">{count(listing.sessions.length)} shown</span>
        </p>
      ) : null}
    </>
  );
}
