// Where the faults of a file are shown: at the column or the field that they are of, else together.

import { ApiError } from "../api/client";
import type { Fault, Inspection } from "../api/types";
import { asProblem } from "../components/basics";
import { isObject, type JsonObject, shownPointer, unescaped } from "../form/schema";
import type { Head } from "./head";
import { type Columns, columnsOf, META, OPTIONS } from "./meta";

export interface Placed {
  columns: Map<string, Fault[]>;
  /** By the pointer of the field within the meta. */
  fields: Map<string, Fault[]>;
  /** What has no place in the form, as a problem of its own. */
  rest: unknown;
}

/**
 * The column of the file that a fault is of: the one it names, or the one that is read as what it
 * names.
 */
function columnOf(fault: Fault, head: Head | undefined, columns: Columns): string | undefined {
  const named = /^\/meta\/columns\/(.*)$/.exec(fault.pointer)?.[1];
  const column = named === undefined ? fault.column : unescaped(named);
  if (!head || !column) return undefined;
  const isReadAs = (name: string): boolean => columns[name]?.split("[")[0]?.trim() === column;
  return head.columns.includes(column) ? column : head.columns.find(isReadAs);
}

/** The field of the form that shows a fault, as a pointer within the meta. */
function fieldOf(fault: Fault, head: Head | undefined, meta: JsonObject): string | undefined {
  const [, pointer = "", name = ""] = /^\/meta(\/([^/]+).*)$/.exec(fault.pointer) ?? [];
  const field = META.properties?.[name];
  if (!field || name === "name" || (head && name === "columns")) return undefined;
  return isObject(field.additionalProperties) ? `/${name}` : shownPointer(pointer, meta);
}

export function placed(error: unknown, head: Head | undefined, meta: JsonObject): Placed {
  const places: Placed = { columns: new Map(), fields: new Map(), rest: undefined };
  if (!error) return places;
  const problem = asProblem(error);
  const unplaced: Fault[] = [];
  const put = (map: Map<string, Fault[]>, key: string, fault: Fault) =>
    map.set(key, [...(map.get(key) ?? []), fault]);
  for (const fault of problem.errors ?? []) {
    const column = columnOf(fault, head, columnsOf(meta));
    const field = column ? undefined : fieldOf(fault, head, meta);
    if (column) put(places.columns, column, fault);
    else if (field) put(places.fields, field, fault);
    else unplaced.push(fault);
  }
  const isElsewhere = places.columns.size + places.fields.size > 0;
  if (unplaced.length || !isElsewhere) places.rest = new ApiError({ ...problem, errors: unplaced });
  return places;
}

/** What a reason of rejected units asks for. */
const ASKED_BY: Record<string, string[]> = { no_time: ["start", "date"] };

/** Options that a text names: in quotes, or where the name is no ordinary word. */
function optionsIn(text: string): string[] {
  const isNamed = (name: string): boolean =>
    new RegExp(name.includes("_") ? `\\b${name}\\b` : `[\`'"]${name}\\b`).test(text);
  const asked = Object.entries(ASKED_BY).flatMap(([why, names]) =>
    new RegExp(`\\b${why}\\b`).test(text) ? names : [],
  );
  return [...OPTIONS.filter(isNamed), ...asked];
}

/** Options that the answer to a look asks for: by a fault, or by what would be read otherwise. */
export function askedOptions({ fields }: Placed, error: unknown, found?: Inspection): string[] {
  const faults = error ? (asProblem(error).errors ?? []) : [];
  const told = [...(found?.suspicions ?? []), ...(found?.warnings ?? [])];
  const texts = [...faults.map((fault) => fault.detail), ...told];
  const faulted = [...fields.keys()].map((pointer) => pointer.split("/")[1] ?? "");
  return [...new Set([...faulted, ...texts.flatMap(optionsIn)])];
}

/** How many faults stand at columns and fields. */
export function countOf({ columns, fields }: Placed): number {
  const lists = [...columns.values(), ...fields.values()];
  return lists.reduce((sum, list) => sum + list.length, 0);
}
