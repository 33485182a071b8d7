// A table that people take into papers: CSV, Markdown and LaTeX of what stands in it.

import type { ComponentChildren, JSX } from "preact";
import { Icon } from "./basics";
import { saveText } from "./save";
import { cellText, heads, type TableData, toCsv } from "./table";

const shown = (table: TableData): string[][] =>
  table.rows.map((row) => row.map((cell, column) => cellText(table, cell, column)));

export function toMarkdown(table: TableData): string {
  const escaped = (text: string) => text.replaceAll("|", "\\|").replaceAll("\n", " ");
  const line = (cells: string[]) => `| ${cells.map(escaped).join(" | ")} |`;
  const rule = `|${"---|".repeat(table.columns.length)}`;
  return `${[line(heads(table)), rule, ...shown(table).map(line)].join("\n")}\n`;
}

const LATEX: Record<string, string> = {
  "\\": "\\textbackslash{}",
  "~": "\\textasciitilde{}",
  "^": "\\textasciicircum{}",
  "–": "--",
  "−": "$-$",
  "×": "$\\times$",
};

export function toLatex(table: TableData): string {
  const escaped = (text: string) =>
    text
      .replace(/[\\~^–−×]|[&%$#_{}]/g, (sign) => LATEX[sign] ?? `\\${sign}`)
      .replaceAll("\n", " ");
  const numeric = table.columns.map((_, column) =>
    table.rows.every((row) => row[column] === null || typeof row[column] === "number"),
  );
  const line = (cells: string[]) => `  ${cells.map(escaped).join(" & ")} \\\\`;
  const layout = numeric.map((right) => (right ? "r" : "l")).join("");
  const lines = [line(heads(table)), "  \\hline", ...shown(table).map(line)];
  return [
    `\\begin{tabular}{${layout}}`,
    "  \\hline",
    ...lines,
    "  \\hline",
    "\\end{tabular}",
    "",
  ].join("\n");
}

interface Props {
  title: string;
  file: string;
  table: () => TableData;
  tools?: ComponentChildren;
  children: ComponentChildren;
}

export function TableFrame({ title, file, table, tools, children }: Props): JSX.Element {
  const save = (write: (table: TableData) => string, ending: string, type: string) => () =>
    saveText(write(table()), `${file}.${ending}`, type);
  const button = (name: string, press: () => void) => (
    <button type="button" class="quiet" onClick={press}>
      <Icon name="download" /> {name}
    </button>
  );
  return (
    <section class="chart-frame table-frame" aria-label={title}>
      <div class="chart-head">
        <h2>{title}</h2>
        <div class="chart-tools">
          {button("CSV", save(toCsv, "csv", "text/csv"))}
          {button("Markdown", save(toMarkdown, "md", "text/markdown"))}
          {button("LaTeX", save(toLatex, "tex", "text/x-tex"))}
        </div>
      </div>
      {tools}
      {children}
    </section>
  );
}
