// One field of a form made from a schema: picks the right input, and wraps it in its label, unit,
// help and faults.

import type { ComponentChildren, JSX } from "preact";
import { FaultText } from "../components/basics";
import { words } from "../format";
import { ListField, ObjectField, TextMapField, UnionField } from "./composite";
import { type FieldProps, useFaults, useScope } from "./context";
import { ChoiceInput, FlagInput, NumberInput, TextInput } from "./inputs";
import { DatasetPicker, JobPicker } from "./pickers";
import { fieldId, resolve, variants } from "./schema";

export function Field(props: FieldProps): JSX.Element {
  const { root } = useScope();
  const schema = resolve(props.schema, root);
  const inner = { ...props, schema };
  if (variants(schema, root).length) return <UnionField {...inner} />;
  if (schema.type === "object")
    return schema.properties ? <ObjectField {...inner} /> : <TextMapField {...inner} />;
  if (schema.type === "array" && resolve(schema.items ?? {}, root).type !== "string")
    return <ListField {...inner} />;
  return <Labelled {...inner}>{input(inner)}</Labelled>;
}

function input(props: FieldProps): JSX.Element {
  if (props.name === "dataset_id") return <DatasetPicker {...props} />;
  if (props.name === "job_id") return <JobPicker {...props} />;
  if (props.schema.type === "boolean") return <FlagInput {...props} />;
  if (props.schema.type === "number" || props.schema.type === "integer")
    return <NumberInput {...props} />;
  return props.schema.enum ? <ChoiceInput {...props} /> : <TextInput {...props} />;
}

export function FieldFaults({ pointer }: { pointer: string }): JSX.Element | null {
  const faults = useFaults(pointer);
  if (!faults.length) return null;
  return (
    <p class="field-fault" id={`${fieldId(pointer)}-fault`} role="alert">
      {faults.map((fault) => (
        <span>
          <FaultText fault={fault} />
        </span>
      ))}
    </p>
  );
}

function Labelled({
  name,
  schema,
  pointer,
  required,
  children,
}: FieldProps & { children: ComponentChildren }): JSX.Element {
  const id = fieldId(pointer);
  const faulty = useFaults(pointer).length > 0;
  return (
    <div class={faulty ? "field faulty" : "field"}>
      <label for={id} title={name}>
        {schema.title ?? words(name)}
        {required || schema.default !== undefined ? null : <span class="muted"> optional</span>}
      </label>
      <div class="field-input">
        {children}
        {schema["x-unit"] ? <span class="unit">{schema["x-unit"]}</span> : null}
      </div>
      {schema.description ? (
        <p class="help" id={`${id}-help`}>
          {schema.description}
        </p>
      ) : null}
      <FieldFaults pointer={pointer} />
    </div>
  );
}
