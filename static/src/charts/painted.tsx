// A drawing of our own on a canvas: as wide as its box, sharp on every screen, named for screen
// readers, and told what the pointer does.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { type Painting, toCanvas } from "./pen";
import { useRoom } from "./room";

export interface Spot {
  x: number;
  y: number;
}

interface Props {
  label: string;
  /** The drawing for a width. */
  painting: (width: number) => Painting;
  press?: (at: Spot, width: number, event: MouseEvent) => void;
  /** Told where the pointer is, and that it left. */
  point?: (at: Spot | undefined, width: number) => void;
  class?: string;
}

const MOST_PIXELS = 16e6;

export function Painted({ label, painting, press, point, ...rest }: Props): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const width = useRoom(box);
  const drawing = painting(width);
  useEffect(() => {
    const area = drawing.width * drawing.height;
    const scale = Math.min(window.devicePixelRatio || 1, Math.sqrt(MOST_PIXELS / area));
    if (canvas.current) toCanvas(drawing, scale, canvas.current);
  });
  const at = (event: MouseEvent): Spot => ({ x: event.offsetX, y: event.offsetY });
  return (
    <div ref={box} class={`painted ${rest.class ?? ""}`}>
      <canvas
        ref={canvas}
        role="img"
        aria-label={label}
        style={{ width: `${drawing.width}px`, height: `${drawing.height}px` }}
        onClick={(event) => press?.(at(event), width, event)}
        onMouseMove={(event) => point?.(at(event), width)}
        onMouseLeave={() => point?.(undefined, width)}
      />
    </div>
  );
}
