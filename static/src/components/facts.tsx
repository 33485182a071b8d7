// Names and values side by side, in a panel.

import type { ComponentChildren, JSX } from "preact";

export type Fact = [name: string, value: ComponentChildren];

export function FactList({ facts }: { facts: Fact[] }): JSX.Element {
  return (
    <dl class="facts">
      {facts.map(([name, value]) => (
        <>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </>
      ))}
    </dl>
  );
}

export function Facts({ title, rows }: { title: string; rows: Fact[] }): JSX.Element {
  return (
    <section class="panel">
      <h2>{title}</h2>
      <FactList facts={rows} />
    </section>
  );
}
