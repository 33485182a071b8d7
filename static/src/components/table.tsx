// A plain table of values: the twin of every chart, and the source of its CSV file.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Cell, Columns } from "../api/types";
import { number } from "../format";

export interface TableData {
  /** Names with their units, as they head the CSV file. */
  columns: string[];
  rows: Cell[][];
}

const ROWS_AT_ONCE = 200;

export function fromColumns(columns: Columns, keep: (row: number) => boolean = () => true): TableData {
  const names = Object.keys(columns);
  const length = names.length ? (columns[names[0]!]?.length ?? 0) : 0;
  const rows: Cell[][] = [];
  for (let row = 0; row < length; row++) {
    if (keep(row)) rows.push(names.map((name) => columns[name]?.[row] ?? null));
  }
  return { columns: names, rows };
}

function csvCell(cell: Cell): string {
  if (cell === null) return "";
  const text = String(cell);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export function toCsv(table: TableData): string {
  return [table.columns, ...table.rows].map((row) => row.map(csvCell).join(",")).join("\r\n") + "\r\n";
}

export function DataTable({ table, caption }: { table: TableData; caption: string }): JSX.Element {
  const [shown, setShown] = useState(ROWS_AT_ONCE);
  const numeric = table.columns.map((_, column) => table.rows.every((row) => row[column] === null || typeof row[column] === "number"));
  return (
    <div class="table-scroll" tabIndex={0} role="region" aria-label={caption}>
      <table class="data">
        <caption class="visually-hidden">{caption}</caption>
        <thead>
          <tr>
            {table.columns.map((name, column) => (
              <th scope="col" class={numeric[column] ? "num" : undefined}>
                {name}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {table.rows.slice(0, shown).map((row) => (
            <tr>
              {row.map((cell, column) => (
                <td class={numeric[column] ? "num" : undefined}>{typeof cell === "number" ? number(cell) : (cell ?? "–")}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      {table.rows.length > shown ? (
        <p class="more">
          <button type="button" onClick={() => setShown(shown + ROWS_AT_ONCE)}>
            Show more
          </button>
          <span class="muted">
            {shown} of {table.rows.length} rows
          </span>
        </p>
      ) : null}
    </div>
  );
}
