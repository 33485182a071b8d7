// The plain inputs. They do not judge: what a person typed goes to the service, and its faults come
// back to the field.

import type { JSX, TargetedEvent } from "preact";
import { useEffect, useState } from "preact/hooks";
import { type FieldProps, useFaults } from "./context";
import { allowedText, fieldId } from "./schema";

export function useAria(pointer: string): Record<string, string | boolean | undefined> {
  const id = fieldId(pointer);
  const faulty = useFaults(pointer).length > 0;
  return {
    id,
    "aria-invalid": faulty || undefined,
    "aria-describedby": faulty ? `${id}-fault` : `${id}-help`,
    "data-pointer": pointer,
  };
}

function asNumber(text: string): unknown {
  const trimmed = text.trim();
  if (trimmed === "") return undefined;
  const value = Number(trimmed);
  return Number.isFinite(value) ? value : trimmed;
}

export function NumberInput({ schema, value, pointer, change }: FieldProps): JSX.Element {
  const [text, setText] = useState(value === undefined || value === null ? "" : String(value));
  useEffect(() => {
    if (asNumber(text) !== value)
      setText(value === undefined || value === null ? "" : String(value));
  }, [value]);
  const type = (event: TargetedEvent<HTMLInputElement>) => {
    setText(event.currentTarget.value);
    change(asNumber(event.currentTarget.value));
  };
  const hint = allowedText(schema);
  const fallback = schema.default === undefined ? hint : String(schema.default);
  return (
    <input
      {...useAria(pointer)}
      type="text"
      inputMode="decimal"
      autocomplete="off"
      class="number"
      value={text}
      placeholder={fallback}
      title={hint}
      onInput={type}
    />
  );
}

export function TextInput({ schema, value, pointer, required, change }: FieldProps): JSX.Element {
  const list = schema.type === "array";
  const text = list
    ? Array.isArray(value)
      ? value.join(", ")
      : ""
    : typeof value === "string"
      ? value
      : "";
  const type = (event: TargetedEvent<HTMLInputElement>) => {
    const typed = event.currentTarget.value;
    if (typed === "" && !required) change(undefined);
    else change(list ? typed.split(",").map((part) => part.trim()) : typed);
  };
  return (
    <input
      {...useAria(pointer)}
      type="text"
      autocomplete="off"
      value={text}
      placeholder={list ? "separated by commas" : undefined}
      onChange={list ? type : undefined}
      onInput={list ? undefined : type}
    />
  );
}

export function ChoiceInput({ schema, value, pointer, required, change }: FieldProps): JSX.Element {
  const pick = (event: TargetedEvent<HTMLSelectElement>) =>
    change(event.currentTarget.value === "" ? undefined : event.currentTarget.value);
  return (
    <select {...useAria(pointer)} value={typeof value === "string" ? value : ""} onChange={pick}>
      {required && value !== undefined ? null : (
        <option value="">
          {typeof schema.default === "string" ? `${schema.default} (default)` : "not set"}
        </option>
      )}
      {(schema.enum ?? []).map((choice) => (
        <option value={choice}>{choice}</option>
      ))}
    </select>
  );
}

export function FlagInput({ schema, value, pointer, change }: FieldProps): JSX.Element {
  return (
    <input
      {...useAria(pointer)}
      type="checkbox"
      checked={(value ?? schema.default) === true}
      onChange={(event) => change(event.currentTarget.checked)}
    />
  );
}
