// What a person has chosen and told of a file, what the service finds in it, and the upload itself.

import {
  type Dispatch,
  type StateUpdater,
  useEffect,
  useLayoutEffect,
  useRef,
  useState,
} from "preact/hooks";
import { ApiError, getDataset, uploadDataset } from "../api/client";
import type { Dataset } from "../api/types";
import { useResource } from "../components/resource";
import { isObject, type JsonObject } from "../form/schema";
import { askedOptions, countOf, type Placed, placed } from "./faults";
import { type Head, headOf } from "./head";
import { LARGE_BYTES, type Look, useLook } from "./look";
import { keyOf, type Reading, recall, remember } from "./memory";
import { fitting, lasting, sentMeta, withField } from "./meta";

export interface UploadProps {
  id: string;
  /** What the file has to hold, if that is known. */
  expected: Dataset["kind"] | undefined;
  /** A file that fell on the page; `null` where the page takes none, so that this form does. */
  dropped: File | undefined | null;
  /** The data set whose upload says how to read this file. */
  like?: string | undefined;
  /** Gives up to read as that data set. */
  unlike?: () => void;
  done: (dataset: Dataset) => void;
}

interface Chosen {
  file?: File;
  head?: Head | undefined;
  /** What it is remembered under. */
  key?: string;
  /** The names of the columns are known, if there are any. */
  ready?: boolean;
}

export interface Upload {
  file: File | undefined;
  head: Head | undefined;
  meta: JsonObject;
  /** What the meta was taken from. */
  from: Reading | undefined;
  look: Look;
  /** Too large to be looked at unasked. */
  waits: boolean;
  faults: Placed;
  faultCount: number;
  /** Options that the service asked for, or that were told before. */
  inFront: string[];
  busy: boolean;
  choose: (file: File | undefined) => void;
  change: (meta: JsonObject) => void;
  adopt: (reading: Reading | undefined) => void;
  load: (file: File) => void;
  askLook: () => void;
  send: (then: (dataset: Dataset) => void) => void;
}

function own(title: string, detail: string): ApiError {
  return new ApiError({ type: "about:blank", title, status: 0, code: "dashboard", detail });
}

/** How the data set was read, for another file. */
function useLike(id: string | undefined): Reading | undefined {
  const { data } = useResource(async () => (id ? getDataset(id) : undefined), [id]);
  if (!data?.reading) return undefined;
  return { file: data.name, at: data.created_at, meta: lasting(data.reading) };
}

/** Options that were asked for once stay in front: no field moves while somebody types in it. */
function useInFront(asked: string[], set: Dispatch<StateUpdater<string[]>>): void {
  const names = asked.join(" ");
  useEffect(() => {
    if (names) set((before) => [...new Set([...before, ...asked])]);
  }, [names]);
}

async function mappingOf(file: File): Promise<Reading> {
  const said: unknown = await file
    .text()
    .then(JSON.parse)
    .catch(() => undefined);
  if (!isObject(said))
    throw own("Not a mapping", `${file.name} has to be a JSON object with columns and options.`);
  return { file: file.name, meta: said };
}

/** What is told of a file: by hand, by a mapping, or as a file like it was read before. */
function useTold(base: JsonObject) {
  const [meta, setMeta] = useState<JsonObject>(base);
  const [from, setFrom] = useState<Reading>();
  const [inFront, setInFront] = useState<string[]>([]);
  const take = (reading: Reading | undefined, head: Head | undefined): JsonObject => {
    const next = reading ? fitting({ ...reading.meta, ...base }, head) : { ...base };
    setFrom(reading);
    setMeta(next);
    setInFront(Object.keys(next));
    return next;
  };
  return { meta, setMeta, from, inFront, setInFront, take };
}

type Told = ReturnType<typeof useTold>;

interface Failure {
  /** What was told when it failed; with anything else it may not. */
  of: JsonObject;
  error: unknown;
}

/** The file, with the names of its columns; what is known of files like it is told of it. */
function useChosen(told: Told, liked: Reading | undefined, fail: (failure: Failure) => void) {
  const [chosen, setChosen] = useState<Chosen>({});
  const latest = useRef<File>(undefined);
  const { file, head, ready } = chosen;
  const { encoding } = told.meta;
  const choose = async (next: File | undefined) => {
    latest.current = next;
    setChosen(next ? { file: next } : {});
    const nothing = told.take(undefined, undefined);
    if (!next) return;
    try {
      const found = await headOf(next);
      if (latest.current !== next) return;
      const key = keyOf(next.name, found);
      told.take(liked ?? recall(key), found);
      setChosen({ file: next, head: found, key, ready: true });
    } catch {
      const error = own("The file cannot be read", `${next.name} may be a folder, or be gone.`);
      if (latest.current === next) fail({ of: nothing, error });
    }
  };
  useEffect(() => {
    if (liked && ready) told.take(liked, head);
  }, [liked?.file]);
  useEffect(() => {
    if (!file || !ready || !encoding) return;
    const take = (found: Head | undefined) =>
      setChosen((now) => (now.file === file ? { ...now, head: found } : now));
    void headOf(file, encoding).then(take);
  }, [encoding, ready]);
  return { chosen, choose };
}

export function useUpload({ expected, dropped, like }: UploadProps): Upload {
  const told = useTold(expected ? { kind: expected } : {});
  const [failure, setFailure] = useState<Failure>();
  const [busy, setBusy] = useState(false);
  const [asked, setAsked] = useState<File>();
  const liked = useLike(like);
  const { chosen, choose } = useChosen(told, liked, setFailure);
  const { file, head, key = "", ready } = chosen;
  const { meta, from, inFront } = told;
  const wanted = file !== undefined && (file.size <= LARGE_BYTES || asked === file);
  const look = useLook(file, meta, wanted && ready === true);
  const error = (failure?.of === meta ? failure.error : undefined) ?? look.error;
  const faults = placed(error, head, meta);
  useInFront(askedOptions(faults, error, look.found), told.setInFront);
  const send = async (then: (dataset: Dataset) => void) => {
    if (!file) return;
    setBusy(true);
    setFailure(undefined);
    try {
      const dataset = await uploadDataset(sentMeta(meta, file.name), file);
      remember(key, file.name, meta.kind === expected ? withField(meta, "kind", "") : meta);
      then(dataset);
    } catch (refusal) {
      setFailure({ of: meta, error: refusal });
    } finally {
      setBusy(false);
    }
  };
  const load = (mapping: File) =>
    void mappingOf(mapping).then(
      (reading) => told.take({ ...reading, meta: { ...meta, ...reading.meta } }, head),
      (refusal: unknown) => setFailure({ of: meta, error: refusal }),
    );
  // Before anybody sees the page: what is pressed there is meant for this file.
  useLayoutEffect(() => {
    if (dropped) void choose(dropped);
  }, [dropped]);
  return {
    ...{ file, head, meta, look, faults, inFront, busy, load },
    from: from ?? (file ? undefined : liked),
    waits: file !== undefined && !wanted,
    faultCount: countOf(faults),
    choose: (next) => void choose(next),
    change: told.setMeta,
    adopt: (reading) => void told.take(reading, head),
    askLook: () => setAsked(file),
    send: (then) => void send(then),
  };
}
