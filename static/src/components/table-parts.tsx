// What the tables of all views are made of: a box that scrolls, and a row of heads.

import type { ComponentChildren, JSX } from "preact";

interface ScrollProps {
  label: string;
  class?: string;
  children: ComponentChildren;
}

/** A wide table scrolls in its box; the keyboard reaches the box, and a screen reader names it. */
export function TableScroll({ label, children, ...rest }: ScrollProps): JSX.Element {
  return (
    <div class={rest.class ?? "table-scroll tall"} tabIndex={0} role="region" aria-label={label}>
      {children}
    </div>
  );
}

/**
 * The head of a column of texts is a text; numbers are set to the right, and a hidden head is read
 * out only.
 */
export type Head = string | { name: string; is: "number" | "hidden" };

export const numberHead = (name: string): Head => ({ name, is: "number" });
export const hiddenHead = (name: string): Head => ({ name, is: "hidden" });

export function HeadRow({ heads }: { heads: Head[] }): JSX.Element {
  return (
    <thead>
      <tr>{heads.map(headCell)}</tr>
    </thead>
  );
}

function headCell(head: Head): JSX.Element {
  if (typeof head === "string") return <th scope="col">{head}</th>;
  return head.is === "number" ? (
    <th scope="col" class="num">
      {head.name}
    </th>
  ) : (
    <th scope="col">
      <span class="visually-hidden">{head.name}</span>
    </th>
  );
}
