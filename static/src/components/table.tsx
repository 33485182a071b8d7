// A plain table of values: the twin of every chart, and the source of its CSV file.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Cell, Columns } from "../api/types";
import { number } from "../format";
import { isTimeColumn, timeCell, timeHead, timeTitle } from "../times";
import { HeadRow, numberHead, TableScroll } from "./table-parts";

export interface TableData {
  /** Names with their units, as they head the CSV file. */
  columns: string[];
  rows: Cell[][];
  /**
   * Where the times of people's tables count from; a CSV file has them as they are. 0 when absent.
   */
  origin_s?: number;
}

/** The names of the columns as people read them. */
export function heads({ columns, origin_s = 0 }: TableData): string[] {
  return columns.map((name) => timeHead(name, origin_s));
}

/** A cell as people read it. */
export function cellText({ columns, origin_s = 0 }: TableData, cell: Cell, column: number): string {
  if (typeof cell !== "number") return cell ?? "–";
  return isTimeColumn(columns[column] ?? "") ? timeCell(cell, origin_s) : number(cell);
}

function cellTitle(
  { columns, origin_s = 0 }: TableData,
  cell: Cell,
  column: number,
): string | undefined {
  return typeof cell === "number" && isTimeColumn(columns[column] ?? "")
    ? timeTitle(cell, origin_s)
    : undefined;
}

const ROWS_AT_ONCE = 200;

export function fromColumns(columns: Columns, origin_s = 0): TableData {
  const names = Object.keys(columns);
  const length = Object.values(columns)[0]?.length ?? 0;
  const rows: Cell[][] = [];
  for (let row = 0; row < length; row++) {
    rows.push(names.map((name) => columns[name]?.[row] ?? null));
  }
  return { columns: names, rows, origin_s };
}

function csvCell(cell: Cell): string {
  if (cell === null) return "";
  const text = String(cell);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export function toCsv(table: TableData): string {
  return [table.columns, ...table.rows].map((row) => `${row.map(csvCell).join(",")}\r\n`).join("");
}

export function DataTable({ table, caption }: { table: TableData; caption: string }): JSX.Element {
  const [shown, setShown] = useState(ROWS_AT_ONCE);
  const numeric = table.columns.map((_, column) =>
    table.rows.every((row) => row[column] === null || typeof row[column] === "number"),
  );
  const named = heads(table).map((name, column) => (numeric[column] ? numberHead(name) : name));
  return (
    <TableScroll label={caption} class="table-scroll">
      <table class="data">
        <caption class="visually-hidden">{caption}</caption>
        <HeadRow heads={named} />
        <tbody>
          {table.rows.slice(0, shown).map((row) => (
            <tr>
              {row.map((cell, column) => (
                <td
                  class={numeric[column] ? "num" : undefined}
                  title={cellTitle(table, cell, column)}
                >
                  {cellText(table, cell, column)}
                </td>
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
    </TableScroll>
  );
}
