// A campaign that is made: its cells, curves, differences and times are the report's, and its
// tables go into papers.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  BASE,
  campaign,
  cellTexts,
  closePage,
  drawn,
  ended,
  finished,
  frameOf,
  gridOf,
  openPage,
  parameters,
  preset,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let job;
let report;
before(async () => {
  browser = await startBrowser();
  ({ job, report } = await finished("campaign", await campaign()));
});
after(() => browser.close());

async function open(more = "") {
  const page = await openPage(browser, `?view=job&job=${job.id}${more}`);
  await page.locator(".grid-cell").first().waitFor();
  return page;
}

test("the grid holds mean, interval and runs of every cell, for the chosen outcome", async () => {
  const page = await open();
  for (const outcome of report.result.outcomes) {
    await page.getByRole("combobox", { name: "Outcome" }).selectOption(outcome);
    assert.equal(parameters(page).get("outcome") ?? report.result.outcomes[0], outcome);
    assert.deepEqual(await gridOf(page, outcome), cellTexts(report.result, outcome));
  }
  await closePage(page);
});

test("curves with bands over an axis of choice carry the numbers of the cells", async () => {
  const page = await open("&outcome=GOSPA");
  const frame = frameOf(page, "GOSPA over P_D");
  await drawn(frame);
  const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n")
    .slice(1);
  assert.equal(csv.length, report.result.cells.length);
  for (const { parameters: at, outcomes } of report.result.cells) {
    const { mean, interval } = outcomes.GOSPA;
    assert.ok(
      csv.includes([at.associator, Number(at.P_D), mean, interval.low, interval.high].join(",")),
      `${at.associator} at ${at.P_D}`,
    );
  }
  await page.getByRole("combobox", { name: "Over" }).selectOption("associator");
  const dots = frameOf(page, "GOSPA over associator");
  await dots.locator(".category-dots").waitFor();
  assert.equal(parameters(page).get("x"), "associator");
  const rows = (await saved(page, dots.getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n")
    .slice(1);
  const wanted = report.result.cells.map(({ parameters: at, outcomes: { GOSPA: of } }) =>
    [at.P_D, at.associator, of.mean, of.interval.low, of.interval.high, of.count].join(","),
  );
  assert.deepEqual(rows.sort(), wanted.sort());
  await closePage(page);
});

test("paired differences and times are the report's", async () => {
  const page = await open("&outcome=GOSPA");
  const rows = await frameOf(page, "Paired differences: GOSPA")
    .locator("tbody tr")
    .evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.innerText.trim())));
  const compared = report.result.cells.filter((cell) => cell.differences.GOSPA);
  assert.deepEqual(
    rows.map((row) => row.slice(0, 5)),
    compared.map((cell) => {
      const { pairs, mean, interval } = cell.differences.GOSPA;
      return [
        cell.name,
        cell.compared_with,
        String(pairs),
        shown(mean),
        `[${shown(interval.low)}, ${shown(interval.high)}]`,
      ];
    }),
  );
  const times = await frameOf(page, "Time of deciding")
    .locator("tbody tr")
    .evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.innerText.trim())));
  assert.deepEqual(
    times,
    report.timing.cells.map((time) => [
      time.cell,
      shown(time.decide_us_per_scan),
      shown(time.ratio),
      String(time.timed_runs),
    ]),
  );
  await closePage(page);
});

test("the table of all outcomes is exported as CSV, Markdown and LaTeX", async () => {
  const page = await open();
  const frame = frameOf(page, "All outcomes");
  const { cells } = report.result;
  const text = async (name) =>
    (await saved(page, frame.getByRole("button", { name, exact: true }))).bytes.toString();
  const csv = (await text("CSV")).trim().split("\r\n");
  assert.ok(csv[1].startsWith(`0.7,NN,4,${cells[0].outcomes["P correct"].mean},`), csv[1]);
  const markdown = (await text("Markdown")).trim().split("\n");
  assert.equal(markdown.length, cells.length + 2);
  assert.match(markdown[1], /^\|(---\|)+$/);
  assert.ok(markdown[2].includes(shown(cells[0].outcomes.GOSPA.mean)));
  const latex = await text("LaTeX");
  assert.match(latex, /^\\begin\{tabular\}\{/);
  assert.ok(latex.includes("P\\_D"), "underscores are escaped");
  assert.equal(latex.split("\n").filter((line) => line.endsWith("\\\\")).length, cells.length + 1);
  await closePage(page);
});

test("points that are whole numbers with a point, as other programs write them, are found", async () => {
  const body = { ...(await preset("huo2008-spacing")), runs: 2 };
  const text = JSON.stringify(body).replace(/"values":\[[\d.,]+\]/, '"values":[150.0,250.0]');
  const answer = await fetch(`${BASE}/v1/jobs/campaign`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: text,
  });
  const { id } = await answer.json();
  assert.equal((await ended(id)).state, "succeeded");
  const { result } = await api(`/v1/jobs/${id}/report`);
  assert.ok(
    result.cells.every((cell) => /^\d+\.0$/.test(cell.parameters["spacing (m)"])),
    "the service keeps the point",
  );
  const page = await openPage(browser, `?view=job&job=${id}&outcome=J`);
  await page.locator(".grid-cell").first().waitFor();
  const cells = await frameOf(page, "Cells: J").locator(".grid-cell b").allInnerTexts();
  assert.deepEqual(
    cells,
    result.cells.map((cell) => shown(cell.outcomes.J.mean)),
  );
  await drawn(frameOf(page, "J over spacing (m)"));
  await closePage(page);
});
