// What a page says, read as a person reads it, and numbers as the dashboard prints them.

import assert from "node:assert/strict";
import { frameOf, linesOf, openPage, shown } from "./support.mjs";

export const count = (value) =>
  value === null || value === undefined ? "–" : value.toLocaleString("en-US");
export const share = (value) => (value === null || value === undefined ? "–" : value.toFixed(3));
export const range = (interval) =>
  interval ? `[${shown(interval.low)}, ${shown(interval.high)}]` : "–";
export const words = (name) => {
  const bare = name.replace(/_(m|s|mps|m2ps3|deg|hz)$/, "");
  return /_[a-z]$/.test(bare) ? bare : bare.replaceAll("_", " ");
};
export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** A page that has loaded all that it shows; `first` is there. */
export async function open(browser, query, first) {
  const page = await openPage(browser, query);
  await page.locator(first).first().waitFor();
  await page.waitForFunction(() => !document.querySelector(".loading"));
  return page;
}

export const panelOf = (page, name) =>
  page.locator("section.panel", { has: page.getByRole("heading", { name, exact: true }) });
export const oneLine = (text) => text.replaceAll(/\s+/g, " ").trim();
export const rowsOf = (place) =>
  place
    .locator("tbody tr")
    .evaluateAll((rows) =>
      rows.map((row) =>
        [...row.cells].map((cell) => cell.innerText.replaceAll(/\s+/g, " ").trim()),
      ),
    );
/** Name and value of every line of a list of facts. */
export const factsOf = (place) =>
  place
    .locator("dl.facts")
    .evaluate((list) =>
      [...list.querySelectorAll("dt")].map((name) => [
        name.textContent.trim(),
        name.nextElementSibling.textContent.trim(),
      ]),
    );

/** The table twin of a chart, row by row, all of it. */
export async function twinOf(page, name) {
  const frame = frameOf(page, name);
  await frame.getByRole("button", { name: "Table" }).click();
  const more = frame.getByRole("button", { name: "Show more" });
  while (await more.count()) await more.click();
  return rowsOf(frame);
}

/** Rows of columns, as a twin prints them. */
export const printed = (columns) =>
  Object.values(columns)[0].map((_, row) =>
    Object.values(columns).map((column) =>
      typeof column[row] === "number" ? shown(column[row]) : (column[row] ?? "–"),
    ),
  );

/** Every number of what a method says of itself, with the names on the way to it. */
export const leaves = (value, path = []) =>
  typeof value === "object" && value !== null
    ? Object.entries(value).flatMap(([name, inner]) => leaves(inner, [...path, words(name)]))
    : [
        [
          capital(path.join(", ")),
          typeof value === "number" ? shown(value) : value === null ? "–" : String(value),
        ],
      ];

/** The rows of a trace, by the names of its columns. */
export async function traceOf(job, file) {
  const [head, ...lines] = await linesOf(job, file);
  return lines.map((line) => Object.fromEntries(head.map((name, index) => [name, line[index]])));
}

export function assertSame(found, wanted, what) {
  assert.ok(wanted.length > 0, `${what}: there is something to compare`);
  assert.deepEqual(found, wanted, what);
}
