// The metrics of a job: every quantity as the report has it, the metrics over time, who followed
// whom, and the events behind the counts.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  closePage,
  drawn,
  evaluated,
  linesOf,
  openPage,
  parameters,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let job;
let result;
let events;
before(async () => {
  browser = await startBrowser();
  const found = await evaluated();
  job = found.job;
  ({ result } = found.report);
  events = (await linesOf(job, "events.csv")).slice(1);
});
after(() => browser.close());

async function open(more = "") {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=metrics${more}`);
  await page.locator(".metric-group").first().waitFor();
  return page;
}

test("every quantity of every metric is on the page with its unit, as the report has it", async () => {
  const page = await open();
  for (const [name, metric] of Object.entries(result.metrics)) {
    const group = page.locator(`.metric-group[aria-label="${name}"]`);
    const expected = Object.entries(metric.quantities).map(
      ([quantity, { value, unit, reason }]) => [
        quantity,
        value === null ? (reason ?? "undefined") : unit ? `${shown(value)} ${unit}` : shown(value),
      ],
    );
    const found = await group
      .locator("dt")
      .evaluateAll((all) => all.map((term) => [term.title, term.nextElementSibling.innerText]));
    assert.deepEqual(found, expected, name);
    const text = await group.innerText();
    for (const parameter of Object.keys(metric.parameters))
      assert.ok(text.includes(parameter), `${name} says its ${parameter}`);
  }
  const csv = (
    await saved(
      page,
      page
        .locator(".table-frame", { has: page.locator(".metric-groups") })
        .getByRole("button", { name: "CSV" }),
    )
  ).bytes.toString();
  const count = Object.values(result.metrics).reduce(
    (sum, metric) => sum + Object.keys(metric.quantities).length,
    0,
  );
  assert.equal(csv.trim().split("\r\n").length, count + 1);
  assert.ok(csv.includes(`gospa,gospa,${result.metrics.gospa.value},m`), "with all digits");
  await closePage(page);
});

test("the metrics over time are drawn and exported as the service has them", async () => {
  const page = await open("&over=ospa");
  const frame = page.locator(".chart-frame", { hasText: "over time" });
  await drawn(frame);
  const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n");
  const series = await api(`/v1/jobs/${job.id}/series/metrics`);
  const column = csv[0].split(",").indexOf("ospa.ospa (m)");
  assert.ok(column > 0, csv[0]);
  assert.deepEqual(
    csv.slice(1).map((line) => Number(line.split(",")[column])),
    series.columns.values["ospa.ospa"],
  );
  await frame.getByLabel("Metric").selectOption("gospa");
  assert.equal(parameters(page).get("over"), "gospa");
  await page.getByRole("heading", { name: "gospa over time" }).waitFor();
  await drawn(page.locator(".chart-frame", { hasText: "over time" }));
  await page
    .locator(".chart-frame", { hasText: "over time" })
    .locator("canvas")
    .first()
    .click({ position: { x: 400, y: 100 } });
  await page.waitForFunction(() => new URLSearchParams(location.search).has("time"));
  assert.ok(
    series.columns.time_s.includes(Number(parameters(page).get("time"))),
    "the clock stands at a time of the series",
  );
  await closePage(page);
});

test("a count leads to its events, and an event to its moment", async () => {
  const page = await open();
  const missed = result.metrics.clear.quantities.fn.value;
  assert.equal(missed, events.filter((row) => row[2] === "miss").length);
  await page
    .locator('.metric-group[aria-label="clear"]')
    .getByRole("link", { name: `${missed}: show the events` })
    .click();
  assert.equal(parameters(page).get("event"), "miss");
  const table = page.locator(".table-frame", {
    has: page.getByRole("heading", { name: "Events" }),
  });
  await table.getByText(`${missed.toLocaleString("en-US")} events`).waitFor();
  assert.equal(await table.locator("tbody tr").count(), Math.min(missed, 200));
  const first = events.find((row) => row[2] === "miss");
  await table.locator("tbody a").first().click();
  await page.locator(".plan canvas").first().waitFor();
  assert.equal(Number(parameters(page).get("time")), Number(first[1]));
  assert.equal(parameters(page).get("truth"), first[3]);
  await closePage(page);
});

test("lanes say who followed whom; their marks are the breaks and switches of the log", async () => {
  const page = await open();
  const frame = page.locator(".chart-frame", { hasText: "Who followed whom" });
  await frame.locator("svg.drawing").waitFor();
  const of = (kind) => events.filter((row) => row[2] === kind).length;
  assert.ok(of("break") > 0, "the scene has breaks");
  // The lanes with most marks come first, and they are few.
  assert.equal(await frame.locator(".lane-break").count(), of("break"));
  assert.equal(await frame.locator(".lane-switch").count(), of("switch"));
  await frame.getByRole("button", { name: "Table" }).click();
  await frame.locator("tbody tr").first().waitFor();
  await frame.getByRole("button", { name: "Chart" }).click();
  const svg = (await saved(page, frame.getByRole("button", { name: "SVG" }))).bytes.toString();
  assert.match(svg, /stroke: ?(rgb|#)/, "the file carries its colours");
  const mark = frame.locator(".lane-break").first();
  const label = await mark.getAttribute("aria-label");
  await mark.focus();
  await page.keyboard.press("Enter");
  await page.locator(".plan canvas").first().waitFor();
  assert.equal(label.split(":")[0], parameters(page).get("truth"));
  assert.match(label, new RegExp(`at ${parameters(page).get("time")} s`));
  await closePage(page);
});

test("each break and miss says why, in the words of the file, and causes are counted", async () => {
  // A sentence stands last in its row, quoted where it holds a comma.
  const sentences = (await linesOf(job, "causes.csv"))
    .slice(1)
    .map((row) => ({ event: row[0], why: row.slice(14).join(",").replaceAll('"', "") }));
  const page = await open("&event=break");
  const table = page.locator(".table-frame", {
    has: page.getByRole("heading", { name: "Events" }),
  });
  await table.locator("tbody tr").first().waitFor();
  const shownWhy = await table.locator("tbody td:last-child").allInnerTexts();
  const written = sentences.filter(({ event }) => event === "break").map(({ why }) => why);
  assert.deepEqual(shownWhy, written.slice(0, 200));
  const causes = page.locator(".table-frame", {
    has: page.getByRole("heading", { name: "Causes" }),
  });
  const rows = await causes.locator("tbody tr").count();
  assert.equal(rows, result.events.causes.length);
  for (const { event, events: count } of result.events.causes)
    assert.ok(count <= result.events.counts[event], event);
  await causes
    .getByRole("link", { name: /: show each miss$/ })
    .first()
    .click();
  assert.equal(parameters(page).get("event"), "miss");
  await closePage(page);
});

test("the summary has the headlines and the events of the report", async () => {
  const page = await openPage(browser, `?view=job&job=${job.id}`);
  const panel = page.locator(".panel", {
    has: page.getByRole("link", { name: "Metrics", exact: true }),
  });
  await panel.waitFor();
  const text = await panel.innerText();
  for (const [name, metric] of Object.entries(result.metrics))
    assert.ok(text.includes(`${name}\n${shown(metric.value)}`), `${name} in ${text}`);
  await page.getByRole("link", { name: `${result.events.counts.break} events: break` }).click();
  await page.getByRole("heading", { name: "Events" }).waitFor();
  assert.equal(parameters(page).get("event"), "break");
  await closePage(page);
});
