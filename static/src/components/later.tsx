// A part of the page whose code is loaded when it is shown.

import type { JSX } from "preact";
import { Loading, ProblemBox } from "./basics";
import { useResource } from "./resource";

type View<Props> = (props: Props) => JSX.Element;

/** The view in its place, once `load` has brought its code; `what` it is called meanwhile. */
export function later<Props extends object>(
  what: string,
  load: () => Promise<View<Props>>,
): View<Props> {
  return function Later(props: Props): JSX.Element {
    // A component is a function: it is wrapped, so that the state does not call it.
    const view = useResource(async () => ({ Part: await load() }), []);
    if (view.error) return <ProblemBox error={view.error} retry={view.reload} />;
    return view.data ? <view.data.Part {...props} /> : <Loading what={what} />;
  };
}
