// A few numbers side by side, each with what it means.

import type { JSX } from "preact";

export interface Figure {
  name: string;
  value: string;
  note?: string;
}

export function Figures({ label, figures }: { label: string; figures: Figure[] }): JSX.Element {
  return (
    <dl class="figures" aria-label={label}>
      {figures.map(({ name, value, note }) => (
        <div class="figure">
          <dt>{name}</dt>
          <dd>
            <b>{value}</b>
            {note ? <span class="sub">{note}</span> : null}
          </dd>
        </div>
      ))}
    </dl>
  );
}
