// What an upload may say of its file besides the content. Which fields there are, and which kinds
// and formats, says the description of the API.

import type { Schema } from "../api/types";
import { isObject, type JsonObject } from "../form/schema";
import type { Head } from "./head";

/** Put in by the build. */
declare const UPLOAD_SCHEMA: Schema;

export const META: Schema = UPLOAD_SCHEMA;

const choices = (field: string): string[] => META.properties?.[field]?.enum ?? [];

export const KINDS = choices("kind");
export const FORMATS = choices("format");

/** Fields with a place of their own in the form. */
const APART = ["name", "kind", "format", "columns"];

/** Names of the fields that only some files need. */
export const OPTIONS = Object.keys(META.properties ?? {}).filter((name) => !APART.includes(name));

/** Options that say something of one file and nothing of the next. */
const OF_ONE_FILE = ["start", "date"];

export type Columns = Record<string, string>;

export function columnsOf(meta: JsonObject): Columns {
  return (isObject(meta.columns) ? meta.columns : {}) as Columns;
}

/** The meta with other columns. */
export function withColumns({ columns: _, ...rest }: JsonObject, columns: Columns): JsonObject {
  return Object.keys(columns).length ? { ...rest, columns } : rest;
}

/** A part of the meta set, or taken out where it is empty. */
export function withField(meta: JsonObject, name: string, value: unknown): JsonObject {
  const { [name]: _, ...rest } = meta;
  return value === undefined || value === "" ? rest : { ...rest, [name]: value };
}

/** What goes with a file of this name: columns that keep their names need not be told. */
export function sentMeta(meta: JsonObject, fileName: string): JsonObject {
  const columns = Object.entries(columnsOf(meta)).filter(([from, to]) => to !== "" && to !== from);
  return { name: fileName, ...withColumns(meta, Object.fromEntries(columns)) };
}

/** What of the meta holds for the next file, too. */
export function lasting(meta: JsonObject): JsonObject {
  const kept = Object.entries(meta).filter(
    ([name]) => name !== "name" && !OF_ONE_FILE.includes(name),
  );
  return Object.fromEntries(kept);
}

/** The meta without columns that the file does not have. */
export function fitting(meta: JsonObject, head: Head | undefined): JsonObject {
  if (!head) return meta;
  const known = Object.entries(columnsOf(meta)).filter(([name]) => head.columns.includes(name));
  return withColumns(meta, Object.fromEntries(known));
}

/** The mapping as `trackloom inspect --mapping` takes it: columns, format and options. */
export function mappingText({ name: _n, kind: _k, sensors: _s, ...rest }: JsonObject): string {
  return `${JSON.stringify(rest, null, 2)}\n`;
}
