// What happened to targets and tracks: who followed whom, and the events behind the counts, each
// with its moment.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { Cell, Job } from "../api/types";
import { type EventLog, type LogEntry, lanesOf, readEvents } from "../charts/event-log";
import { type EventMoment, laneHref, planHref } from "../charts/event-moment";
import { Lanes } from "../charts/lanes";
import { Empty, Link, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { capital, count, number, plural, words } from "../format";
import { param, setParams } from "../state/url";
import { timeCell, timeHead, timeText, timeTitle } from "../times";

const LANES_AT_ONCE = 40;
const EVENTS_AT_ONCE = 200;

interface EventViewsProps {
  job: Job;
  sequence: string;
  file: string;
  origin: number;
  /** Whether the plan view has places to show; boxes have none. */
  hasPlan: boolean;
}

interface EventParts {
  log: EventLog;
  sequence: string;
  file: string;
  origin: number;
  href: (moment: EventMoment) => string;
  /** What an event leads to. */
  place: string;
}

export function EventViews({ job, sequence, file, origin, hasPlan }: EventViewsProps): JSX.Element {
  const log = useResource(() => readEvents(job.id), [job.id]);
  if (log.error) return <ProblemBox error={log.error} retry={log.reload} />;
  if (!log.data) return <Loading what="the events" />;
  const target = hasPlan
    ? { href: planHref, place: "the plan view" }
    : { href: laneHref, place: "these lanes" };
  const parts = { log: log.data, sequence, file, origin, ...target };
  return (
    <>
      <LaneView {...parts} />
      <EventTable {...parts} />
    </>
  );
}

function LaneView({ log, sequence, file, ...rest }: EventParts): JSX.Element | null {
  const all = useMemo(
    () => lanesOf(log.entries, sequence).sort((a, b) => b.marks.length - a.marks.length),
    [log, sequence],
  );
  const from = Math.max(Number(param("lanes")) || 0, 0);
  if (!all.length) return null;
  const lanes = all.slice(from, from + LANES_AT_ONCE);
  const turn = (to: number) => () => setParams({ lanes: to || null });
  return (
    <div>
      <Lanes lanes={lanes} total={all.length} file={`lanes-${file}`} {...rest} />
      {all.length > LANES_AT_ONCE ? (
        <p class="more">
          <button
            type="button"
            disabled={from === 0}
            onClick={turn(Math.max(from - LANES_AT_ONCE, 0))}
          >
            Previous
          </button>
          <span class="muted">
            targets {from + 1} to {from + lanes.length} of {count(all.length)}, those with most
            marks first
          </span>
          <button
            type="button"
            disabled={from + LANES_AT_ONCE >= all.length}
            onClick={turn(from + LANES_AT_ONCE)}
          >
            Next
          </button>
        </p>
      ) : null}
    </div>
  );
}

function KindChoice({ log, asked }: { log: EventLog; asked: string[] }): JSX.Element {
  const kinds = [...new Set(log.entries.map((entry) => entry.kind))].sort();
  const value = asked.join(",");
  return (
    <label>
      <span>Events</span>
      <select value={value} onChange={(event) => setParams({ event: event.currentTarget.value })}>
        {kinds.includes(value) ? null : (
          <option value={value}>{asked.map(words).join(", ")}</option>
        )}
        {kinds.map((kind) => (
          <option value={kind}>{words(kind)}</option>
        ))}
      </select>
    </label>
  );
}

function rowOf(entry: LogEntry): Cell[] {
  const { step, time, kind, truth, track, distance } = entry;
  return [step, time, kind, truth || null, track || null, distance];
}

function EventTable({ log, sequence, file, origin, href, place }: EventParts): JSX.Element {
  const head = useRef<HTMLDivElement>(null);
  const chosen = param("event");
  useEffect(() => {
    // Who comes by the link of a number wants to see its events.
    if (chosen) head.current?.scrollIntoView({ block: "nearest" });
  }, [chosen]);
  const asked = (chosen ?? "switch,break").split(",");
  const found = log.entries.filter(
    (entry) => entry.sequence === sequence && asked.includes(entry.kind),
  );
  const columns = ["step", "time_s", "event", "truth_id", "track_id", "distance"];
  const table = (): TableData => ({ columns, rows: found.map(rowOf), origin_s: origin });
  const tools = (
    <div class="filters frame-filters" ref={head}>
      <KindChoice log={log} asked={asked} />
      <p class="muted small">
        {plural(found.length, "event")}, {count(Math.min(found.length, EVENTS_AT_ONCE))} shown
        {log.isCut ? "; the file has more than were read here" : ""}
      </p>
    </div>
  );
  const labelOf = ({ kind, time }: LogEntry) =>
    `Show ${words(kind)} at ${timeText(time, origin)} in ${place}`;
  const timeName = origin ? capital(timeHead("time_s", origin)) : "Time (s)";
  return (
    <TableFrame title="Events" file={`events-${file}`} table={table} tools={tools}>
      {found.length ? (
        <TableScroll label="Events">
          <table class="data">
            <HeadRow
              heads={[numberHead(timeName), "Event", "Truth", "Track", numberHead("Distance")]}
            />
            <tbody>
              {found.slice(0, EVENTS_AT_ONCE).map((entry) => (
                <tr>
                  <td class="num" title={timeTitle(entry.time, origin)}>
                    <Link href={href(entry)} label={labelOf(entry)}>
                      {timeCell(entry.time, origin)}
                    </Link>
                  </td>
                  <td>{capital(words(entry.kind))}</td>
                  <td class="mono">{entry.truth || "–"}</td>
                  <td class="mono">{entry.track || "–"}</td>
                  <td class="num">{number(entry.distance)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableScroll>
      ) : (
        <Empty title="There is no such event." />
      )}
    </TableFrame>
  );
}
