// How the units of a file fared: used, ignored and rejected, by reason. They add up.

import type { JSX } from "preact";
import type { Units } from "../api/types";
import { count, plural } from "../format";
import { HeadRow, numberHead } from "./table-parts";

type Row = [fate: string, why: string, units: number, first: string];

function rowsOf({ used, ignored, rejected }: Units): Row[] {
  return [
    ["used", "", used, ""],
    ...Object.entries(ignored).map(([why, units]): Row => ["ignored", why, units, ""]),
    ...Object.entries(rejected).map(
      ([why, of]): Row => ["rejected", why.replaceAll("_", " "), of.count, of.first.join(", ")],
    ),
  ];
}

export function UnitsTable({ units }: { units: Units }): JSX.Element {
  const rows = rowsOf(units);
  return (
    <table class="data units">
      <caption>{`${plural(units.total, units.called)} in the file`}</caption>
      <HeadRow heads={["Fate", "Why", numberHead("Units"), "First"]} />
      <tbody>
        {rows.map(([fate, why, number, first]) => (
          <tr>
            <th scope="row">{fate}</th>
            <td class="wrap">{why || "–"}</td>
            <td class="num">{count(number)}</td>
            <td class="wrap">{first || "–"}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
