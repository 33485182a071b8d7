// What happened to targets and tracks: who followed whom, and the events behind the counts, each
// with its moment.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { CauseCount, Cell, Job } from "../api/types";
import { type EventLog, type LogEntry, lanesOf, readEvents } from "../charts/event-log";
import { type EventMoment, laneHref, planHref } from "../charts/event-moment";
import { Lanes } from "../charts/lanes";
import { Empty, Link, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import type { TableData } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { capital, count, number, plural, words } from "../format";
import { hereHref, param, setParams } from "../state/url";
import { timeCell, timeHead, timeText, timeTitle } from "../times";

/** Why things happen, in the words of a table. */
const CAUSES: Record<CauseCount["cause"], string> = {
  outside_coverage: "Outside the field of view of every sensor",
  no_detection: "No detection within the gate",
  took_target: "The track took another target",
  took_clutter: "The track took detections of no target",
  ended: "The tracker ended the track",
  left_gate: "The track lives on outside the gate",
  silent: "The track has no point at the time",
  not_confirmed: "A track is near and not yet known",
  no_track: "Detected, and no track is near",
  second_track: "A second track is near",
  target_gone: "The target it followed is no more",
  unknown: "No target within the gate",
};

const LANES_AT_ONCE = 40;
const EVENTS_AT_ONCE = 200;

interface EventViewsProps {
  job: Job;
  sequence: string;
  file: string;
  origin: number;
  /** How often what happened for which reason; of jobs of today. */
  causes: CauseCount[] | undefined;
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

export function EventViews(props: EventViewsProps): JSX.Element {
  const { job, sequence, file, origin, causes, hasPlan } = props;
  const log = useResource(() => readEvents(job.id, causes !== undefined), [job.id]);
  if (log.error) return <ProblemBox error={log.error} retry={log.reload} />;
  if (!log.data) return <Loading what="the events" />;
  const target = hasPlan
    ? { href: planHref, place: "the plan view" }
    : { href: laneHref, place: "these lanes" };
  const parts = { log: log.data, sequence, file, origin, ...target };
  return (
    <>
      <LaneView {...parts} />
      {causes?.length ? <CauseTable causes={causes} file={file} /> : null}
      <EventTable {...parts} />
    </>
  );
}

/** Of all sequences together: each kind of event leads to its rows below. */
function CauseTable({ causes, file }: { causes: CauseCount[]; file: string }): JSX.Element {
  const columns = ["event", "cause", "episodes", "events"];
  const rows = causes.map(({ event, cause, episodes, events }) => [event, cause, episodes, events]);
  return (
    <TableFrame title="Causes" file={`causes-${file}`} table={() => ({ columns, rows })}>
      <TableScroll label="Causes">
        <table class="data">
          <HeadRow heads={["Event", "Cause", numberHead("Stretches"), numberHead("Events")]} />
          <tbody>
            {causes.map(({ event, cause, episodes, events }) => (
              <tr>
                <td>{capital(words(event))}</td>
                <td>{CAUSES[cause]}</td>
                <td class="num">{count(episodes)}</td>
                <td class="num">
                  <Link
                    href={hereHref({ event })}
                    label={`${count(events)}: show each ${words(event)}`}
                  >
                    {count(events)}
                  </Link>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </TableScroll>
    </TableFrame>
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
  const { step, time, kind, truth, track, distance, why } = entry;
  return [step, time, kind, truth || null, track || null, distance, why];
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
  const columns = ["step", "time_s", "event", "truth_id", "track_id", "distance", "why"];
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
              heads={[
                numberHead(timeName),
                "Event",
                "Truth",
                "Track",
                numberHead("Distance"),
                "Why",
              ]}
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
                  <td>{entry.why}</td>
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
