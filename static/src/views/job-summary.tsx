// The summary of a finished job: its numbers, warnings, inputs, timing, and what happened scan by scan.

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import { getSeries } from "../api/client";
import type { Job, Report, Series, Tfa } from "../api/types";
import { textStyle, timeText, tipContent, tooltip, GRID, valueAxis } from "../charts/axes";
import { ChartCanvas } from "../charts/chart";
import type { Chart } from "../charts/echarts";
import { ChartFrame, reducedBadge } from "../charts/frame";
import { Icon, Link, Loading, ProblemBox, type IconName } from "../components/basics";
import { useResource } from "../components/resource";
import { fromColumns } from "../components/table";
import { capital, count, duration, probability, words } from "../format";
import { readPalette, theme } from "../state/theme";
import { hereHref, pageHref } from "../state/url";

export function JobSummary({ job, report }: { job: Job; report: Report }): JSX.Element {
  const { tfa, association, counts } = report.result;
  const warnings = [...new Set([...job.warnings, ...report.warnings])];
  return (
    <div class="summary">
      {warnings.length ? (
        <ul class="warnings">
          {warnings.map((warning) => (
            <li>
              <Icon name="warning" /> {warning}
            </li>
          ))}
        </ul>
      ) : null}
      {tfa ? <TfaNumbers tfa={tfa} /> : null}
      <div class="panels">
        {association ? <Counts title={`Association, ${words(association.method)}`} counts={association.counts} /> : null}
        {counts ? <Counts title="Scene" counts={counts} /> : null}
        <Timing timing={report.timing} />
        <Inputs report={report} />
      </div>
      <ScanCounts jobId={job.id} />
    </div>
  );
}

const VERDICTS: { name: "correct" | "missed" | "false"; of: (tfa: Tfa) => string }[] = [
  { name: "correct", of: (tfa) => `of ${count(tfa.counts.output_tracks)} output tracks` },
  { name: "missed", of: (tfa) => `of ${count(tfa.counts.targets)} targets` },
  { name: "false", of: (tfa) => `of ${count(tfa.counts.targets)} targets` },
];

/** Correct, missed and false: how many targets, and the probabilities as the paper defines them. */
export function TfaNumbers({ tfa }: { tfa: Tfa }): JSX.Element {
  return (
    <section class="verdict-cards" aria-label="Verdicts">
      {VERDICTS.map(({ name, of }) => (
        <Link class={`verdict-card verdict-${name}`} href={hereHref({ tab: "verdicts", verdict: name, page: null })}>
          <span class="verdict-name">
            <Icon name={name as IconName} /> {name}
          </span>
          <span class="verdict-count">{count(tfa.counts[name])}</span>
          <span class="verdict-probability">
            P = <b>{probability(tfa.probability[name])}</b>
          </span>
          <span class="muted small">{of(tfa)}</span>
        </Link>
      ))}
    </section>
  );
}

function Counts({ title, counts }: { title: string; counts: Record<string, number> }): JSX.Element {
  return (
    <section class="panel">
      <h2>{capital(title)}</h2>
      <dl class="facts">
        {Object.entries(counts).map(([name, value]) => (
          <>
            <dt>{capital(words(name))}</dt>
            <dd>{count(value)}</dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Timing({ timing }: { timing: Report["timing"] }): JSX.Element {
  return (
    <section class="panel">
      <h2>Computing time</h2>
      <dl class="facts">
        {Object.entries(timing).map(([name, value]) => (
          <>
            <dt>{capital(words(name))}</dt>
            <dd>{duration(value)}</dd>
          </>
        ))}
      </dl>
    </section>
  );
}

function Inputs({ report }: { report: Report }): JSX.Element {
  return (
    <section class="panel">
      <h2>Inputs</h2>
      {report.inputs.length ? null : <p class="muted">None: the scene was simulated.</p>}
      <ul class="inputs">
        {report.inputs.map((input) => (
          <li>
            <b>{input.role}</b> from {input.source} {input.job_id ? <Link href={pageHref({ view: "job", job: input.job_id })}>{input.job_id.slice(-12)}</Link> : null}
            {input.dataset_id ? <a href={`/v1/datasets/${input.dataset_id}/content`}>{input.dataset_id.slice(-12)}</a> : null}
            <span class="sub mono" title={input.sha256}>
              sha256 {input.sha256.slice(0, 16)}…
            </span>
          </li>
        ))}
      </ul>
      <dl class="facts">
        <dt>Engine</dt>
        <dd>{report.engine_version}</dd>
        <dt>Seed</dt>
        <dd>{report.seed}</dd>
      </dl>
    </section>
  );
}

const LINES = [
  { column: "detections", type: "dotted", symbol: "emptyRect" },
  { column: "tracks", type: "dashed", symbol: "emptyTriangle" },
  { column: "confirmed", type: "solid", symbol: "circle" },
] as const;

function drawCounts(chart: Chart, series: Series): void {
  const palette = readPalette();
  const columns = series.columns;
  const times = (columns["time_s"] ?? []) as number[];
  const start = times[0] ?? 0;
  const offset = Math.abs(start) > 1e6 ? start : 0;
  const colors = [palette.sensors[0], palette.muted, palette.track];
  const present = LINES.filter(({ column }) => columns[column]?.some((cell) => cell !== null));
  chart.setOption(
    {
      animation: false,
      textStyle: textStyle(palette),
      grid: GRID,
      tooltip: { trigger: "axis", ...tooltip(palette), formatter: (items: { dataIndex: number }[]) => countsTip(series, times, items[0]?.dataIndex ?? 0) },
      xAxis: valueAxis(offset ? "time from the first scan (s)" : "time (s)", palette, { min: start, max: times.at(-1) ?? 1, nameGap: 26, axisLabel: { color: palette.muted, fontSize: 11, hideOverlap: true, formatter: (value: number) => String(Number((value - offset).toFixed(3))) } }),
      yAxis: valueAxis("count", palette, { min: 0, minInterval: 1, nameGap: 40 }),
      dataZoom: [{ type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl" }],
      series: present.map(({ column, type, symbol }) => {
        const color = colors[LINES.findIndex((line) => line.column === column)];
        return { type: "line", name: column, animation: false, symbol, symbolSize: 5, showSymbol: times.length <= 60, data: times.map((time, row) => [time, columns[column]?.[row] ?? null]), lineStyle: { color, type, width: 1.6 }, itemStyle: { color } };
      }),
    },
    { replaceMerge: ["series"] },
  );
}

function countsTip(series: Series, times: number[], row: number): HTMLElement {
  const part = (name: string) => String(series.columns[name]?.[row] ?? "–");
  const rows = LINES.map(({ column }): [string, string] => [column, part(column)]);
  return tipContent(`${timeText(times[row] ?? 0, times)} · scan ${part("scan")}`, [["sensor", part("sensor_id")], ...rows]);
}

function ScanCounts({ jobId }: { jobId: string }): JSX.Element {
  const series = useResource(() => getSeries(jobId, "scan_counts"), [jobId]);
  const chart = useRef<Chart | undefined>(undefined);
  if (series.error) return <ProblemBox error={series.error} retry={series.reload} />;
  if (!series.data) return <Loading what="the counts of each scan" />;
  const data = series.data;
  const scans = data.columns["time_s"]?.length ?? 0;
  const key = (
    <p class="legend legend-note">
      <span class="key key-detections">detections</span>
      <span class="key key-none">tracks</span>
      <span class="key key-best">confirmed tracks</span>
    </p>
  );
  return (
    <ChartFrame title="Scan by scan" file={`scan-counts-${jobId.slice(-12)}`} badge={reducedBadge([data])} table={() => fromColumns(data.columns)} chart={() => chart.current} tools={key}>
      <ChartCanvas
        class="counts-canvas"
        label={`Detections, tracks and confirmed tracks of ${scans} scans. The table shows the same numbers.`}
        keys={[data, theme.value]}
        draw={(made) => {
          chart.current = made;
          drawCounts(made, data);
        }}
      />
    </ChartFrame>
  );
}
