// Parts of the page of a session: its counts, its tracks, the selected one, its events.

import type { JSX } from "preact";
import { Icon } from "../components/basics";
import { type Fact, FactList } from "../components/facts";
import { Figures } from "../components/figures";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { count, metres, number, plural, probability } from "../format";
import { param, setParams } from "../state/url";
import { endTrack, type Session, type SessionEvent } from "./api";
import { Confirm } from "./confirm";
import { earthText } from "./earth";
import type { Follower } from "./follow";
import { goTo, type LiveProps } from "./live-plan";
import { type Belief, motionOf } from "./memory";
import { ranked } from "./plan-paint";
import { clockText, clockTitle } from "./time";

/** Rows of a table that is made anew twice a second. */
const MOST_ROWS = 300;
const MOST_EVENTS = 100;

const ICONS = { open: "running", closed: "succeeded", failed: "failed" } as const;

export function SessionBadge({ state }: { state: Session["state"] }): JSX.Element {
  return (
    <span class={`badge state-${ICONS[state]}`}>
      <Icon name={ICONS[state]} /> {state}
    </span>
  );
}

export function Counts({ follower }: { follower: Follower }): JSX.Element | null {
  const picture = follower.settled.value;
  if (!picture) return null;
  const { counts, waiting, tracks, lag_s } = picture;
  const confirmed = tracks.filter((track) => track.status !== "tentative").length;
  const figures = [
    { name: "Tracks", value: count(tracks.length), note: `${count(confirmed)} confirmed` },
    { name: "Scans", value: count(counts.scans), note: plural(counts.heartbeats, "heartbeat") },
    { name: "Detections", value: count(counts.detections) },
    { name: "Late, dropped", value: count(counts.late_dropped) },
    { name: "Late, replayed", value: count(counts.replayed) },
    { name: "Missing", value: count(counts.missing) },
    { name: "Waiting", value: count(waiting), note: lag_s ? `${number(lag_s)} s behind` : "" },
  ];
  return <Figures label="What the session took" figures={figures} />;
}

function select(id: string): void {
  setParams({ track: id }, "push");
  goTo.value = { track: id };
}

function Cells({ track }: { track: Belief }): JSX.Element {
  if (track.bearing !== undefined)
    return (
      <>
        <td class="num">{track.bearing.toFixed(1)}</td>
        <td class="num">{number(track.bearingRate)}</td>
      </>
    );
  const { speed, course } = motionOf(track);
  return (
    <>
      <td class="num">{speed.toFixed(1)}</td>
      <td class="num">{course.toFixed(0)}</td>
    </>
  );
}

/** The tracks at the moment that is looked at. */
export function TrackTable({ follower, at }: LiveProps): JSX.Element {
  void follower.settled.value;
  const moment = follower.memory.at(at.value);
  const tracks = ranked(moment?.tracks ?? [], null);
  const isBearing = tracks.some((track) => track.bearing !== undefined);
  const motion = isBearing ? ["Bearing (°)", "Rate (°/s)"] : ["Speed (m/s)", "Course (°)"];
  const heads = [
    ...["Track", "Status"],
    ...["Existence", ...motion, "Detections", "Last detected"].map(numberHead),
  ];
  const row = (track: Belief) => (
    <tr key={track.id} class={track.id === param("track") ? "chosen" : undefined}>
      <td>
        <button type="button" class="link" onClick={() => select(track.id)}>
          {track.id}
        </button>
      </td>
      <td>{track.status}</td>
      <td class="num">{probability(track.existence)}</td>
      <Cells track={track} />
      <td class="num">{count(track.detections)}</td>
      <td class="num" title={clockTitle(track.detected)}>
        {clockText(track.detected)}
      </td>
    </tr>
  );
  return (
    <section class="chart-frame live-tracks" aria-label="Tracks">
      <div class="chart-head">
        <h2>Tracks</h2>
        {tracks.length > MOST_ROWS ? (
          <span class="reduced">
            {count(MOST_ROWS)} of {count(tracks.length)}
          </span>
        ) : null}
      </div>
      <TableScroll label="Tracks" class="table-scroll">
        <table class="data">
          <HeadRow heads={heads} />
          <tbody>{tracks.slice(0, MOST_ROWS).map(row)}</tbody>
        </table>
      </TableScroll>
      {tracks.length ? null : <p class="muted small frame-note">No track lives.</p>}
    </section>
  );
}

function factsOf(track: Belief): Fact[] {
  const { speed, course } = motionOf(track);
  const facts: Fact[] = [
    ["Status", track.status],
    ["Existence", probability(track.existence)],
    ["Began", <span title={clockTitle(track.started)}>{clockText(track.started)}</span>],
    ["Last detected", <span title={clockTitle(track.detected)}>{clockText(track.detected)}</span>],
    ["Detections", count(track.detections)],
  ];
  if (track.x === undefined || track.y === undefined)
    return [...facts, ["Bearing", `${number(track.bearing)}°`]];
  facts.push(
    ["Place", `x ${metres(track.x)} m, y ${metres(track.y)} m`],
    ["Speed, course", `${speed.toFixed(1)} m/s, ${course.toFixed(0)}°`],
  );
  if (track.lat !== undefined && track.lon !== undefined)
    facts.push(["On the Earth", earthText({ lat: track.lat, lon: track.lon })]);
  return facts;
}

export function Selected({
  follower,
  at,
  failed,
}: LiveProps & { failed: (error: unknown) => void }): JSX.Element {
  void follower.settled.value;
  const id = param("track");
  const track = follower.memory.at(at.value)?.tracks.find((each) => each.id === id);
  const isLive = follower.bond.value === "live" && track && at.value === undefined;
  const end = async () => {
    if (id) await endTrack(follower.id, id);
    follower.nudge();
  };
  return (
    <section class="panel live-selected" aria-label="Selected track">
      <h2>{id ? `Track ${id}` : "No track selected"}</h2>
      {track ? <FactList facts={factsOf(track)} /> : null}
      {id && !track ? <p class="muted">It does not live at this moment.</p> : null}
      {id ? (
        <p class="row">
          {isLive ? (
            <Confirm
              key={id}
              name="End this track"
              question="No more of it is told."
              doIt={`End track ${id}`}
              press={end}
              failed={failed}
            />
          ) : null}
          <button type="button" class="quiet" onClick={() => setParams({ track: null }, "push")}>
            Deselect
          </button>
        </p>
      ) : (
        <p class="muted small">Press a track in the plan, in the table, or in an event.</p>
      )}
    </section>
  );
}

const WORDS: Record<string, string> = { late_dropped: "late, dropped", gap: "numbers left out" };

function told(event: SessionEvent): string {
  const { kind, into_track_id, sensor_id, count: several } = event;
  const words = WORDS[kind] ?? kind;
  const into = into_track_id ? ` into ${into_track_id}` : "";
  const what = kind === "limited" ? "tracks" : "scans";
  const whose = sensor_id ? `, ${sensor_id}` : "";
  const many = several ? ` (${several} ${what})` : "";
  return `${words}${into}${whose}${many}`;
}

export function Events({ follower }: { follower: Follower }): JSX.Element {
  void follower.settled.value;
  const events = follower.events.peek().slice(0, MOST_EVENTS);
  return (
    <section class="panel live-events" aria-label="Events">
      <h2>Events</h2>
      {events.length ? null : <p class="muted">Nothing happened yet.</p>}
      <div class="event-scroll" tabIndex={0} role="region" aria-label="Events, newest first">
        <ol>
          {events.map((event) => (
            <li key={event.id}>
              <time title={clockTitle(event.time_s)}>{clockText(event.time_s)}</time>
              {event.track_id ? (
                <button type="button" class="link" onClick={() => select(event.track_id ?? "")}>
                  track {event.track_id}
                </button>
              ) : (
                <span />
              )}
              <span>{told(event)}</span>
            </li>
          ))}
        </ol>
      </div>
    </section>
  );
}
