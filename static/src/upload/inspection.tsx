// What a look at a file found: what it is, how its units fared, when and where it is, what seems
// wrong, and the job to start from.

import type { JSX } from "preact";
import type { InspectedSensor, Inspection } from "../api/types";
import { Icon } from "../components/basics";
import { CopyButton } from "../components/copy";
import { type Fact, FactList } from "../components/facts";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { UnitsTable } from "../components/units-table";
import { count, duration, number, words } from "../format";
import { utcText } from "../times";

/** Of each kind, what its scans and its objects are called. */
const CALLED: Record<Inspection["kind"], [scans: string, objects: string]> = {
  detections: ["Scans", "Targets named"],
  truth: ["Times", "Targets"],
  tracks: ["Times", "Tracks"],
  bearing_time: ["Times", "Targets"],
};

function timeFact(time_s: number, base: Inspection["time_base"]): string {
  const utc = base === "relative" ? undefined : utcText(time_s);
  return utc ?? `${number(time_s)} s`;
}

type Text = (value: number) => string;

const degrees: Text = (value) => String(Number(value.toFixed(5)));

function areaFacts({ area, frame }: Inspection): Fact[] {
  if (!area) return [];
  const { lat_deg, lon_deg, x_m, y_m } = area;
  const span = (values: [number, number], unit: string, text: Text = number): string =>
    `${text(values[0])}${unit} to ${text(values[1])}${unit}`;
  if (!lat_deg || !lon_deg)
    return [
      ["East (x)", span(x_m, " m")],
      ["North (y)", span(y_m, " m")],
    ];
  const facts: Fact[] = [
    ["Latitude", span(lat_deg, "°", degrees)],
    ["Longitude", span(lon_deg, "°", degrees)],
  ];
  if (frame) facts.push(["Origin", `${degrees(frame.lat_deg)}°, ${degrees(frame.lon_deg)}°`]);
  return facts;
}

function factsOf(found: Inspection): Fact[] {
  const [scans, objects] = CALLED[found.kind];
  const { time, time_base } = found;
  const facts: Fact[] = [
    ["Kind", words(found.kind)],
    ["Format", found.format],
    ["Rows", count(found.rows)],
  ];
  if (found.scans) facts.push([scans, count(found.scans)]);
  if (found.objects) facts.push([objects, count(found.objects)]);
  if (time)
    facts.push(
      ["From", timeFact(time.start_s, time_base)],
      ["To", timeFact(time.end_s, time_base)],
      ["Lasts", duration(time.end_s - time.start_s)],
    );
  if (time_base === "assumed_date") facts.push(["Day", "assumed"]);
  return [...facts, ...areaFacts(found)];
}

function Told({ title, texts }: { title: string; texts: string[] }): JSX.Element | null {
  if (!texts.length) return null;
  return (
    <div class="warnings">
      <h3>{title}</h3>
      <ul>
        {texts.map((text) => (
          <li>
            <Icon name="warning" /> {text}
          </li>
        ))}
      </ul>
    </div>
  );
}

function placeOf({ lat_deg, lon_deg }: InspectedSensor): string {
  if (lat_deg === undefined || lon_deg === undefined) return "–";
  return `${degrees(lat_deg)}°, ${degrees(lon_deg)}°`;
}

const SENSOR_HEADS = ["Sensor", ...["Scans", "Detections", "Period"].map(numberHead), "Place"];

function Sensors({ sensors }: { sensors: InspectedSensor[] }): JSX.Element | null {
  if (!sensors.length) return null;
  return (
    <TableScroll label="Sensors of the file" class="table-scroll">
      <table class="data">
        <HeadRow heads={SENSOR_HEADS} />
        <tbody>
          {sensors.map((sensor) => (
            <tr>
              <th scope="row">{sensor.sensor_id}</th>
              <td class="num">{count(sensor.scans)}</td>
              <td class="num">{count(sensor.detections)}</td>
              <td class="num">
                {sensor.period_s === undefined ? "–" : `${number(sensor.period_s)} s`}
              </td>
              <td>{placeOf(sensor)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </TableScroll>
  );
}

/** Opens the job in New job, once the file is uploaded. */
type Start = (() => void) | undefined;

function JobToStart({ job, start }: { job: Inspection["job"]; start: Start }): JSX.Element {
  const text = JSON.stringify(job, null, 2);
  return (
    <details class="job-to-start">
      <summary>A job to start from: {job.kind}</summary>
      <p class="row">
        {start ? (
          <button type="button" onClick={start}>
            Upload and open this job
          </button>
        ) : null}
        <CopyButton text={text} />
      </p>
      <pre class="code" tabIndex={0} role="region" aria-label="The job as JSON">
        {text}
      </pre>
    </details>
  );
}

export function Found({ found, start }: { found: Inspection; start: Start }): JSX.Element {
  return (
    <>
      <Told title="Looks wrong" texts={found.suspicions} />
      <Told title="Warnings" texts={found.warnings} />
      <div class="found">
        <FactList facts={factsOf(found)} />
        <UnitsTable units={found.units} />
      </div>
      <Sensors sensors={found.sensors} />
      <JobToStart job={found.job} start={start} />
    </>
  );
}
