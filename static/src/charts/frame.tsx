// What stands around every chart: its title, how much of the data it shows, its table twin, and its
// exports.

import type { ComponentChildren, JSX } from "preact";
import { useState } from "preact/hooks";
import { Icon } from "../components/basics";
import { saveText } from "../components/save";
import { DataTable, type TableData, toCsv } from "../components/table";
import { count } from "../format";
import { type Palette, readPalette } from "../state/theme";
import type { KeyMark } from "./marks";
import { type Source, savePng, saveSvg } from "./picture";

interface FrameProps {
  title: string;
  /** Begins the names of saved files. */
  file: string;
  badge?: string | undefined;
  /** The data as drawn now. */
  table: () => TableData;
  chart: () => Source | undefined;
  /** What the colours and lines mean, for the saved picture. */
  pictureKey: (palette: Palette) => KeyMark[];
  /** What the saved picture is of; the title alone when absent. */
  pictureTitle?: string;
  tools?: ComponentChildren;
  children: ComponentChildren;
  class?: string;
}

export function reducedBadge(
  parts: { name: string; source_points: number; returned_points: number; method: string }[],
): string | undefined {
  const reduced = parts.filter((part) => part.returned_points < part.source_points);
  if (!reduced.length) return undefined;
  const words = reduced.map(({ name, returned_points, source_points, method }) => {
    const how = method.replaceAll("_", " ");
    return `${name} ${count(returned_points)} of ${count(source_points)} (${how})`;
  });
  return `Shown: ${words.join("; ")}`;
}

export function ChartFrame({
  title,
  file,
  badge,
  table,
  chart,
  pictureKey,
  pictureTitle,
  tools,
  children,
  ...rest
}: FrameProps): JSX.Element {
  const [asTable, setAsTable] = useState(false);
  const save = (as: "png" | "svg") => () => {
    const drawn = chart();
    const write = as === "png" ? savePng : saveSvg;
    if (drawn) void write(drawn, pictureTitle ?? title, pictureKey(readPalette()), `${file}.${as}`);
  };
  return (
    <section class={`chart-frame ${rest.class ?? ""}`} aria-label={title}>
      <div class="chart-head">
        <h2>{title}</h2>
        {badge ? <span class="reduced">{badge}</span> : null}
        <div class="chart-tools">
          <button
            type="button"
            class="quiet"
            aria-pressed={asTable}
            onClick={() => setAsTable(!asTable)}
          >
            <Icon name={asTable ? "chart" : "table"} /> {asTable ? "Chart" : "Table"}
          </button>
          <button
            type="button"
            class="quiet"
            onClick={() => saveText(toCsv(table()), `${file}.csv`, "text/csv")}
          >
            <Icon name="download" /> CSV
          </button>
          {asTable ? null : (
            <>
              <button type="button" class="quiet" onClick={save("png")}>
                <Icon name="download" /> PNG
              </button>
              <button type="button" class="quiet" onClick={save("svg")}>
                <Icon name="download" /> SVG
              </button>
            </>
          )}
        </div>
      </div>
      {tools}
      {asTable ? <DataTable table={table()} caption={title} /> : children}
    </section>
  );
}
