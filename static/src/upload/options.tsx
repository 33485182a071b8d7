// What only some files need to be told: a form made from the description of the API. Fields that
// the service asks for, or that are told already, stand in front; the others unfold.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Fault, Schema } from "../api/types";
import { Fields } from "../form/composite";
import { FormContext } from "../form/context";
import type { JsonObject } from "../form/schema";
import { META, OPTIONS } from "./meta";

interface OptionsProps {
  /** Pointers of the fields begin with it, so that two forms of a page differ. */
  id: string;
  meta: JsonObject;
  /** Names of the fields that stand in front. */
  inFront: string[];
  /** Whether columns are told in a table of their own. */
  hasHead: boolean;
  /** By the pointer within the meta. */
  faults: Map<string, Fault[]>;
  change: (meta: JsonObject) => void;
}

/** The description of some fields alone. */
function only(names: string[]): Schema {
  const properties = Object.entries(META.properties ?? {}).filter(([name]) => names.includes(name));
  return { ...META, properties: Object.fromEntries(properties) };
}

export function Options(props: OptionsProps): JSX.Element {
  const { id, meta, inFront, hasHead, change } = props;
  const [open, setOpen] = useState(false);
  const faults = new Map([...props.faults].map(([pointer, list]) => [`/${id}${pointer}`, list]));
  const names = hasHead ? OPTIONS : ["columns", ...OPTIONS];
  const front = names.filter((name) => inFront.includes(name));
  const others = names.filter((name) => !inFront.includes(name));
  const fields = (of: string[]) => (
    <Fields schema={only(of)} value={meta} pointer={`/${id}`} change={change} />
  );
  return (
    <FormContext.Provider value={{ root: META, faults, sensorIds: [] }}>
      <div class="options">
        {front.length ? fields(front) : null}
        <details open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
          <summary>{front.length ? "More options" : "Options"}</summary>
          {open ? fields(others) : null}
        </details>
      </div>
    </FormContext.Provider>
  );
}
