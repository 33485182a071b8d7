// What the service says of a request as it stands: valid with what that leaves open, or its faults.
// One box, never two.

import type { JSX } from "preact";
import type { ApiError } from "../api/client";
import type { Fault, Validation } from "../api/types";
import { asProblem, FaultText, Icon, ProblemBox } from "../components/basics";
import { fieldId, isObject, type JsonObject, shownPointer } from "../form/schema";
import { bytes, count, duration } from "../format";

/** An answer, and the request that it is of. */
export interface Checked {
  of: JsonObject;
  validation: Validation;
}

/** A failure of a job or of its submission, and the request that failed. */
export interface Failed {
  of: JsonObject;
  error: ApiError | unknown;
  /** It was a job that failed, not its submission. */
  before: boolean;
}

export function asFaults(error: unknown): Validation {
  const problem = asProblem(error);
  const whole: Fault = { pointer: "", code: problem.code, detail: problem.detail ?? problem.title };
  return { valid: false, errors: problem.errors?.length ? problem.errors : [whole], warnings: [] };
}

/**
 * Everything that is wrong with the request: what the check found, and what the same request failed
 * on.
 */
export function faultsOf(checked: Checked | undefined, failed: Failed | undefined): Fault[] {
  const all = [
    ...(failed ? (asProblem(failed.error).errors ?? []) : []),
    ...(checked?.validation.errors ?? []),
  ];
  const known = new Set<string>();
  return all.filter(({ pointer, detail }) => {
    const key = `${pointer}\u0000${detail}`;
    return known.has(key) ? false : known.add(key);
  });
}

export function showField(pointer: string): void {
  const field = document.getElementById(fieldId(pointer));
  field?.scrollIntoView({ block: "center" });
  field?.focus();
}

/** Whether a part of the request reads a data set or the output of a job. */
function reads(value: unknown, key: string): boolean {
  if (Array.isArray(value)) return value.some((item) => reads(item, key));
  if (!isObject(value)) return false;
  return (
    (typeof value[key] === "string" && value[key] !== "") ||
    Object.values(value).some((item) => reads(item, key))
  );
}

/** What the check does not look at. */
function notChecked(spec: JsonObject): string | undefined {
  if (reads(spec, "job_id"))
    return "Not checked: what the other job leaves. A fault in it fails this job when it runs.";
  return reads(spec, "dataset_id")
    ? "Not checked: the rows of the data. A fault in them fails the job when it runs."
    : undefined;
}

interface CheckProps {
  spec: JsonObject;
  checked: Checked | undefined;
  failed: Failed | undefined;
  asJson: boolean;
}

export function RequestCheck({ spec, checked, failed, asJson }: CheckProps): JSX.Element {
  const faults = faultsOf(checked, failed);
  if (failed && !faults.length) return <ProblemBox error={failed.error} />;
  if (faults.length)
    return <Faults faults={faults} spec={spec} asJson={asJson} before={failed?.before ?? false} />;
  return checked?.of === spec ? (
    <Valid validation={checked.validation} note={notChecked(spec)} />
  ) : (
    <p class="muted">Checking…</p>
  );
}

function Valid({
  validation,
  note,
}: {
  validation: Validation;
  note: string | undefined;
}): JSX.Element {
  const { estimate } = validation;
  return (
    <div class="check ok" role="status">
      <p>
        <Icon name="succeeded" /> The request is valid.
      </p>
      {note ? <p class="muted small">{note}</p> : null}
      {estimate ? (
        <dl class="facts">
          {estimate.detections ? (
            <Fact name="Detections" value={`about ${count(estimate.detections)}`} />
          ) : null}
          {estimate.cost_s ? (
            <Fact name="Cost" value={`about ${duration(estimate.cost_s)}`} />
          ) : null}
          {estimate.bytes ? <Fact name="Stored" value={`about ${bytes(estimate.bytes)}`} /> : null}
        </dl>
      ) : null}
      {validation.warnings.map((warning) => (
        <p class="warning-text">
          <Icon name="warning" /> {warning}
        </p>
      ))}
    </div>
  );
}

interface FaultsProps {
  faults: Fault[];
  spec: JsonObject;
  asJson: boolean;
  before: boolean;
}

function Faults({ faults, spec, asJson, before }: FaultsProps): JSX.Element {
  const head = faults.length === 1 ? "One fault" : `${faults.length} faults`;
  return (
    <div class="check bad" role="status">
      <p>
        <Icon name="failed" /> {head}
      </p>
      {before ? <p class="small">The job of this very request failed on them.</p> : null}
      <ul class="faults">
        {faults.map((fault) => (
          <li>
            {asJson || fault.pointer === "" ? (
              <code>{fault.pointer || "/"}</code>
            ) : (
              <button
                type="button"
                class="link mono"
                onClick={() => showField(shownPointer(fault.pointer, spec))}
              >
                {fault.pointer}
              </button>
            )}{" "}
            <FaultText fault={fault} />
          </li>
        ))}
      </ul>
    </div>
  );
}

function Fact({ name, value }: { name: string; value: string }): JSX.Element {
  return (
    <>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </>
  );
}
