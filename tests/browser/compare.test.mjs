// Jobs side by side: chosen in the list, numbers and differences as the service has them, all of it
// in the address.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  closePage,
  drawn,
  evaluated,
  finished,
  frameOf,
  openPage,
  parameters,
  preset,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let jobs;
let comparison;
before(async () => {
  browser = await startBrowser();
  const first = await evaluated();
  const body = await preset("liang2009-100");
  body.name = "compared JPDA";
  body.associator = { method: "jpda" };
  jobs = [first.job, (await finished("evaluate", body)).job];
  comparison = await api(`/v1/compare?${jobs.map(({ id }) => `job=${id}`).join("&")}`);
});
after(() => browser.close());

const texts = (rows) =>
  rows.evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.innerText.trim())));

async function open(more = "") {
  const page = await openPage(
    browser,
    `?view=compare&jobs=${jobs.map(({ id }) => id).join(",")}${more}`,
  );
  await frameOf(page, "Numbers").waitFor();
  return page;
}

test("jobs are ticked in the list and compared", async () => {
  const page = await openPage(browser, "");
  for (const { id, name } of jobs) {
    const row = page.locator("tr", { has: page.locator(`a[href*="${id}"]`) });
    await row.getByLabel(`Compare ${name}`).check();
  }
  assert.equal(parameters(page).get("ticked"), jobs.map(({ id }) => id).join(","));
  await page.getByRole("link", { name: "Compare 2 jobs" }).click();
  await frameOf(page, "Numbers").waitFor();
  assert.equal(parameters(page).get("view"), "compare");
  await closePage(page);
});

test("numbers that differ, verdicts and requests are the service's", async () => {
  const page = await open();
  const different = comparison.numbers.filter(({ values }) => values[0] !== values[1]);
  const rows = await texts(frameOf(page, "Numbers").locator("tbody tr"));
  assert.deepEqual(
    rows.map((row) => row.slice(1)),
    different.map(({ values }) => values.map(shown)),
  );
  await page.getByLabel("only what differs").uncheck();
  assert.equal(
    await frameOf(page, "Numbers").locator("tbody tr").count(),
    comparison.numbers.length,
  );
  const [verdict] = comparison.verdicts;
  const second = await page
    .getByRole("region", { name: "Compared jobs" })
    .locator("tbody tr")
    .nth(1)
    .locator("td")
    .allInnerTexts();
  assert.deepEqual(
    second.slice(5, 9),
    [verdict.targets, verdict.both_correct, verdict.gained, verdict.lost].map(String),
  );
  const requests = await texts(frameOf(page, "Where the requests differ").locator("tbody tr"));
  assert.deepEqual(
    requests,
    comparison.request.map(({ pointer, values }) => [
      pointer,
      ...values.map((value) => value ?? "absent"),
    ]),
  );
  await closePage(page);
});

test("paired differences turn their sign with the baseline", async () => {
  const page = await open();
  const row = comparison.paired.find((entry) => entry.name === "gospa.gospa");
  const frame = frameOf(page, "Paired differences");
  const line = (name) =>
    frame
      .locator("tbody tr", { has: page.locator("th", { hasText: name }) })
      .first()
      .locator("td")
      .allInnerTexts();
  const [, difference] = row.differences;
  const cells = await line("gospa.gospa");
  assert.deepEqual(
    [cells[0], cells[2], cells[3]],
    [
      "B",
      shown(difference.mean),
      `[${shown(difference.interval.low)}, ${shown(difference.interval.high)}]`,
    ],
  );
  assert.equal(cells[4], difference.verdict.replaceAll("_", " "));
  const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes.toString();
  assert.ok(
    csv.includes(`,gospa.gospa,m,steps,B: compared JPDA,${difference.pairs},${difference.mean},`),
    "with all digits",
  );
  await page.getByLabel(/^Compare with B/).check();
  await page.waitForFunction(() =>
    [...document.querySelectorAll("th")].some((head) => head.textContent === "B (baseline)"),
  );
  assert.equal(parameters(page).get("baseline"), jobs[1].id);
  const turned = await line("gospa.gospa");
  assert.deepEqual([turned[0], turned[2]], ["A", shown(-difference.mean)]);
  await closePage(page);
});

test("a metric of every job over time is drawn in one chart", async () => {
  const page = await open("&over=ospa.ospa");
  const frame = frameOf(page, "ospa.ospa of every job");
  await drawn(frame);
  const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n")
    .slice(1);
  const series = await Promise.all(jobs.map(({ id }) => api(`/v1/jobs/${id}/series/metrics`)));
  assert.deepEqual(
    csv.map((line) => Number(line.split(",").at(-1))),
    series.flatMap(({ columns }) => columns.values["ospa.ospa"]),
  );
  await frame.getByRole("combobox", { name: "Metric" }).selectOption("gospa.gospa");
  assert.equal(parameters(page).get("over"), "gospa.gospa");
  await closePage(page);
});

test("the address alone shows the same comparison; a job can be taken out", async () => {
  const page = await open("&find=gospa&same=1");
  const numbers = comparison.numbers.filter(({ path }) => path.includes("gospa"));
  assert.equal(await frameOf(page, "Numbers").locator("tbody tr").count(), numbers.length);
  await page.getByRole("button", { name: /^Remove B/ }).click();
  await page.getByText("Choose two jobs or more.").waitFor();
  await page.goBack();
  await frameOf(page, "Numbers").waitFor();
  await closePage(page);
});
