// Reading the CSV files of a job: a header, then rows of text.

import type { Cell } from "../api/types";

export interface CsvTable {
  columns: string[];
  rows: string[][];
}

/**
 * RFC 4180: fields divided by commas or another separator, quoted where they hold separators,
 * quotes or line ends. At most `limit` rows below the header.
 */
export function parseCsv(text: string, limit = Infinity, separator = ","): CsvTable {
  const lines: string[][] = [];
  let row: string[] = [];
  let at = 0;
  while (at < text.length && lines.length <= limit) {
    let field: string;
    if (text[at] === '"') [field, at] = quoted(text, at + 1);
    else {
      const end = endOf(text, at, separator);
      [field, at] = [text.slice(at, end), end];
    }
    row.push(field);
    if (text[at] === separator) {
      at += 1;
      if (at < text.length) continue;
      row.push("");
    }
    if (text[at] === "\r") at += 1;
    if (text[at] === "\n") at += 1;
    lines.push(row);
    row = [];
  }
  const [columns = [], ...rows] = lines;
  return { columns, rows: rows.slice(0, limit) };
}

function endOf(text: string, from: number, separator: string): number {
  let end = from;
  while (end < text.length && text[end] !== separator && text[end] !== "\n" && text[end] !== "\r")
    end += 1;
  return end;
}

function quoted(text: string, from: number): [string, number] {
  let end = text.indexOf('"', from);
  while (end >= 0 && text[end + 1] === '"') end = text.indexOf('"', end + 2);
  if (end < 0) return [text.slice(from), text.length];
  return [text.slice(from, end).replaceAll('""', '"'), end + 1];
}

/** A reader of one column of a table: the text of a row, empty where the column is absent. */
export function reader(table: CsvTable, name: string): (row: string[]) => string {
  const column = table.columns.indexOf(name);
  return (row) => (column < 0 ? "" : (row[column] ?? ""));
}

/** A field as a number where it is one. */
export function cellOf(text: string): Cell {
  if (text.trim() === "") return null;
  const value = Number(text);
  return Number.isFinite(value) ? value : text;
}
