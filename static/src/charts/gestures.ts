// Pointer, wheel and keys over a plan: dragging pans, the wheel and two fingers zoom, a still press
// is a click.

export interface Gestures {
  /** One finger moved from `before` to `now`, having gone down at `start`. */
  drag(start: Spot, before: Spot, now: Spot): void;
  /** It was lifted there. */
  dropped(start: Spot, at: Spot): void;
  /** By `factor` of the metres shown, about a point of the box. */
  zoom(factor: number, x: number, y: number): void;
  click(x: number, y: number): void;
}

const STILL_PX = 4;

export interface Spot {
  x: number;
  y: number;
}

export function listen(box: HTMLElement, gestures: Gestures): () => void {
  const fingers = new Map<number, Spot>();
  let moved = 0;
  let start: Spot = { x: 0, y: 0 };
  const place = (event: PointerEvent | WheelEvent): Spot => {
    const frame = box.getBoundingClientRect();
    return { x: event.clientX - frame.left, y: event.clientY - frame.top };
  };
  const down = (event: PointerEvent) => {
    if (event.button !== 0) return;
    if (fingers.size === 0) [moved, start] = [0, place(event)];
    fingers.set(event.pointerId, place(event));
  };
  const move = (event: PointerEvent) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    moved += Math.hypot(now.x - before.x, now.y - before.y);
    if (moved > STILL_PX && !box.hasPointerCapture(event.pointerId))
      box.setPointerCapture(event.pointerId);
    const other = [...fingers.entries()].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, now);
    if (other) pinch(other, before, now);
    else if (moved > STILL_PX) gestures.drag(start, before, now);
  };
  const pinch = (other: Spot, before: Spot, now: Spot) => {
    const was = Math.hypot(before.x - other.x, before.y - other.y);
    const is = Math.hypot(now.x - other.x, now.y - other.y);
    if (was > 0 && is > 0) gestures.zoom(was / is, (now.x + other.x) / 2, (now.y + other.y) / 2);
  };
  const up = (event: PointerEvent) => {
    const spot = fingers.get(event.pointerId);
    fingers.delete(event.pointerId);
    if (!spot || fingers.size > 0) return;
    if (moved > STILL_PX) gestures.dropped(start, spot);
    else if (event.type === "pointerup") gestures.click(spot.x, spot.y);
  };
  const wheel = (event: WheelEvent) => {
    event.preventDefault();
    const spot = place(event);
    gestures.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 240))), spot.x, spot.y);
  };
  box.addEventListener("pointerdown", down);
  box.addEventListener("pointermove", move);
  box.addEventListener("pointerup", up);
  box.addEventListener("pointercancel", up);
  box.addEventListener("wheel", wheel, { passive: false });
  return () => {
    box.removeEventListener("pointerdown", down);
    box.removeEventListener("pointermove", move);
    box.removeEventListener("pointerup", up);
    box.removeEventListener("pointercancel", up);
    box.removeEventListener("wheel", wheel);
  };
}
