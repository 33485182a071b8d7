// The address is the state: what a person chose in a view is there again in a fresh browser.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { isDeepStrictEqual } from "node:util";
import {
  bearingsTracked,
  campaign,
  closePage,
  clustered,
  correlated,
  evaluated,
  finished,
  openPage,
  startBrowser,
} from "./support.mjs";

let browser;
let views;
before(async () => {
  browser = await startBrowser();
  const [one, tuples, bearings, grid, fuzzy] = [
    await evaluated(),
    await correlated(),
    await bearingsTracked(),
    await finished("campaign", await campaign()),
    await clustered(),
  ];
  const { truth_id } = one.report.result.tfa.targets.find((target) => target.verdict === "missed");
  const job = (found, tab) => `?view=job&job=${found.job.id}${tab ? `&tab=${tab}` : ""}`;
  const choose = (name, value) => (page) =>
    page.getByRole("combobox", { name }).selectOption(value);
  views = {
    metrics: [
      job(one, "metrics"),
      choose("Metric", "ospa"),
      choose("Events", "miss"),
      (page) => page.getByRole("searchbox").fill("rmse"),
    ],
    verdicts: [
      job(one, "verdicts"),
      (page) => page.getByRole("link", { name: `Way of target ${truth_id}`, exact: true }).click(),
    ],
    correlation: [job(tuples, "correlation"), choose("Tuples", "wrong")],
    bearings: [
      job(bearings, "plan"),
      (page) => page.getByRole("button", { name: "To the first scan" }).click(),
      choose("Trail", "5"),
      (page) => page.locator(".selection").getByLabel("Truth").selectOption({ index: 2 }),
    ],
    memberships: [
      job(fuzzy, "search"),
      (page) => page.getByRole("combobox", { name: "Search" }).selectOption({ index: 3 }),
      (page) => page.locator("input[type=range]").first().fill("0"),
    ],
    campaign: [job(grid), choose("Outcome", "GOSPA"), choose("Over", "associator")],
    compare: [
      `?view=compare&jobs=${one.job.id},${fuzzy.job.id}`,
      (page) => page.getByLabel(/^Compare with B/).check(),
      (page) => page.getByLabel("only what differs").uncheck(),
      (page) => page.getByRole("searchbox").fill("tfa"),
    ],
    datasets: [
      "?view=datasets",
      choose("Kind", "tracks"),
      (page) => page.getByRole("searchbox").fill("browser"),
    ],
  };
});
after(() => browser.close());

async function settled(page) {
  await page.locator("h1").first().waitFor();
  await page.waitForFunction(() => !document.querySelector(".loading"));
  await page.waitForTimeout(300);
}

/**
 * Everything that a view says: its text, what stands in its fields, and the names of its pictures.
 */
const read = (page) =>
  page.evaluate(() => ({
    text: document.querySelector("main").innerText,
    fields: [...document.querySelectorAll("main input, main select")].map((field) =>
      field.type === "checkbox" || field.type === "radio" ? field.checked : field.value,
    ),
    pictures: [...document.querySelectorAll("main [aria-label]")]
      .filter((element) => element.tagName !== "CANVAS")
      .map((element) => element.getAttribute("aria-label")),
  }));

/** What a view says once it says the same twice, a rest apart. */
async function said(page) {
  let before;
  for (;;) {
    await settled(page);
    const now = await read(page);
    if (isDeepStrictEqual(now, before)) return now;
    before = now;
  }
}

test("what was chosen in each view is there again when its address is opened", async () => {
  for (const [name, [query, ...steps]] of Object.entries(views)) {
    const page = await openPage(browser, query);
    await settled(page);
    const start = await said(page);
    for (const step of steps) {
      await step(page);
      await settled(page);
    }
    const left = await said(page);
    assert.notDeepEqual(left, start, `${name}: the choices change the view`);
    const again = await openPage(browser, new URL(page.url()).search);
    assert.deepEqual(await said(again), left, name);
    await closePage(again);
    await closePage(page);
  }
});
