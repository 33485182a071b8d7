// Fields made of fields: objects, unions told apart by a select, lists, maps of text.

import type { ComponentChildren, JSX, TargetedEvent } from "preact";
import type { Schema } from "../api/types";
import { Icon } from "../components/basics";
import { capital, words } from "../format";
import { type FieldProps, type FormScope, useScope } from "./context";
import { Field, FieldFaults } from "./field";
import {
  childPointer,
  fieldId,
  initial,
  isObject,
  type JsonObject,
  variants,
  variantValue,
} from "./schema";

const LIST_SHOWN = 20;

interface GroupProps {
  name: string;
  schema: Schema;
  pointer: string;
  remove?: (() => void) | undefined;
  children: ComponentChildren;
}

function Group({ name, schema, pointer, remove, children }: GroupProps): JSX.Element {
  return (
    <fieldset class="group" id={fieldId(pointer)} tabIndex={-1}>
      <legend>{capital(schema.title ?? words(name))}</legend>
      {remove ? (
        <button
          type="button"
          class="quiet group-remove"
          onClick={remove}
          aria-label={`Remove ${words(name)}`}
        >
          <Icon name="close" /> Remove
        </button>
      ) : null}
      {schema.description ? <p class="help">{schema.description}</p> : null}
      <FieldFaults pointer={pointer} />
      {children}
    </fieldset>
  );
}

/**
 * A part that has a default would come back by itself; only a truly optional one can be taken out.
 */
function removal({ required, schema, change }: FieldProps): (() => void) | undefined {
  return required || schema.default !== undefined ? undefined : () => change(undefined);
}

/** What a part begins with; the list of sensors with a row for each sensor of the data. */
function beginning(pointer: string, schema: Schema, { root, sensorIds }: FormScope): unknown {
  if (pointer !== SENSORS || !sensorIds.length) return initial(schema, root);
  return sensorIds
    .slice(0, schema.maxItems)
    .map((sensor_id) => ({ ...emptyItem(schema, root), sensor_id }));
}

function emptyItem(list: Schema, root: Schema): JsonObject {
  const item = initial(list.items ?? {}, root);
  return isObject(item) ? item : {};
}

const SENSORS = "/sensors";

/** The next entry of a list; of the list of sensors, the first that has none. */
function nextItem(
  { pointer, schema }: FieldProps,
  items: unknown[],
  { root, sensorIds }: FormScope,
): unknown {
  const item = initial(schema.items ?? {}, root);
  const left = sensorIds.find(
    (id) => !items.some((known) => isObject(known) && known.sensor_id === id),
  );
  return pointer === SENSORS && left && isObject(item) ? { ...item, sensor_id: left } : item;
}

/** What an entry is called: a sensor by its name. */
function itemName(list: string, item: unknown, index: number): string {
  const one = words(list).replace(/s$/, "");
  return isObject(item) && typeof item.sensor_id === "string" && item.sensor_id
    ? `${one} ${item.sensor_id}`
    : `${one} ${index + 1}`;
}

/** An optional part that is not in the request: one button that puts it there. */
function Absent({ name, schema, pointer, change }: FieldProps): JSX.Element {
  const scope = useScope();
  return (
    <div class="absent" id={fieldId(pointer)} tabIndex={-1}>
      <button type="button" class="quiet" onClick={() => change(beginning(pointer, schema, scope))}>
        <Icon name="plus" /> {capital(schema.title ?? words(name))}
      </button>
      <span class="help">{schema.description ?? ""}</span>
      <FieldFaults pointer={pointer} />
    </div>
  );
}

interface FieldsProps {
  schema: Schema;
  value: JsonObject;
  pointer: string;
  change: (value: JsonObject) => void;
  /** The tag of a union is not a field of its own: `head` shows it. */
  tag?: string;
  head?: ComponentChildren;
}

/** The fields of an object, in the order of the schema. */
export function Fields({ schema, value, pointer, change, tag, head }: FieldsProps): JSX.Element {
  const set = (name: string) => (to: unknown) => {
    const next = { ...value };
    if (to === undefined) delete next[name];
    else next[name] = to;
    change(next);
  };
  const names = Object.keys(schema.properties ?? {}).filter((name) => name !== tag);
  return (
    <div class="fields">
      {head}
      {names.map((name) => (
        <Field
          key={name}
          name={name}
          schema={schema.properties?.[name] ?? {}}
          value={value[name]}
          pointer={childPointer(pointer, name)}
          required={schema.required?.includes(name) ?? false}
          change={set(name)}
        />
      ))}
    </div>
  );
}

export function ObjectField(props: FieldProps): JSX.Element {
  if (!isObject(props.value)) return <Absent {...props} />;
  return (
    <Group {...props} remove={removal(props)}>
      <Fields
        schema={props.schema}
        value={props.value}
        pointer={props.pointer}
        change={props.change}
      />
    </Group>
  );
}

export function UnionField(props: FieldProps): JSX.Element {
  const { root, faults } = useScope();
  if (!isObject(props.value)) return <Absent {...props} />;
  const value = props.value;
  const all = variants(props.schema, root);
  const tag = all[0]?.tag ?? "";
  const chosen = all.find((variant) => variant.value === value[tag]);
  const pick = (event: TargetedEvent<HTMLSelectElement>) => {
    const next = all.find((variant) => variant.value === event.currentTarget.value);
    if (next) props.change(variantValue(next, root));
  };
  const pointer = childPointer(props.pointer, tag);
  const faulty = (faults.get(pointer) ?? []).length > 0;
  const head = (
    <div class={faulty ? "field faulty" : "field"}>
      <label for={fieldId(pointer)}>{words(tag)}</label>
      <div class="field-input">
        <select
          id={fieldId(pointer)}
          data-pointer={pointer}
          value={chosen?.value ?? ""}
          onChange={pick}
          aria-invalid={faulty || undefined}
          aria-describedby={faulty ? `${fieldId(pointer)}-fault` : undefined}
        >
          {chosen ? null : <option value="">choose…</option>}
          {all.map((variant) => (
            <option value={variant.value}>{words(variant.value)}</option>
          ))}
        </select>
      </div>
      {chosen?.schema.description ? <p class="help">{chosen.schema.description}</p> : null}
      <FieldFaults pointer={pointer} />
    </div>
  );
  return (
    <Group {...props} remove={removal(props)}>
      <Fields
        schema={chosen?.schema ?? {}}
        value={value}
        pointer={props.pointer}
        change={props.change}
        tag={tag}
        head={head}
      />
    </Group>
  );
}

export function ListField(props: FieldProps): JSX.Element {
  const scope = useScope();
  if (!Array.isArray(props.value)) return <Absent {...props} />;
  const items: unknown[] = props.value;
  const item = props.schema.items ?? {};
  const set = (at: number) => (to: unknown) =>
    props.change(to === undefined ? items.filter((_, index) => index !== at) : items.with(at, to));
  const full = items.length >= (props.schema.maxItems ?? Infinity);
  return (
    <Group {...props} remove={removal(props)}>
      {items.slice(0, LIST_SHOWN).map((value, index) => (
        <Field
          key={index}
          name={itemName(props.name, value, index)}
          schema={item}
          value={value}
          pointer={childPointer(props.pointer, index)}
          required={false}
          change={set(index)}
        />
      ))}
      {items.length > LIST_SHOWN ? (
        <p class="help">
          {items.length - LIST_SHOWN} more entries; the JSON editor shows them all.
        </p>
      ) : null}
      <button
        type="button"
        class="quiet"
        disabled={full}
        onClick={() => props.change([...items, nextItem(props, items, scope)])}
      >
        <Icon name="plus" /> Add
      </button>
    </Group>
  );
}

/** A free map of short texts, one `key = value` a line. */
export function TextMapField({ name, schema, value, pointer, change }: FieldProps): JSX.Element {
  const text = Object.entries(isObject(value) ? value : {})
    .map(([key, entry]) => `${key} = ${String(entry)}`)
    .join("\n");
  const read = (event: TargetedEvent<HTMLTextAreaElement>) => {
    const lines = event.currentTarget.value.split("\n").filter((line) => line.trim() !== "");
    const entries = lines.map(
      (line) =>
        [line.split("=")[0]?.trim() ?? "", line.split("=").slice(1).join("=").trim()] as const,
    );
    change(entries.length ? Object.fromEntries(entries) : undefined);
  };
  return (
    <div class="field">
      <label for={fieldId(pointer)}>
        {schema.title ?? words(name)} <span class="muted">optional</span>
      </label>
      <div class="field-input">
        <textarea
          id={fieldId(pointer)}
          data-pointer={pointer}
          rows={2}
          value={text}
          placeholder="key = value"
          onChange={read}
        />
      </div>
      {schema.description ? <p class="help">{schema.description}</p> : null}
      <FieldFaults pointer={pointer} />
    </div>
  );
}
