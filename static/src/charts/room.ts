// How wide the box of a drawing is, now and after every change.

import type { RefObject } from "preact";
import { useEffect, useState } from "preact/hooks";

const LEAST_PX = 280;

export function useRoom(box: RefObject<HTMLElement | null>, first = 900): number {
  const [room, setRoom] = useState(first);
  useEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    const observer = new ResizeObserver(() => setRoom(Math.max(element.clientWidth, LEAST_PX)));
    observer.observe(element);
    return () => observer.disconnect();
  }, []);
  return room;
}
