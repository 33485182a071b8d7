// The verdicts in the automaton: the three sets, a target's way with its break, and what forgiving
// changes.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  closePage,
  drawn,
  evaluated,
  openPage,
  parameters,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let job;
let tfa;
before(async () => {
  browser = await startBrowser();
  const found = await evaluated();
  job = found.job;
  ({ tfa } = found.report.result);
});
after(() => browser.close());

async function open(more = "") {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=verdicts${more}`);
  await page.locator(".sets").waitFor();
  return page;
}

test("the three sets hold the targets of the report", async () => {
  const page = await open();
  for (const name of ["correct", "missed", "false"]) {
    const wanted = tfa.targets
      .filter((target) => target.verdict === name)
      .map((target) => target.truth_id);
    const chips = await page.locator(`.set-${name} .chip`).allInnerTexts();
    assert.deepEqual(chips, wanted.slice(0, 40));
    assert.match(
      await page.locator(`.set-${name} h2`).innerText(),
      new RegExp(`\\b${wanted.length}$`),
    );
  }
  await closePage(page);
});

test("the way of a false target breaks at the scan of its verdict, and the break leads there", async () => {
  const wrong = tfa.targets.filter((target) => target.verdict === "false").at(-1);
  const page = await open();
  await page.getByRole("link", { name: `Way of target ${wrong.truth_id}`, exact: true }).click();
  assert.equal(parameters(page).get("truth"), wrong.truth_id);
  const frame = page.locator(".chart-frame", {
    has: page.getByRole("heading", { name: `Target ${wrong.truth_id} in the automaton` }),
  });
  await frame.locator("svg.drawing").waitFor();
  const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n")
    .slice(1)
    .map((line) => line.split(","));
  const broken = csv.find((row) => row[4] === "break");
  assert.deepEqual(
    [Number(broken[0]), broken[2], broken[3]],
    [wrong.at_scan, wrong.expected ?? "", wrong.took_kind === "epsilon" ? "ε" : wrong.took],
  );
  assert.ok(csv.filter((row) => Number(row[0]) < wrong.at_scan).every((row) => row[4] === "yes"));
  const mark = frame.getByRole("link", { name: `Break at scan ${wrong.at_scan}` });
  await mark.focus();
  await page.keyboard.press("Enter");
  await page.locator(".plan canvas").first().waitFor();
  assert.equal(Number(parameters(page).get("time")), wrong.at_time_s);
  assert.equal(parameters(page).get("track"), wrong.track_id);
  await closePage(page);
});

test("the way of a correct target is accepted to its end", async () => {
  const right = tfa.targets.find((target) => target.verdict === "correct");
  const page = await open(`&truth=${right.truth_id}`);
  const region = page.getByRole("region", {
    name: `Way of target ${right.truth_id} through the automaton`,
  });
  await region.waitFor();
  assert.match(await region.getAttribute("aria-label"), /accepted to its end/);
  assert.ok((await region.locator(".state-node-accepted").count()) > 0);
  assert.equal(await region.locator(".lane-break").count(), 0);
  await closePage(page);
});

test("tolerance: as many correct targets for each k as the report says", async () => {
  const page = await open();
  const frame = page.locator(".chart-frame", {
    has: page.getByRole("heading", { name: "Tolerance" }),
  });
  await drawn(frame);
  await frame.getByRole("button", { name: "Table" }).click();
  const rows = await frame
    .locator("tbody tr")
    .evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.innerText)));
  assert.deepEqual(
    rows,
    tfa.tolerance.map(({ k, correct, probability }) => [
      String(k),
      String(correct),
      shown(probability),
    ]),
  );
  await closePage(page);
});
