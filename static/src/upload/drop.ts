// Files that are dropped: on the whole page, or on one part of it. A file that falls beside would
// make the browser leave the page, so it is caught.

import type { RefObject } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";

const holdsFiles = (event: DragEvent): boolean =>
  event.dataTransfer?.types.includes("Files") ?? false;

/** Whether files are held over the place where they are taken. */
export function useDrop(
  take: (files: File[]) => void,
  within?: RefObject<HTMLElement | null>,
  active = true,
): boolean {
  const [over, setOver] = useState(false);
  const taker = useRef(take);
  taker.current = take;
  useEffect(() => {
    if (!active) return undefined;
    const isInside = (event: DragEvent): boolean =>
      !within || (within.current?.contains(event.target as Node) ?? false);
    const hold = (event: DragEvent) => {
      if (!holdsFiles(event)) return;
      event.preventDefault();
      setOver(isInside(event));
    };
    const leave = (event: DragEvent) => {
      if (event.relatedTarget === null) setOver(false);
    };
    const drop = (event: DragEvent) => {
      if (!holdsFiles(event)) return;
      event.preventDefault();
      setOver(false);
      if (isInside(event)) taker.current([...(event.dataTransfer?.files ?? [])]);
    };
    const listeners = { dragover: hold, dragleave: leave, drop };
    for (const [name, listener] of Object.entries(listeners))
      window.addEventListener(name, listener as EventListener);
    return () => {
      for (const [name, listener] of Object.entries(listeners))
        window.removeEventListener(name, listener as EventListener);
    };
  }, [active]);
  return over;
}
