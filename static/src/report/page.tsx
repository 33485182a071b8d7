// The page of one job: what it is, whether it met its limits, verdicts, metrics, the plan under a
// clock with ribbons below, and the sentence of each event.

import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { partsOf } from "../api/types";
import { storyOf } from "../charts/association";
import { type Cause, readCauses } from "../charts/causes";
import { ClockBar } from "../charts/clock-bar";
import { Painted } from "../charts/painted";
import { planPainting } from "../charts/plan-paint";
import { Ribbons, useRibbons } from "../charts/ribbons";
import { type Scene, sceneOf } from "../charts/scene";
import { TrackMap } from "../charts/track-map";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { Time } from "../components/time";
import { capital, plural, words } from "../format";
import { type Clock, createClock } from "../state/clock";
import { readPalette, theme } from "../state/theme";
import { param } from "../state/url";
import { thresholdsOf } from "../views/thresholds";
import type { Data } from "./data";
import { Facts, Limits, Metrics, Verdicts } from "./tables";

const MOST_RIBBONS = 8;

export function ReportPage({ data }: { data: Data }): JSX.Element {
  const { name, report, left_out } = data;
  const scene = useMemo(() => sceneOf(data.plan), [data]);
  const clock = useMemo(() => createClock(scene.times, scene.numbers), [scene]);
  const causes = useMemo(() => readCauses(data.causes), [data]);
  useEffect(() => {
    document.title = `${name} · trackloom report`;
    return clock.dispose;
  }, [clock]);
  const parts = partsOf(report);
  return (
    <main class="report">
      <header>
        <p class="muted">trackloom report</p>
        <h1>{name}</h1>
        <Facts report={report} />
      </header>
      <Limits report={report} />
      {parts.tfa ? <Verdicts tfa={parts.tfa} origin={scene.origin} /> : null}
      {scene.times.length ? (
        <Pictures data={data} scene={scene} clock={clock} causes={causes} />
      ) : null}
      {parts.metrics ? <Metrics metrics={parts.metrics} /> : null}
      {causes.length ? <Causes causes={causes} origin={scene.origin} /> : null}
      {left_out.length ? (
        <section class="panel">
          <h2>Left out of this page</h2>
          <ul>
            {left_out.map((line) => (
              <li>{line}</li>
            ))}
          </ul>
        </section>
      ) : null}
    </main>
  );
}

interface PicturesProps {
  data: Data;
  scene: Scene;
  clock: Clock;
  causes: Cause[];
}

function Pictures({ data, scene, clock, causes }: PicturesProps): JSX.Element {
  const chosen = param("track");
  const stories = useMemo(
    () =>
      data.probabilities.map((series) => storyOf(String(series.columns.track_id[0] ?? ""), series)),
    [data],
  );
  const own = stories.filter(({ track }) => track === chosen);
  const shown = useRibbons(
    useMemo(
      () => [...own, ...stories.filter((story) => !own.includes(story))].slice(0, MOST_RIBBONS),
      [stories, chosen],
    ),
    causes,
  );
  void theme.value;
  const palette = readPalette();
  const [targets, tracks] = [
    plural(scene.truths.size, "target"),
    plural(scene.tracks.size, "track"),
  ];
  const label = `Plan with ${targets} and ${tracks}.`;
  const [trail, first] = [Number(param("trail")), -Infinity];
  const plan = (width: number) =>
    planPainting({
      scene,
      size: { width, height: Math.min(Math.round(width * 0.6), 560) },
      from: trail > 0 ? (clock.times[Math.max(0, clock.index.value - trail)] ?? first) : first,
      now: clock.time.value,
      track: chosen,
      truth: param("truth"),
      palette,
    });
  return (
    <>
      <section class="chart-frame">
        <div class="chart-head">
          <h2>Plan, x east and y north</h2>
        </div>
        <Painted label={label} painting={plan} />
        <ClockBar clock={clock} />
      </section>
      {shown.length ? (
        <Ribbons
          ribbons={shown}
          clock={clock}
          thresholds={thresholdsOf(data.report)}
          file="probability"
          title="Association probability of the most doubtful tracks"
        />
      ) : null}
      <TrackMap map={data.association_map} clock={clock} file="report" />
    </>
  );
}

const MOST_SENTENCES = 200;
/** What weighs most comes first; of one kind what was first. */
const WEIGHTS = ["switch", "break", "divergence", "miss", "redundant", "false_alarm"];

const weightOf = ({ event }: Cause): number => WEIGHTS.indexOf(event);

function Causes({ causes, origin }: { causes: Cause[]; origin: number }): JSX.Element {
  const sorted = causes.toSorted((a, b) => weightOf(a) - weightOf(b) || a.from - b.from);
  const shown = sorted.slice(0, MOST_SENTENCES);
  return (
    <section class="panel">
      <h2>What happened, and why</h2>
      <TableScroll label="What happened">
        <table class="data">
          <HeadRow heads={[numberHead("Time"), "Event", "Why"]} />
          <tbody>
            {shown.map((cause) => (
              <tr>
                <td class="num">
                  <Time at={cause.from} origin={origin} />
                </td>
                <td>{capital(words(cause.event))}</td>
                <td>{capital(cause.sentence)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </TableScroll>
      {causes.length > shown.length ? (
        <p class="muted">
          {shown.length} of {causes.length} are listed.
        </p>
      ) : null}
    </section>
  );
}
