// Reading JSON Schema the way the catalogue writes it: references, unions told apart by a tag,
// defaults.

import type { Schema } from "../api/types";

export interface Variant {
  tag: string;
  value: string;
  schema: Schema;
}

export function resolve(schema: Schema, root: Schema): Schema {
  if (!schema.$ref) return schema;
  const name = schema.$ref.split("/").at(-1) ?? "";
  const { $ref: _, ...own } = schema;
  return { ...resolve(root.$defs?.[name] ?? {}, root), ...own };
}

function onlyValue(schema: Schema | undefined): string | undefined {
  return schema?.const ?? (schema?.enum?.length === 1 ? schema.enum[0] : undefined);
}

/**
 * The members of a union; empty when the schema is none. The tag is the field that has one value in
 * every member.
 */
export function variants(schema: Schema, root: Schema): Variant[] {
  const members = (schema.oneOf ?? []).map((member) => resolve(member, root));
  const first = members[0]?.properties ?? {};
  const tag = Object.keys(first).find((name) =>
    members.every((member) => onlyValue(member.properties?.[name]) !== undefined),
  );
  if (tag === undefined) return [];
  return members.map((member) => ({
    tag,
    value: onlyValue(member.properties?.[tag]) ?? "",
    schema: member,
  }));
}

export type JsonObject = Record<string, unknown>;

export function isObject(value: unknown): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/**
 * A value to begin with: defaults where the schema has them, at every depth. A number that has no
 * default stays absent, so that the service asks for it instead of taking a guess.
 */
export function initial(schema: Schema, root: Schema): unknown {
  const real = resolve(schema, root);
  const given = real.default;
  const all = variants(real, root);
  const chosen =
    all.find((variant) => isObject(given) && given[variant.tag] === variant.value) ?? all[0];
  if (chosen) return { ...variantValue(chosen, root), ...(isObject(given) ? given : {}) };
  if (real.type === "object")
    return { ...objectValue(real, root), ...(isObject(given) ? given : {}) };
  if (given !== undefined) return structuredClone(given);
  if (real.type === "array")
    return Array.from({ length: real.minItems ?? 0 }, () => initial(real.items ?? {}, root));
  if (real.type === "boolean") return false;
  return real.type === "string" ? (real.enum?.[0] ?? "") : undefined;
}

export function variantValue(variant: Variant, root: Schema): JsonObject {
  return { [variant.tag]: variant.value, ...objectValue(variant.schema, root, variant.tag) };
}

function objectValue(schema: Schema, root: Schema, except?: string): JsonObject {
  const value: JsonObject = {};
  for (const [name, field] of Object.entries(schema.properties ?? {})) {
    if (name === except) continue;
    const needed = schema.required?.includes(name) || resolve(field, root).default !== undefined;
    const begin = needed ? initial(field, root) : undefined;
    if (begin !== undefined) value[name] = begin;
  }
  return value;
}

export function childPointer(pointer: string, key: string | number): string {
  return `${pointer}/${String(key).replaceAll("~", "~0").replaceAll("/", "~1")}`;
}

/** A token of a JSON pointer as the name that it stands for. */
export const unescaped = (token: string): string =>
  token.replaceAll("~1", "/").replaceAll("~0", "~");

/**
 * The field of the form for a place in the request: the place itself, or the nearest part above it
 * that is not there.
 */
export function shownPointer(pointer: string, spec: unknown): string {
  let shown = "";
  let value = spec;
  for (const token of pointer.split("/").slice(1)) {
    if (!isObject(value) && !Array.isArray(value)) return shown;
    shown += `/${token}`;
    value = (value as JsonObject)[unescaped(token)];
  }
  return shown;
}

export function fieldId(pointer: string): string {
  return `field${pointer.replaceAll("/", "-").replace(/[^\w-]/g, "_")}`;
}

/** What may stand in a field, in words. */
export function allowedText(schema: Schema): string {
  if (schema["x-allowed"]) return schema["x-allowed"];
  const low = schema.minimum ?? schema.exclusiveMinimum;
  const high = schema.maximum ?? schema.exclusiveMaximum;
  if (low !== undefined && high !== undefined && high < Number.MAX_SAFE_INTEGER)
    return `${low} to ${high}`;
  if (low !== undefined) return schema.minimum === undefined ? `above ${low}` : `at least ${low}`;
  return high === undefined ? "" : `at most ${high}`;
}
