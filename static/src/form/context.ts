// What every field of a form must know of the whole: the schema's definitions and the faults the
// service found.

import { createContext } from "preact";
import { useContext } from "preact/hooks";
import type { Fault, Schema } from "../api/types";

export interface FormScope {
  root: Schema;
  faults: Map<string, Fault[]>;
  /** Of the data set that the request reads. */
  sensorIds: string[];
}

export const FormContext = createContext<FormScope>({ root: {}, faults: new Map(), sensorIds: [] });

export function useScope(): FormScope {
  return useContext(FormContext);
}

export function useFaults(pointer: string): Fault[] {
  return useScope().faults.get(pointer) ?? [];
}

export interface FieldProps {
  name: string;
  schema: Schema;
  value: unknown;
  pointer: string;
  required: boolean;
  /** `undefined` takes the field out of the request. */
  change: (value: unknown) => void;
}
