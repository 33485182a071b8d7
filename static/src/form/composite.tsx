// Fields made of fields: objects, unions told apart by a select, lists, maps of text.

import type { ComponentChildren, JSX, TargetedEvent } from "preact";
import { Icon } from "../components/basics";
import { capital, words } from "../format";
import { useScope, type FieldProps } from "./context";
import { Field, FieldFaults } from "./field";
import { childPointer, fieldId, initial, isObject, variants, variantValue, type JsonObject } from "./schema";
import type { Schema } from "../api/types";

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
        <button type="button" class="quiet group-remove" onClick={remove} aria-label={`Remove ${words(name)}`}>
          <Icon name="close" /> Remove
        </button>
      ) : null}
      {schema.description ? <p class="help">{schema.description}</p> : null}
      <FieldFaults pointer={pointer} />
      {children}
    </fieldset>
  );
}

/** A part that has a default would come back by itself; only a truly optional one can be taken out. */
function removal({ required, schema, change }: FieldProps): (() => void) | undefined {
  return required || schema.default !== undefined ? undefined : () => change(undefined);
}

/** An optional part that is not in the request: one button that puts it there. */
function Absent({ name, schema, pointer, change }: FieldProps): JSX.Element {
  const { root } = useScope();
  return (
    <div class="absent" id={fieldId(pointer)} tabIndex={-1}>
      <button type="button" class="quiet" onClick={() => change(initial(schema, root))}>
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
      <Fields schema={props.schema} value={props.value} pointer={props.pointer} change={props.change} />
    </Group>
  );
}

export function UnionField(props: FieldProps): JSX.Element {
  const { root } = useScope();
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
  const head = (
    <div class="field">
      <label for={fieldId(pointer)}>{words(tag)}</label>
      <div class="field-input">
        <select id={fieldId(pointer)} data-pointer={pointer} value={chosen?.value ?? ""} onChange={pick}>
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
      <Fields schema={chosen?.schema ?? {}} value={value} pointer={props.pointer} change={props.change} tag={tag} head={head} />
    </Group>
  );
}

export function ListField(props: FieldProps): JSX.Element {
  const { root } = useScope();
  if (!Array.isArray(props.value)) return <Absent {...props} />;
  const items: unknown[] = props.value;
  const item = props.schema.items ?? {};
  const set = (at: number) => (to: unknown) => props.change(to === undefined ? items.filter((_, index) => index !== at) : items.with(at, to));
  const full = items.length >= (props.schema.maxItems ?? Infinity);
  return (
    <Group {...props} remove={removal(props)}>
      {items.slice(0, LIST_SHOWN).map((value, index) => (
        <Field key={index} name={`${words(props.name).replace(/s$/, "")} ${index + 1}`} schema={item} value={value} pointer={childPointer(props.pointer, index)} required={false} change={set(index)} />
      ))}
      {items.length > LIST_SHOWN ? <p class="help">{items.length - LIST_SHOWN} more entries; the JSON editor shows them all.</p> : null}
      <button type="button" class="quiet" disabled={full} onClick={() => props.change([...items, initial(item, root)])}>
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
    const entries = lines.map((line) => [line.split("=")[0]?.trim() ?? "", line.split("=").slice(1).join("=").trim()] as const);
    change(entries.length ? Object.fromEntries(entries) : undefined);
  };
  return (
    <div class="field">
      <label for={fieldId(pointer)}>
        {schema.title ?? words(name)} <span class="muted">optional</span>
      </label>
      <div class="field-input">
        <textarea id={fieldId(pointer)} data-pointer={pointer} rows={2} value={text} placeholder="key = value" onChange={read} />
      </div>
      {schema.description ? <p class="help">{schema.description}</p> : null}
      <FieldFaults pointer={pointer} />
    </div>
  );
}
