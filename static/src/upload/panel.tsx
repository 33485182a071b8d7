// The form of an upload: the file, what it is told of it, what the service finds in it. The service
// judges; its faults stand at the column or the field that they are of.

import type { JSX, RefObject, TargetedEvent } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Fault } from "../api/types";
import { FaultText, Icon, ProblemBox } from "../components/basics";
import { saveText } from "../components/save";
import { bytes, capital, day, plural } from "../format";
import { go } from "../state/url";
import { useDrop } from "./drop";
import { Found } from "./inspection";
import { jobHref } from "./job-start";
import { Mapping } from "./mapping";
import { columnsOf, FORMATS, KINDS, mappingText, withColumns, withField } from "./meta";
import { Options } from "./options";
import { type Upload, type UploadProps, useUpload } from "./use-upload";

export function Panel(props: UploadProps): JSX.Element {
  const { id, expected, dropped, unlike, done } = props;
  const upload = useUpload(props);
  const { file, head, meta, faults, busy } = upload;
  const place = useRef<HTMLDivElement>(null);
  const isOver = useDrop(([first]) => upload.choose(first), place, dropped === null);
  const { job } = upload.look.found ?? {};
  // A form in a form: what is uploaded there is chosen there.
  const isAlone = dropped !== null;
  const open = () =>
    job && file && upload.send((dataset) => go(jobHref(job, file.name, dataset.id)));
  return (
    <div class={isOver ? "upload over" : "upload"} ref={place}>
      <FileInput id={id} upload={upload} anywhere={isAlone} />
      {["kind", "format"].map((name) => (
        <Choice name={name} upload={upload} values={name === "kind" ? KINDS : FORMATS} />
      ))}
      <button
        type="button"
        class="primary"
        disabled={!file || busy}
        onClick={() => upload.send(done)}
      >
        <Icon name={busy ? "running" : "plus"} /> {busy ? "Uploading…" : "Upload"}
      </button>
      <ReadAs upload={upload} unlike={unlike} />
      {head ? (
        <Mapping
          id={id}
          head={head}
          columns={columnsOf(meta)}
          faults={faults.columns}
          change={(columns) => upload.change(withColumns(meta, columns))}
        />
      ) : null}
      {file ? (
        <>
          <Options
            key={file.name}
            id={id}
            meta={meta}
            inFront={upload.inFront}
            hasHead={head !== undefined}
            faults={faults.fields}
            change={upload.change}
          />
          <MappingFile upload={upload} />
          <Result upload={upload} start={isAlone && expected === undefined ? open : undefined} />
        </>
      ) : null}
    </div>
  );
}

/** A file that was dropped stands in the input, too. */
function useShown(input: RefObject<HTMLInputElement | null>, file: File | undefined): void {
  useEffect(() => {
    const field = input.current;
    if (!field || field.files?.[0] === file) return;
    const files = new DataTransfer();
    if (file) files.items.add(file);
    field.files = files.files;
  }, [file]);
}

interface PartProps {
  upload: Upload;
}

function FileInput(props: PartProps & { id: string; anywhere: boolean }): JSX.Element {
  const { id, upload, anywhere } = props;
  const input = useRef<HTMLInputElement>(null);
  useShown(input, upload.file);
  return (
    <label>
      <span>File, or drop one {anywhere ? "anywhere on the page" : "here"}</span>
      <input
        ref={input}
        type="file"
        data-upload={id}
        onChange={(event) => upload.choose(event.currentTarget.files?.[0])}
      />
    </label>
  );
}

function Choice({ name, upload, values }: PartProps & { name: string; values: string[] }) {
  const { meta, change, faults } = upload;
  const pick = (event: TargetedEvent<HTMLSelectElement>) =>
    change(withField(meta, name, event.currentTarget.value));
  const found = faults.fields.get(`/${name}`) ?? [];
  return (
    <label>
      <span>{capital(name)}</span>
      <select
        value={typeof meta[name] === "string" ? meta[name] : ""}
        aria-invalid={found.length > 0 || undefined}
        onChange={pick}
      >
        <option value="">from the file</option>
        {values.map((value) => (
          <option value={value}>{value}</option>
        ))}
      </select>
      <FieldFault faults={found} />
    </label>
  );
}

function FieldFault({ faults }: { faults: Fault[] }): JSX.Element | null {
  if (!faults.length) return null;
  return (
    <span class="field-fault" role="alert">
      {faults.map((fault) => (
        <span>
          <FaultText fault={fault} />
        </span>
      ))}
    </span>
  );
}

/** Says where columns and options were taken from, and gives them up. */
function ReadAs({ upload, unlike }: PartProps & { unlike: (() => void) | undefined }) {
  const { file, from, adopt } = upload;
  if (!from) return null;
  const drop = () => {
    adopt(undefined);
    unlike?.();
  };
  const on = from.at ? `as with ${from.file} on ${day(from.at)}` : `as ${from.file} says`;
  return (
    <p class="read-as" role="status">
      <span>{file ? `Read ${on}.` : `The next file is read ${on}.`}</span>
      <button type="button" onClick={drop}>
        Drop it
      </button>
    </p>
  );
}

/** Asks for a file. */
function askFile(take: (file: File) => void): void {
  const input = document.createElement("input");
  input.type = "file";
  input.onchange = () => {
    const [file] = input.files ?? [];
    if (file) take(file);
  };
  input.click();
}

function MappingFile({ upload }: PartProps): JSX.Element {
  const { file, meta, load } = upload;
  const name = `${file?.name.replace(/\.\w+$/, "") ?? "file"}-mapping.json`;
  return (
    <p class="row">
      <button type="button" onClick={() => saveText(mappingText(meta), name, "application/json")}>
        <Icon name="download" /> Save the mapping
      </button>
      <button type="button" onClick={() => askFile(load)}>
        Load a mapping
      </button>
    </p>
  );
}

function Result({ upload, start }: PartProps & { start: (() => void) | undefined }): JSX.Element {
  const { file, look, waits, faults, faultCount } = upload;
  const { busy, found } = look;
  return (
    <section class="look" aria-busy={busy}>
      <h2>What the file holds</h2>
      {waits && file ? (
        <p class="row">
          <button type="button" onClick={upload.askLook}>
            Look into it
          </button>
          <span class="muted">The file has {bytes(file.size)}.</span>
        </p>
      ) : null}
      {busy ? (
        <p class="muted" role="status">
          <Icon name="running" /> Looking…
        </p>
      ) : null}
      {faultCount ? (
        <p class="field-fault" role="alert">
          {plural(faultCount, "fault")}, shown above at the column or the option.
        </p>
      ) : null}
      {faults.rest ? <ProblemBox error={faults.rest} /> : null}
      {found ? <Found found={found} start={start} /> : null}
    </section>
  );
}
