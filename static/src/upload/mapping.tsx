// The columns of a file with their first values, and what each is read as.

import type { JSX } from "preact";
import type { Fault } from "../api/types";
import { FaultText } from "../components/basics";
import { HeadRow, TableScroll } from "../components/table-parts";
import { CANONICAL } from "./columns";
import type { Head } from "./head";
import type { Columns } from "./meta";

interface MappingProps {
  id: string;
  head: Head;
  columns: Columns;
  faults: Map<string, Fault[]>;
  change: (columns: Columns) => void;
}

const LONGEST = 16;

const shortened = (text: string): string =>
  text.length > LONGEST ? `${text.slice(0, LONGEST - 1)}…` : text;

function changed(columns: Columns, name: string, to: string): Columns {
  const { [name]: _, ...others } = columns;
  return to === "" ? others : { ...others, [name]: to };
}

export function Mapping({ id, head, columns, faults, change }: MappingProps): JSX.Element {
  return (
    <TableScroll label="Columns of the file" class="mapping table-scroll">
      <table class="data">
        <HeadRow heads={["Column", "First values", "Read as"]} />
        <tbody>
          {head.columns.map((name, index) => (
            <tr class={faults.has(name) ? "faulty" : undefined}>
              <th scope="row" class="mono">
                {name}
              </th>
              <td class="mono muted">
                {head.rows.map((row) => shortened(row[index] ?? "")).join(" · ")}
              </td>
              <td>
                <ColumnInput
                  id={`${id}-column-${index}`}
                  list={`${id}-names`}
                  name={name}
                  value={columns[name] ?? ""}
                  faults={faults.get(name) ?? []}
                  change={(to) => change(changed(columns, name, to))}
                />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <datalist id={`${id}-names`}>
        {CANONICAL.map((name) => (
          <option value={name} />
        ))}
      </datalist>
    </TableScroll>
  );
}

interface ColumnProps {
  id: string;
  list: string;
  name: string;
  value: string;
  faults: Fault[];
  change: (to: string) => void;
}

function ColumnInput({ id, list, name, value, faults, change }: ColumnProps): JSX.Element {
  return (
    <>
      <input
        id={id}
        type="text"
        list={list}
        data-column={name}
        aria-label={`Column ${name} is read as`}
        aria-invalid={faults.length > 0 || undefined}
        aria-describedby={faults.length ? `${id}-fault` : undefined}
        autocomplete="off"
        value={value}
        placeholder={name}
        onInput={(event) => change(event.currentTarget.value.trimStart())}
      />
      {faults.length ? (
        <p class="field-fault" id={`${id}-fault`}>
          {faults.map((fault) => (
            <span>
              <FaultText fault={fault} />
            </span>
          ))}
        </p>
      ) : null}
    </>
  );
}
