// A canvas with a chart on it: mounted when it comes into view, sized with its box, named for
// screen readers.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Chart } from "./echarts";

export interface ChartProps {
  /** What the picture shows, for those who cannot see it. */
  label: string;
  /**
   * Called with the chart once it stands, and again whenever its box changes; answers what undoes
   * it.
   */
  draw: (chart: Chart) => void;
  /** Redrawn when one of these changes. */
  keys: unknown[];
  created?: (chart: Chart) => () => void;
  class?: string;
}

function nameCanvases(box: HTMLElement, label: string): void {
  for (const canvas of box.querySelectorAll("canvas")) {
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
  }
}

/** Runs `start` when `box` is first seen. */
function whenSeen(box: Element, start: () => void): () => void {
  const observer = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    observer.disconnect();
    start();
  });
  observer.observe(box);
  return () => observer.disconnect();
}

export function ChartCanvas({ label, draw, keys, created, ...rest }: ChartProps): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const chart = useRef<Chart | undefined>(undefined);
  const latest = useRef({ draw, label });
  latest.current = { draw, label };
  const redraw = () => {
    if (!chart.current || !box.current) return;
    latest.current.draw(chart.current);
    nameCanvases(box.current, latest.current.label);
  };
  useEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    let undo: (() => void) | undefined;
    let gone = false;
    const resize = new ResizeObserver(() => {
      chart.current?.resize();
      redraw();
    });
    const stopWaiting = whenSeen(element, async () => {
      const { init } = await import("./echarts");
      if (gone) return;
      chart.current = init(element, null, { renderer: "canvas" });
      undo = created?.(chart.current);
      resize.observe(element);
      redraw();
    });
    return () => {
      gone = true;
      stopWaiting();
      resize.disconnect();
      undo?.();
      chart.current?.dispose();
      chart.current = undefined;
    };
  }, []);
  useEffect(redraw, keys);
  return <div ref={box} class={`chart-canvas ${rest.class ?? ""}`} />;
}
