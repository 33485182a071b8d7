// The names of a file's columns and its first rows, where it is a table in text or JSON: what a
// person needs to say which column is which. The service reads the file by itself.

import { type CsvTable, parseCsv } from "../components/csv";
import { isObject } from "../form/schema";

export type Head = CsvTable;

/** As much of a file as its header and a few rows need. */
const HEAD_BYTES = 65_536;
/** A JSON document is read whole, so only a small one is. */
const JSON_BYTES = 4_000_000;
const HEAD_ROWS = 3;
const MOST_COLUMNS = 60;
const SEPARATORS = [",", ";", "\t", "|"];

/**
 * Header and first rows of what looks like a table.
 *
 * @throws what the browser says of a file that cannot be read, such as a folder
 */
export async function headOf(file: File, encoding?: unknown): Promise<Head | undefined> {
  const bytes = await firstBytes(file, HEAD_BYTES);
  const text = decoded(bytes, encoding);
  if (text === undefined) return undefined;
  const first = text.trimStart()[0];
  const table =
    first === "{" || first === "[" ? jsonHead(await wholeText(file, text)) : textHead(text);
  return table && table.columns.length <= MOST_COLUMNS ? table : undefined;
}

/** The first bytes, unpacked where the file is gzip. */
async function firstBytes(file: File, most: number): Promise<Uint8Array> {
  const bytes = new Uint8Array(await file.slice(0, most).arrayBuffer());
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  const reader = file.stream().pipeThrough(new DecompressionStream("gzip")).getReader();
  const parts: number[] = [];
  try {
    while (parts.length < most) {
      const { done, value } = await reader.read();
      if (done) break;
      parts.push(...value.subarray(0, most - parts.length));
    }
    await reader.cancel();
  } catch {
    // What is wrong with it the service says.
  }
  return new Uint8Array(parts);
}

/** As text; `undefined` of what is none. */
function decoded(bytes: Uint8Array, encoding: unknown): string | undefined {
  const mark = ((bytes[0] ?? 0) << 8) | (bytes[1] ?? 0);
  const marked = mark === 0xfffe ? "utf-16le" : mark === 0xfeff ? "utf-16be" : undefined;
  if (!marked && bytes.includes(0)) return undefined;
  try {
    const label = marked ?? (typeof encoding === "string" && encoding ? encoding : "utf-8");
    return new TextDecoder(label).decode(bytes);
  } catch {
    return undefined; // no such encoding
  }
}

async function wholeText(file: File, head: string): Promise<string> {
  return file.size <= JSON_BYTES && head.length >= HEAD_BYTES ? file.text() : head;
}

function textHead(text: string): Head | undefined {
  const lines = text.split("\n");
  const at = lines.findIndex((line) => line.trim() !== "" && !line.startsWith("#"));
  const line = lines[at] ?? "";
  const separator = separatorOf(line);
  const above = lines[at - 1] ?? "";
  const isMarked = above.startsWith("#") && isHeaderOf(above, line, separator);
  const body = lines
    .slice(isMarked ? at - 1 : at)
    .filter((each, index) => index === 0 || !each.startsWith("#"))
    .join("\n");
  const { columns, rows } = parseCsv(body, HEAD_ROWS, separator);
  const names = columns.map((name) => name.trim());
  const named = names.filter((name) => name !== "");
  const isTable = named.length > 1 && !named.some((name) => Number.isFinite(Number(name)));
  return isTable ? { columns: names, rows } : undefined;
}

const cellsOf = (line: string, separator: string): number => line.split(separator).length;

/** Whether a line of comment names the columns of the row below it. */
function isHeaderOf(comment: string, row: string, separator: string): boolean {
  const cells = row.split(separator);
  return (
    cells.length > 1 &&
    cells.length === cellsOf(comment, separator) &&
    cells.some((cell) => /^\s*\d/.test(cell))
  );
}

/** The separator that a line has most of, outside quotes. */
function separatorOf(line: string): string {
  const bare = line.replaceAll(/"[^"]*"/g, "");
  const most = (best: string, next: string): string =>
    cellsOf(bare, next) > cellsOf(bare, best) ? next : best;
  return SEPARATORS.reduce(most);
}

/** Of columns, of an array of records, or of a record a line. */
function jsonHead(text: string): Head | undefined {
  const value = parsed(text) ?? parsed(text.slice(0, text.indexOf("\n")));
  if (Array.isArray(value)) return recordsHead(value);
  if (!isObject(value)) return undefined;
  const table = isObject(value.columns) ? value.columns : value;
  const columns = Object.entries(table).filter(([, cells]) => Array.isArray(cells));
  if (columns.length < 2) return recordsHead([value]);
  const texts = columns.map(([, cells]) => (cells as unknown[]).slice(0, HEAD_ROWS).map(String));
  const rows = (texts[0] ?? []).map((_, row) => texts.map((column) => column[row] ?? ""));
  return { columns: columns.map(([name]) => name), rows };
}

function recordsHead(records: unknown[]): Head | undefined {
  const [first] = records;
  if (!isObject(first)) return undefined;
  const isPlain = (name: string): boolean => typeof first[name] !== "object" || !first[name];
  const columns = Object.keys(first).filter(isPlain);
  const rows = records.slice(0, HEAD_ROWS).filter(isObject);
  if (columns.length < 2) return undefined;
  return { columns, rows: rows.map((row) => columns.map((name) => String(row[name] ?? ""))) };
}

function parsed(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}
