// Asking the service what a file holds, before it is uploaded: again whenever what is told of the
// file changes, and the last answer wins.

import { useEffect, useRef, useState } from "preact/hooks";
import { inspectDataset } from "../api/client";
import type { Inspection } from "../api/types";
import type { JsonObject } from "../form/schema";
import { sentMeta } from "./meta";

const LOOK_AFTER_MS = 400;
/** Larger files are looked at when somebody asks for it. */
export const LARGE_BYTES = 50_000_000;

export interface Look {
  /** The file that it is of. */
  of?: File | undefined;
  /** An answer to what is told now is on its way. */
  busy: boolean;
  found?: Inspection;
  error?: unknown;
}

/** Looks at the file while `wanted`; what was found before stays until the next answer. */
export function useLook(file: File | undefined, meta: JsonObject, wanted: boolean): Look {
  const [look, setLook] = useState<Look>({ busy: false });
  const last = useRef<File>(undefined);
  const told = JSON.stringify(meta);
  useEffect(() => {
    const isNew = last.current !== file;
    last.current = wanted ? file : undefined;
    if (!file || !wanted) {
      setLook({ of: file, busy: false });
      return undefined;
    }
    setLook(isNew ? { of: file, busy: true } : { ...look, busy: true });
    const control = new AbortController();
    const take = (answer: Pick<Look, "found" | "error">) => {
      if (!control.signal.aborted) setLook({ of: file, busy: false, ...answer });
    };
    const ask = () =>
      void inspectDataset(sentMeta(meta, file.name), file, control.signal).then(
        (found) => take({ found }),
        (error: unknown) => take({ error }),
      );
    const timer = window.setTimeout(ask, isNew ? 0 : LOOK_AFTER_MS);
    return () => {
      window.clearTimeout(timer);
      control.abort();
    };
  }, [file, told, wanted]);
  // The effect comes after the page has shown the next file.
  return look.of === file ? look : { busy: wanted };
}
