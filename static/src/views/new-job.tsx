// A new job: start from a preset or from nothing, change it in a form made from the service's
// schema or as JSON, see the service's own faults at the fields, submit.

import { type Signal, useSignal } from "@preact/signals";
import type { JSX, TargetedEvent } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import {
  ApiError,
  createJob,
  getDataset,
  getJob,
  getMethods,
  getSpec,
  listPresets,
  validate,
} from "../api/client";
import type { Fault, JobKind, Methods, Preset, Schema, Validation } from "../api/types";
import { asProblem, Link, Loading, ProblemBox } from "../components/basics";
import { useResource } from "../components/resource";
import { Fields } from "../form/composite";
import { FormContext } from "../form/context";
import { initial, isObject, type JsonObject, resolve, shownPointer } from "../form/schema";
import { capital } from "../format";
import { go, hereHref, pageHref, param, setParams } from "../state/url";
import {
  asFaults,
  type Checked,
  type Failed,
  faultsOf,
  RequestCheck,
  showField,
} from "./request-check";

/** Where to begin without a preset; `parts` are optional fields that most such requests need. */
const BLANK: { kind: JobKind; summary: string; parts: string[] }[] = [
  { kind: "simulate", summary: "Play a scene: make detections and truth.", parts: [] },
  { kind: "associate", summary: "Turn detections into tracks.", parts: [] },
  {
    kind: "evaluate",
    summary: "Associate and judge against the truth, or judge tracks you already have.",
    parts: ["input", "truth", "associator", "filter", "tracker"],
  },
  { kind: "campaign", summary: "Run a job many times over a grid of its parameters.", parts: [] },
  {
    kind: "correlate",
    summary: "Put the tracks of several sensors together that are of one target, and fuse them.",
    parts: ["input"],
  },
  { kind: "group", summary: "Put together what several sensors report of one target.", parts: [] },
];
const VALIDATE_AFTER_MS = 300;

export function NewJob(): JSX.Element {
  const from = param("from");
  const catalogue = useResource(
    () => Promise.all([getMethods(), listPresets(), from ? jobAsStart(from) : undefined]),
    [from],
  );
  if (catalogue.error) return <ProblemBox error={catalogue.error} retry={catalogue.reload} />;
  if (!catalogue.data) return <Loading what="the catalogue" />;
  const [methods, presets, former] = catalogue.data;
  const preset =
    former ?? presets.find((entry) => entry.name === param("preset")) ?? proposedStart();
  const kind = preset?.kind ?? BLANK.find((entry) => entry.kind === param("kind"))?.kind;
  return (
    <section>
      <h1>New job</h1>
      {kind ? (
        <Editor key={preset?.name ?? kind} kind={kind} start={preset} methods={methods} />
      ) : (
        <Choices presets={presets} />
      )}
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
  const label = {
    ...(job.name ? { name: job.name } : {}),
    ...(Object.keys(job.labels).length ? { labels: job.labels } : {}),
  };
  const start = {
    name: `from ${job.name || id}`,
    summary: `The request of job ${id}.`,
    kind: job.kind,
    body: { ...body, ...label },
  };
  return job.error ? { ...start, failure: new ApiError(job.error) } : start;
}

/** The job that the address holds, as one that was proposed for a file. */
function proposedStart(): Start | undefined {
  const kind = BLANK.find((entry) => entry.kind === param("kind"))?.kind;
  const body = parsed(param("body"));
  if (!kind || !isObject(body)) return undefined;
  return { name: capital(kind), summary: "A job to start from, made for a file.", kind, body };
}

function parsed(text: string | null): unknown {
  try {
    return JSON.parse(text ?? "");
  } catch {
    return undefined;
  }
}

function Card({
  title,
  kind,
  summary,
  href,
}: {
  title: string;
  kind: string;
  summary: string;
  href: string;
}): JSX.Element {
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
          <Card
            title={preset.name}
            kind={preset.kind}
            summary={preset.summary}
            href={hereHref({ preset: preset.name })}
          />
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

/** Asks the service about the request whenever it changes, also when another data set is chosen. */
function useValidation(kind: JobKind, spec: Signal<JsonObject>): Signal<Checked | undefined> {
  const result = useSignal<Checked | undefined>(undefined);
  useEffect(() => {
    let current = true;
    const of = spec.value;
    const take = (validation: Validation) => {
      if (current) result.value = { of, validation };
    };
    const ask = () => void validate(kind, of).then(take, (error: unknown) => take(asFaults(error)));
    const timer = window.setTimeout(ask, VALIDATE_AFTER_MS);
    return () => {
      current = false;
      window.clearTimeout(timer);
    };
  }, [spec.value]);
  return result;
}

/** The sensors of the data set that a request reads: those that it keeps, or all. */
function useSensorIds(spec: JsonObject): string[] {
  const input = isObject(spec.input) ? spec.input : {};
  const id = typeof input.dataset_id === "string" ? input.dataset_id : "";
  const ids =
    useResource(async () => (id ? (await getDataset(id)).sensor_ids : []), [id]).data ?? [];
  const kept = Array.isArray(input.sensor_ids)
    ? input.sensor_ids.filter((sensor) => sensor !== "")
    : [];
  return kept.length ? ids.filter((sensor) => kept.includes(sensor)) : ids;
}

/** The request itself may be a reference into its definitions. */
function requestSchema(schema: Schema): Schema {
  return { ...resolve(schema, schema), ...(schema.$defs ? { $defs: schema.$defs } : {}) };
}

/** The faults at the fields that show them. */
function byField(faults: Fault[], spec: JsonObject): Map<string, Fault[]> {
  const map = new Map<string, Fault[]>();
  for (const fault of faults) {
    const pointer = shownPointer(fault.pointer, spec);
    map.set(pointer, [...(map.get(pointer) ?? []), fault]);
  }
  return map;
}

function Modes({ asJson }: { asJson: boolean }): JSX.Element {
  return (
    <div class="tabs" role="tablist" aria-label="How to edit">
      {["form", "json"].map((mode) => (
        <button
          type="button"
          role="tab"
          aria-selected={asJson === (mode === "json")}
          onClick={() => setParams({ as: mode === "json" ? "json" : null })}
        >
          {mode === "json" ? "JSON" : "Form"}
        </button>
      ))}
    </div>
  );
}

interface EditorProps {
  kind: JobKind;
  start: Start | undefined;
  methods: Methods;
}

function Editor({ kind, start, methods }: EditorProps): JSX.Element {
  const root = useMemo(() => requestSchema(methods.requests[kind]), [methods, kind]);
  const spec = useSignal<JsonObject>(start ? { ...start.body } : blank(kind, root));
  const checked = useValidation(kind, spec);
  const failure = useSignal<Failed | undefined>(
    start?.failure ? { of: spec.peek(), error: start.failure, before: true } : undefined,
  );
  const busy = useSignal(false);
  const sensorIds = useSensorIds(spec.value);
  const asJson = param("as") === "json";
  // What another request failed on says nothing of this one.
  const failed = failure.value?.of === spec.value ? failure.value : undefined;
  const faults = faultsOf(checked.value, failed);
  const submit = async () => {
    const of = spec.peek();
    busy.value = true;
    failure.value = undefined;
    try {
      const job = await createJob(kind, of);
      go(pageHref({ view: "job", job: job.id }));
    } catch (error) {
      failure.value = { of, error, before: false };
      const first = asProblem(error).errors?.[0];
      if (first && !asJson) requestAnimationFrame(() => showField(shownPointer(first.pointer, of)));
    } finally {
      busy.value = false;
    }
  };
  return (
    <>
      <p class="crumbs">
        <Link href={pageHref({ view: "new" })}>All presets</Link> <span class="muted">/</span>{" "}
        {start?.name ?? capital(kind)}
        <span class="muted"> · {kind}</span>
      </p>
      {start ? <p class="lead">{start.summary}</p> : null}
      <Modes asJson={asJson} />
      <div class="editor">
        <div class="editor-main">
          {asJson ? (
            <JsonEditor spec={spec} />
          ) : (
            <FormContext.Provider value={{ root, faults: byField(faults, spec.value), sensorIds }}>
              <form class="schema-form" onSubmit={(event) => event.preventDefault()}>
                <Fields
                  schema={root}
                  value={spec.value}
                  pointer=""
                  change={(value) => (spec.value = value)}
                />
              </form>
            </FormContext.Provider>
          )}
        </div>
        <aside class="editor-side" aria-label="Check and submit">
          <RequestCheck spec={spec.value} checked={checked.value} failed={failed} asJson={asJson} />
          <button
            type="button"
            class="primary wide"
            disabled={busy.value}
            onClick={() => void submit()}
          >
            {busy.value ? "Submitting…" : `Submit ${kind} job`}
          </button>
        </aside>
      </div>
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
      <textarea
        id="json-text"
        class="mono"
        spellcheck={false}
        rows={32}
        value={text.value}
        onInput={type}
        aria-invalid={fault.value !== "" || undefined}
      />
      {fault.value ? (
        <p class="field-fault" role="alert">
          Not JSON yet: {fault.value}
        </p>
      ) : null}
    </div>
  );
}
