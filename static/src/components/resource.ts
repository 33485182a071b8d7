// Something asked of the service once: loading, there, or failed, with a way to ask again.

import { useEffect, useState } from "preact/hooks";

export interface Resource<T> {
  data?: T;
  error?: unknown;
  reload(): void;
}

/** Calls `load` again whenever one of `keys` changes; an answer that comes too late is dropped. */
export function useResource<T>(load: () => Promise<T>, keys: unknown[]): Resource<T> {
  const [state, setState] = useState<{ data?: T; error?: unknown }>({});
  const [round, setRound] = useState(0);
  useEffect(() => {
    let current = true;
    setState({});
    load().then(
      (data) => current && setState({ data }),
      (error: unknown) => current && setState({ error }),
    );
    return () => {
      current = false;
    };
  }, [...keys, round]);
  return { ...state, reload: () => setRound(round + 1) };
}
