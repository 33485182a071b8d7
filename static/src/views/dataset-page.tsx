// One data set: what it holds, where it came from, what its reader had to say, and its first rows.

import { useSignal } from "@preact/signals";
import type { JSX, TargetedEvent } from "preact";
import { deleteDataset, getDataset, getDatasetAs, previewDataset } from "../api/client";
import type { Cell, Dataset, DatasetPreview, SensorSettings } from "../api/types";
import { Empty, Icon, Link, Loading, ProblemBox } from "../components/basics";
import { cellOf } from "../components/csv";
import { type Fact, FactList, Facts } from "../components/facts";
import { useResource } from "../components/resource";
import { saveBlob } from "../components/save";
import { DataTable } from "../components/table";
import { TableFrame } from "../components/table-frame";
import { UnitsTable } from "../components/units-table";
import { isObject } from "../form/schema";
import { bytes, count, number, plural, words } from "../format";
import { go, pageHref } from "../state/url";
import { originOf, timeText, utcText } from "../times";

const PREVIEW_ROWS = 100;

/** Formats to save a data set in, what to call them, and how their files end. */
const FORMATS: [string, string, string][] = [
  ["csv", "CSV", "csv"],
  ["json", "JSON", "json"],
  ["parquet", "Parquet", "parquet"],
  ["arrow", "Arrow", "arrow"],
  ["geojson", "GeoJSON", "geojson"],
  ["kml", "KML (Google Earth)", "kml"],
  ["czml", "CZML (Cesium)", "czml"],
  ["gpx", "GPX", "gpx"],
  ["trips", "Trips (kepler.gl)", "geojson"],
  ["asterix", "ASTERIX 062", "ast"],
  ["stonesoup", "Stone Soup", "csv"],
];

export function DatasetPage({ id }: { id: string }): JSX.Element {
  const dataset = useResource(() => getDataset(id), [id]);
  if (dataset.error) {
    return (
      <>
        <h1>Data set</h1>
        <ProblemBox error={dataset.error} retry={dataset.reload} />
        <Link href={pageHref({ view: "datasets" })}>All data sets</Link>
      </>
    );
  }
  if (!dataset.data) return <Loading what="the data set" />;
  return <Found dataset={dataset.data} />;
}

function Found({ dataset }: { dataset: Dataset }): JSX.Element {
  const failure = useSignal<unknown>(undefined);
  const remove = () => {
    if (!window.confirm(`Delete “${dataset.name}”? Jobs that read it keep their results.`)) return;
    deleteDataset(dataset.id).then(
      () => go(pageHref({ view: "datasets" })),
      (error: unknown) => (failure.value = error),
    );
  };
  return (
    <article>
      <header class="job-head">
        <p class="crumbs">
          <Link href={pageHref({ view: "datasets" })}>Data sets</Link>
          <span class="muted"> / </span>
          <span class="mono">{dataset.id}</span>
        </p>
        <div class="title-row">
          <h1>{dataset.name}</h1>
          <span class="badge">{dataset.kind}</span>
          <div class="actions">
            <a class="button" href={dataset.links.content} download={dataset.name}>
              <Icon name="download" /> Download
            </a>
            <SaveAs dataset={dataset} failed={(error) => (failure.value = error)} />
            <button type="button" onClick={remove}>
              Delete
            </button>
          </div>
        </div>
      </header>
      {failure.value ? <ProblemBox error={failure.value} /> : null}
      <div class="summary">
        {dataset.warnings.length ? (
          <ul class="warnings">
            {dataset.warnings.map((warning) => (
              <li>
                <Icon name="warning" /> {warning}
              </li>
            ))}
          </ul>
        ) : null}
        <div class="panels">
          <Contents dataset={dataset} />
          <Provenance dataset={dataset} />
          {dataset.sensors.length ? <Sensors sensors={dataset.sensors} /> : null}
          {dataset.units ? (
            <section class="panel">
              <h2>Units of the file</h2>
              <UnitsTable units={dataset.units} />
            </section>
          ) : null}
          <Reading dataset={dataset} />
        </div>
        <Preview dataset={dataset} />
      </div>
    </article>
  );
}

function SaveAs(props: { dataset: Dataset; failed: (error: unknown) => void }): JSX.Element {
  const { id, name } = props.dataset;
  const save = (event: TargetedEvent<HTMLSelectElement>) => {
    const chosen = FORMATS.find(([format]) => format === event.currentTarget.value);
    event.currentTarget.value = "";
    if (!chosen) return;
    const [format, , ending] = chosen;
    props.failed(undefined);
    getDatasetAs(id, format).then(
      (blob) => saveBlob(blob, `${name.replace(/\.\w+$/, "")}.${ending}`),
      props.failed,
    );
  };
  return (
    <select aria-label="Download in another format" onChange={save}>
      <option value="">Download as …</option>
      {FORMATS.map(([format, label]) => (
        <option value={format}>{label}</option>
      ))}
    </select>
  );
}

/** When the data begin or end: as UTC where the clock says that, else in its seconds. */
function momentText(time_s: number | undefined, start_s: number | undefined): string {
  if (time_s === undefined) return "–";
  if (originOf(start_s) === 0) return timeText(time_s, 0);
  return [utcText(time_s), `${time_s} s`].filter(Boolean).join(", ");
}

function Contents({ dataset }: { dataset: Dataset }): JSX.Element {
  const { start_s, end_s } = dataset;
  const rows: Fact[] = [
    ["Kind", words(dataset.kind)],
    ["Rows", count(dataset.rows)],
    ["Scans", dataset.scans ? count(dataset.scans) : "–"],
    ["Targets or tracks", count(dataset.objects)],
    ["From", momentText(start_s, start_s)],
    ["To", momentText(end_s, start_s)],
    ["Lasts", start_s === undefined || end_s === undefined ? "–" : `${number(end_s - start_s)} s`],
    ["Sensors", dataset.sensor_ids.join(", ") || "–"],
  ];
  if (dataset.first_bearing_deg !== undefined)
    rows.push([
      "Bearings",
      `${number(dataset.first_bearing_deg)}° to ${number(dataset.last_bearing_deg)}°`,
    ]);
  return <Facts title="Contents" rows={rows} />;
}

function Provenance({ dataset }: { dataset: Dataset }): JSX.Element {
  const { origin } = dataset;
  const from =
    origin.kind === "job" ? (
      <Link href={pageHref({ view: "job", job: origin.job_id })}>
        job {origin.job_id.slice(-12)}
      </Link>
    ) : (
      `upload${origin.file_name ? ` of ${origin.file_name}` : ""}`
    );
  const rows: Fact[] = [
    ["Origin", from],
    ["Created", `${dataset.created_at.slice(0, 19).replace("T", " ")} UTC`],
    ["Format", dataset.format],
    ["Size", bytes(dataset.bytes)],
    [
      "sha256",
      <span class="mono" title={dataset.sha256}>
        {dataset.sha256.slice(0, 16)}…
      </span>,
    ],
  ];
  return <Facts title="Provenance" rows={rows} />;
}

/** What the upload said of its file, for the next one. */
function Reading({ dataset }: { dataset: Dataset }): JSX.Element | null {
  const { id, reading } = dataset;
  if (!reading || !Object.keys(reading).length) return null;
  return (
    <section class="panel">
      <h2>How the file was read</h2>
      <FactList facts={Object.entries(reading).flatMap(told)} />
      <p class="row">
        <Link class="button" href={pageHref({ view: "datasets", upload: 1, like: id })}>
          Use for another file
        </Link>
      </p>
    </section>
  );
}

/** A part of a reading; of columns, each by itself. */
function told([name, value]: [string, unknown]): Fact[] {
  if (name === "columns" && isObject(value))
    return Object.entries(value).map(([from, to]): Fact => [from, String(to)]);
  return [[name, typeof value === "object" ? JSON.stringify(value) : String(value)]];
}

function Sensors({ sensors }: { sensors: SensorSettings[] }): JSX.Element {
  const rows = sensors.flatMap((sensor): [string, string][] => {
    const known = Object.entries(sensor).filter(
      ([name, value]) => name !== "sensor_id" && value !== null && value !== undefined,
    );
    return known.length
      ? known.map(([name, value]) => [`${sensor.sensor_id}: ${name}`, number(Number(value))])
      : [[sensor.sensor_id, "nothing is known"]];
  });
  return <Facts title="What is known of the sensors" rows={rows} />;
}

function Preview({ dataset }: { dataset: Dataset }): JSX.Element {
  const preview = useResource(() => previewDataset(dataset.id, PREVIEW_ROWS), [dataset.id]);
  if (preview.error) return <ProblemBox error={preview.error} retry={preview.reload} />;
  if (!preview.data) return <Loading what="the first rows" />;
  const { columns, rows, total_rows } = preview.data satisfies DatasetPreview;
  if (!rows.length) return <Empty title="The data set has no rows." />;
  const table = {
    columns,
    rows: rows.map((row): Cell[] => row.map(cellOf)),
    origin_s: originOf(dataset.start_s),
  };
  const note = (
    <p class="muted small frame-note">
      {count(rows.length)} of {plural(total_rows, "row")}; all are in the file.
    </p>
  );
  return (
    <TableFrame
      title="First rows"
      file={`preview-${dataset.id.slice(-12)}`}
      table={() => table}
      tools={note}
    >
      <DataTable table={table} caption="First rows" />
    </TableFrame>
  );
}
