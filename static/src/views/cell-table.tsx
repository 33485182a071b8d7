// The cells of a campaign as a table: rows are the points of all axes but the last, columns those
// of the last.

import type { JSX } from "preact";
import { TableScroll } from "../components/table-parts";
import { type Axis, combinations, rowsAndColumns } from "./campaign-axes";

interface Props {
  axes: Axis[];
  label: string;
  class?: string;
  /** The cell at these points of the rows and this one of the columns, the `index`-th of all. */
  cell: (points: string[], point: string, index: number) => JSX.Element;
}

export function CellTable({ axes, label, cell, ...rest }: Props): JSX.Element {
  const { rows, columns } = rowsAndColumns(axes);
  return (
    <TableScroll label={label} class={`table-scroll ${rest.class ?? ""}`}>
      <table class="grid">
        <thead>
          <tr>
            {rows.map((axis) => (
              <th scope="col">{axis.name}</th>
            ))}
            {columns.points.map((point) => (
              <th scope="col" class="num">
                {columns.name ? <span class="sub">{columns.name}</span> : null}
                {point}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {combinations(rows).map((points, row) => (
            <tr>
              {points.map((point) => (
                <th scope="row">{point}</th>
              ))}
              {columns.points.map((point, column) =>
                cell(points, point, row * columns.points.length + column),
              )}
            </tr>
          ))}
        </tbody>
      </table>
    </TableScroll>
  );
}
