// How files were read, kept in the browser for the next file with the same columns, or, of a file
// that names none, with the same ending.

import { isObject, type JsonObject } from "../form/schema";
import type { Head } from "./head";
import { lasting } from "./meta";

const STORAGE_KEY = "trackloom.readings";
const MOST = 30;

export interface Reading {
  /** What was read so, or a file that says how to read. */
  file: string;
  /** When it was read (ISO 8601). */
  at?: string;
  meta: JsonObject;
}

interface Kept extends Reading {
  key: string;
}

/** What files that are read alike have in common. */
export function keyOf(fileName: string, head: Head | undefined): string {
  if (head) return `columns ${JSON.stringify(head.columns)}`;
  const bare = fileName.toLowerCase().replace(/\.(gz|zst)$/, "");
  return `ending ${/\.\w+$/.exec(bare)?.[0] ?? ""}`;
}

function all(): Kept[] {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(STORAGE_KEY) ?? "[]");
    const isKept = (one: unknown): boolean =>
      isObject(one) && isObject(one.meta) && typeof one.file === "string";
    return Array.isArray(kept) ? (kept.filter(isKept) as Kept[]) : [];
  } catch {
    return []; // storage may be forbidden, or hold something else
  }
}

export function recall(key: string): Reading | undefined {
  return all().find((kept) => kept.key === key);
}

/** Keeps how a file was read; nothing to tell is nothing to keep. */
export function remember(key: string, file: string, told: JsonObject): void {
  const others = all().filter((kept) => kept.key !== key);
  const meta = lasting(told);
  const kept: Kept = { key, file, at: new Date().toISOString(), meta };
  const next = Object.keys(meta).length ? [kept, ...others] : others;
  try {
    localStorage.setItem(STORAGE_KEY, JSON.stringify(next.slice(0, MOST)));
  } catch {
    // then the next file is read anew
  }
}
