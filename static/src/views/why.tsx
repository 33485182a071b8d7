// Why a track did what it did at the moment of the clock: the sentence of what happened, the
// candidates it had, and how far it was from the truth.

import type { JSX } from "preact";
import type { Gates } from "../api/types";
import { originWords, type Step, type Story } from "../charts/association";
import { type Cause, causesAt } from "../charts/causes";
import { type Fit, fitIn, gatesAt } from "../charts/gates";
import { at, type Line, type Scene } from "../charts/scene";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { Time } from "../components/time";
import { capital, metres, number, plural, probability, words } from "../format";
import type { Clock } from "../state/clock";
import { param } from "../state/url";

interface Props {
  scene: Scene;
  clock: Clock;
  story: Story | undefined;
  causes: Cause[];
  gates: Gates | undefined;
  /** Misses in a row that end a track, where the request says so. */
  maxMissed: number | undefined;
}

const near = (one: number, other: number) => Math.abs(one - other) < 1e-6;

export function Why(props: Props): JSX.Element | null {
  const { clock, story, causes, scene } = props;
  const track = param("track");
  const truth = param("truth") ?? story?.own ?? null;
  if (track === null && truth === null) return null;
  const now = clock.time.value;
  const step = story?.steps.find(({ time }) => near(time, now));
  const found = causesAt(causes, now, track, truth);
  const next = nextCause(causes, now, track, truth);
  return (
    <section class="panel why" aria-label="Why">
      <h2>
        Why{" "}
        <span class="muted">
          at <Time at={now} origin={clock.origin} />
        </span>
      </h2>
      {found.map((cause) => (
        <Sentence cause={cause} clock={clock} />
      ))}
      {found.length || !causes.length ? null : (
        <p class="muted small">Nothing to be explained here.</p>
      )}
      {next ? <NextCause cause={next} clock={clock} /> : null}
      {step && story ? <StepFacts {...props} story={story} step={step} truth={truth} /> : null}
      {step && story ? <Candidates {...props} story={story} step={step} scene={scene} /> : null}
    </section>
  );
}

function Sentence({ cause, clock }: { cause: Cause; clock: Clock }): JSX.Element {
  return (
    <div class="why-sentence" data-event={cause.event}>
      <p class="small">
        <b>{capital(words(cause.event))}</b>{" "}
        <span class="muted">
          <Time at={cause.from} origin={clock.origin} />
          {near(cause.from, cause.to) ? null : (
            <>
              {" "}
              to <Time at={cause.to} origin={clock.origin} />
            </>
          )}
        </span>
      </p>
      <p>{capital(cause.sentence)}</p>
    </div>
  );
}

/** The first that begins after the clock, else the first of all. */
function nextCause(causes: Cause[], now: number, track: string | null, truth: string | null) {
  const own = causes
    .filter((cause) => (track === null ? cause.truth === truth : cause.track === track))
    .toSorted((a, b) => a.from - b.from);
  const ahead = own.find(({ from }) => from > now + 1e-6);
  return ahead ?? own.find(({ from }) => from < now - 1e-6);
}

function NextCause({ cause, clock }: { cause: Cause; clock: Clock }): JSX.Element | null {
  const index = clock.times.findIndex((time) => near(time, cause.from));
  if (index < 0) return null;
  const where = cause.from > clock.time.value ? "Next" : "First";
  return (
    <button type="button" class="quiet" onClick={() => clock.seek(index)}>
      {where}: {words(cause.event)} at <Time at={cause.from} origin={clock.origin} />
    </button>
  );
}

/** Scans in a row, up to this one, in which no detection was the most probable. */
export function missesUpTo(story: Story, step: Step): number {
  const end = story.steps.indexOf(step);
  let misses = 0;
  while (end - misses >= 0 && story.steps[end - misses]?.candidates[0]?.detection === null)
    misses += 1;
  return misses;
}

/** Where a line is at a time; between two points on the way from one to the other. */
export function placeAt(line: Line, time: number): { x: number; y: number } | undefined {
  const here = at(line, time);
  if (!here || (line.time[0] ?? Infinity) > time + 1e-6) return undefined;
  const [from, to] = [line.time[here.index] ?? time, line.time[here.index + 1]];
  if (near(from, time)) return here;
  if (to === undefined) return undefined;
  const part = (time - from) / (to - from);
  const [x, y] = [line.x[here.index + 1] ?? here.x, line.y[here.index + 1] ?? here.y];
  return { x: here.x + part * (x - here.x), y: here.y + part * (y - here.y) };
}

function distance({ scene, clock }: Props, story: Story, truth: string | null): number | undefined {
  const [target, line] = [scene.truths.get(truth ?? ""), scene.tracks.get(story.track)];
  const there = target && placeAt(target, clock.time.value);
  const here = line && placeAt(line, clock.time.value);
  return here && there && Math.hypot(here.x - there.x, here.y - there.y);
}

function StepFacts(props: Props & { story: Story; step: Step; truth: string | null }): JSX.Element {
  const { story, step, truth, maxMissed } = props;
  const misses = missesUpTo(story, step);
  const away = distance(props, story, truth);
  return (
    <dl class="facts">
      {away === undefined ? null : (
        <>
          <dt>Distance to truth {truth}</dt>
          <dd>{metres(away)} m</dd>
        </>
      )}
      <dt>NIS</dt>
      <dd>{step.nis === null ? "–" : number(step.nis)}</dd>
      <dt>Missed</dt>
      <dd>
        {plural(misses, "scan")} in a row{maxMissed ? `, ends at ${maxMissed}` : ""}
      </dd>
      {step.existence === null ? null : (
        <>
          <dt>Existence</dt>
          <dd>{probability(step.existence)}</dd>
        </>
      )}
    </dl>
  );
}

/** How each detection at the time fits to the gates of the track. */
export function fitsAt(
  scene: Scene,
  gates: Gates | undefined,
  track: string,
  time: number,
): Map<string, Fit> {
  const fits = new Map<string, Fit>();
  if (!gates) return fits;
  for (const row of gatesAt(gates, track, time)) {
    const cloud = scene.clouds.find(({ sensor }) => sensor === gates.columns.sensor_id[row]);
    cloud?.time.forEach((when, index) => {
      if (!near(when, time)) return;
      const place = { x: cloud.x[index] ?? 0, y: cloud.y[index] ?? 0 };
      const fit = fitIn(gates, row, place);
      if (fit) fits.set(cloud.id[index] ?? "", fit);
    });
  }
  return fits;
}

const SHOWN_CANDIDATES = 12;

function Candidates({ scene, gates, clock, story, step }: Props & { story: Story; step: Step }) {
  const fits = fitsAt(scene, gates, story.track, clock.time.value);
  const unit = [...fits.values()][0]?.unit;
  const shown = step.candidates.slice(0, SHOWN_CANDIDATES);
  return (
    <>
      <TableScroll label="Candidates">
        <table class="data candidates">
          <HeadRow
            heads={["Candidate", "Origin", numberHead("P"), numberHead("d²"), numberHead("N(ν)")]}
          />
          <tbody>
            {shown.map((entry) => (
              <tr>
                <td class="mono">{entry.detection ?? "none (ε)"}</td>
                <td>{entry.detection === null ? "–" : originWords(story, entry)}</td>
                <td class="num">{probability(entry.probability)}</td>
                <td class="num">{number(fits.get(entry.detection ?? "")?.squaredDistance)}</td>
                <td class="num">{number(fits.get(entry.detection ?? "")?.likelihood)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </TableScroll>
      {unit ? (
        <p class="muted small">
          d² = νᵀS⁻¹ν of the innovation ν, and its likelihood N(ν; 0, S) in {unit}.
        </p>
      ) : null}
      {step.candidates.length > shown.length ? (
        <p class="muted small">and {step.candidates.length - shown.length} less probable ones</p>
      ) : null}
    </>
  );
}
