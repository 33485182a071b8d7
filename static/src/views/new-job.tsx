// A new job: start from a preset or from nothing, change it in a form made from the service's schema or as JSON,
// see the service's own faults at the fields, submit.

import { useSignal, type Signal } from "@preact/signals";
import type { JSX, TargetedEvent } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { ApiError, createJob, getJob, getMethods, getSpec, listPresets, validate } from "../api/client";
import type { Fault, JobKind, Methods, Preset, Schema, Validation } from "../api/types";
import { asProblem, FaultText, Icon, Link, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { Fields } from "../form/composite";
import { FormContext } from "../form/context";
import { fieldId, initial, isObject, resolve, type JsonObject } from "../form/schema";
import { bytes, capital, count, duration } from "../format";
import { go, hereHref, pageHref, param, setParams } from "../state/url";

/** Where to begin without a preset; `parts` are optional fields that most such requests need. */
const BLANK: { kind: JobKind; summary: string; parts: string[] }[] = [
  { kind: "simulate", summary: "Play a scene: make detections and truth.", parts: [] },
  { kind: "associate", summary: "Turn detections into tracks.", parts: [] },
  { kind: "evaluate", summary: "Associate and judge against the truth, or judge tracks you already have.", parts: ["input", "truth", "associator", "filter", "tracker"] },
  { kind: "campaign", summary: "Run a job many times over a grid of its parameters.", parts: [] },
  { kind: "correlate", summary: "Put the tracks of several sensors together that are of one target, and fuse them.", parts: ["input"] },
  { kind: "group", summary: "Put together what several sensors report of one target.", parts: [] },
];
const VALIDATE_AFTER_MS = 300;

export function NewJob(): JSX.Element {
  const from = param("from");
  const catalogue = useResource(() => Promise.all([getMethods(), listPresets(), from ? jobAsStart(from) : undefined]), [from]);
  if (catalogue.error) return <ProblemBox error={catalogue.error} retry={catalogue.reload} />;
  if (!catalogue.data) return <Loading what="the catalogue" />;
  const [methods, presets, former] = catalogue.data;
  const preset = former ?? presets.find((entry) => entry.name === param("preset"));
  const kind = preset?.kind ?? BLANK.find((entry) => entry.kind === param("kind"))?.kind;
  return (
    <section>
      <h1>New job</h1>
      {kind ? <Editor key={preset?.name ?? kind} kind={kind} start={preset} methods={methods} /> : <Choices presets={presets} />}
    </section>
  );
}

interface Start extends Preset {
  /** Why the request failed before. */
  failure?: ApiError;
}

/** An earlier job as the beginning of a new one, with the faults it failed on. */
async function jobAsStart(id: string): Promise<Start> {
  const [job, body] = await Promise.all([getJob(id), getSpec(id)]);
  const label = { ...(job.name ? { name: job.name } : {}), ...(Object.keys(job.labels).length ? { labels: job.labels } : {}) };
  const start = { name: `from ${job.name || id}`, summary: `The request of job ${id}.`, kind: job.kind, body: { ...body, ...label } };
  return job.error ? { ...start, failure: new ApiError(job.error) } : start;
}

function Card({ title, kind, summary, href }: { title: string; kind: string; summary: string; href: string }): JSX.Element {
  return (
    <li>
      <Link class="card" href={href}>
        <span class="card-title">{title}</span>
        <span class="card-kind">{kind}</span>
        <span class="card-text">{summary}</span>
      </Link>
    </li>
  );
}

function Choices({ presets }: { presets: Preset[] }): JSX.Element {
  return (
    <>
      <h2>From a preset</h2>
      <ul class="cards">
        {presets.map((preset) => (
          <Card title={preset.name} kind={preset.kind} summary={preset.summary} href={hereHref({ preset: preset.name })} />
        ))}
      </ul>
      <h2>From your own data or scene</h2>
      <ul class="cards">
        {BLANK.map(({ kind, summary }) => (
          <Card title={capital(kind)} kind={kind} summary={summary} href={hereHref({ kind })} />
        ))}
      </ul>
    </>
  );
}

function blank(kind: JobKind, root: Schema): JsonObject {
  const value = initial(root, root) as JsonObject;
  for (const part of BLANK.find((entry) => entry.kind === kind)?.parts ?? []) {
    const field = root.properties?.[part];
    if (field && value[part] === undefined) value[part] = initial(field, root);
  }
  return value;
}

function useValidation(kind: JobKind, spec: Signal<JsonObject>): Signal<Validation | undefined> {
  const result = useSignal<Validation | undefined>(undefined);
  useEffect(() => {
    let current = true;
    const timer = window.setTimeout(() => {
      validate(kind, spec.value).then(
        (answer) => current && (result.value = answer),
        (error: unknown) => current && (result.value = asFaults(error)),
      );
    }, VALIDATE_AFTER_MS);
    return () => {
      current = false;
      window.clearTimeout(timer);
    };
  }, [spec.value]);
  return result;
}

function asFaults(error: unknown): Validation {
  const problem = asProblem(error);
  const whole: Fault = { pointer: "", code: problem.code, detail: problem.detail ?? problem.title };
  return { valid: false, errors: problem.errors?.length ? problem.errors : [whole], warnings: [] };
}

/** The request itself may be a reference into its definitions. */
function requestSchema(schema: Schema): Schema {
  return { ...resolve(schema, schema), ...(schema.$defs ? { $defs: schema.$defs } : {}) };
}

function byPointer(faults: Fault[]): Map<string, Fault[]> {
  const map = new Map<string, Fault[]>();
  for (const fault of faults) map.set(fault.pointer, [...(map.get(fault.pointer) ?? []), fault]);
  return map;
}

function Editor({ kind, start, methods }: { kind: JobKind; start: Start | undefined; methods: Methods }): JSX.Element {
  const root = useMemo(() => requestSchema(methods.requests[kind]), [methods, kind]);
  const spec = useSignal<JsonObject>(start ? { ...start.body } : blank(kind, root));
  const validation = useValidation(kind, spec);
  const failure = useSignal<unknown>(start?.failure);
  const busy = useSignal(false);
  const asJson = param("as") === "json";
  const submit = async () => {
    busy.value = true;
    failure.value = undefined;
    try {
      const job = await createJob(kind, spec.value);
      go(pageHref({ view: "job", job: job.id }));
    } catch (error) {
      if (error instanceof ApiError && error.problem.errors?.length) validation.value = asFaults(error);
      else failure.value = error;
    } finally {
      busy.value = false;
    }
  };
  return (
    <>
      <p class="crumbs">
        <Link href={pageHref({ view: "new" })}>All presets</Link> <span class="muted">/</span> {start?.name ?? capital(kind)}
        <span class="muted"> · {kind}</span>
      </p>
      {start ? <p class="lead">{start.summary}</p> : null}
      <div class="tabs" role="tablist" aria-label="How to edit">
        {["form", "json"].map((mode) => (
          <button type="button" role="tab" aria-selected={asJson === (mode === "json")} onClick={() => setParams({ as: mode === "json" ? "json" : null })}>
            {mode === "json" ? "JSON" : "Form"}
          </button>
        ))}
      </div>
      <div class="editor">
        <div class="editor-main">
          {asJson ? (
            <JsonEditor spec={spec} />
          ) : (
            <FormContext.Provider value={{ root, faults: byPointer(validation.value?.errors ?? []) }}>
              <form class="schema-form" onSubmit={(event) => event.preventDefault()}>
                <Fields schema={root} value={spec.value} pointer="" change={(value) => (spec.value = value)} />
              </form>
            </FormContext.Provider>
          )}
        </div>
        <aside class="editor-side" aria-label="Check and submit">
          <Check validation={validation.value} asJson={asJson} />
          {failure.value ? <ProblemBox error={failure.value} /> : null}
          <button type="button" class="primary wide" disabled={busy.value} onClick={() => void submit()}>
            {busy.value ? "Submitting…" : `Submit ${kind} job`}
          </button>
        </aside>
      </div>
    </>
  );
}

function showField(pointer: string): void {
  const field = document.getElementById(fieldId(pointer));
  field?.scrollIntoView({ block: "center" });
  field?.focus();
}

function Check({ validation, asJson }: { validation: Validation | undefined; asJson: boolean }): JSX.Element {
  if (!validation) return <p class="muted">Checking…</p>;
  if (validation.valid) {
    const estimate = validation.estimate;
    return (
      <div class="check ok" role="status">
        <p>
          <Icon name="succeeded" /> The request is valid.
        </p>
        {estimate ? (
          <dl class="facts">
            {estimate.detections ? <Fact name="Detections" value={`about ${count(estimate.detections)}`} /> : null}
            {estimate.cost_s ? <Fact name="Cost" value={`about ${duration(estimate.cost_s)}`} /> : null}
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
  return (
    <div class="check bad" role="status">
      <p>
        <Icon name="failed" /> {validation.errors.length === 1 ? "One fault" : `${validation.errors.length} faults`}
      </p>
      <ul class="faults">
        {validation.errors.map((fault) => (
          <li>
            {asJson || fault.pointer === "" ? (
              <code>{fault.pointer || "/"}</code>
            ) : (
              <button type="button" class="link mono" onClick={() => showField(fault.pointer)}>
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

/** The same request as text; what parses goes straight into the form. */
function JsonEditor({ spec }: { spec: Signal<JsonObject> }): JSX.Element {
  const text = useSignal(JSON.stringify(spec.peek(), null, 2));
  const fault = useSignal("");
  const type = (event: TargetedEvent<HTMLTextAreaElement>) => {
    text.value = event.currentTarget.value;
    try {
      const value: unknown = JSON.parse(text.value);
      if (!isObject(value)) throw new Error("the request must be an object");
      fault.value = "";
      spec.value = value;
    } catch (error) {
      fault.value = error instanceof Error ? error.message : String(error);
    }
  };
  return (
    <div class="json-editor">
      <label for="json-text" class="visually-hidden">
        Request as JSON
      </label>
      <textarea id="json-text" class="mono" spellcheck={false} rows={32} value={text.value} onInput={type} aria-invalid={fault.value !== "" || undefined} />
      {fault.value ? (
        <p class="field-fault" role="alert">
          Not JSON yet: {fault.value}
        </p>
      ) : null}
    </div>
  );
}
