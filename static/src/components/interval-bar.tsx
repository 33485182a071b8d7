// An interval on a common scale, drawn in a cell of a table; the numbers stand beside it.

import type { JSX } from "preact";

export interface Span {
  low: number;
  high: number;
}

export interface Scale {
  min: number;
  max: number;
}

/** From the least to the greatest of all intervals and zero. */
export function scaleOf(spans: Span[]): Scale {
  const edges = [0, ...spans.flatMap((span) => [span.low, span.high])];
  const [min, max] = [Math.min(...edges), Math.max(...edges)];
  const margin = (max - min || 1) * 0.04;
  return { min: min - margin, max: max + margin };
}

export function IntervalBar({
  mean,
  span,
  scale,
}: {
  mean: number;
  span: Span;
  scale: Scale;
}): JSX.Element {
  const at = (value: number) =>
    `${(((value - scale.min) / (scale.max - scale.min)) * 100).toFixed(2)}%`;
  const clear = span.low > 0 || span.high < 0;
  return (
    <span class={`interval${clear ? " interval-clear" : ""}`} aria-hidden="true">
      <span class="interval-zero" style={{ left: at(0) }} />
      <span
        class="interval-line"
        style={{ left: at(span.low), right: `calc(100% - ${at(span.high)})` }}
      />
      <span class="interval-mean" style={{ left: at(mean) }} />
    </span>
  );
}
