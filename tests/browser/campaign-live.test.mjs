// A campaign that goes on: its table and charts grow, stay when it is canceled, and become the
// report's when it ends.

import assert from "node:assert/strict";
import { mkdir } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import {
  api,
  assertNothingSticksOut,
  campaign,
  cellTexts,
  closePage,
  ended,
  findings,
  finished,
  frameOf,
  gridOf,
  hide,
  NARROW,
  openPage,
  parameters,
  seeAll,
  shown,
  startBrowser,
  WIDE,
} from "./support.mjs";

const FOLDER = process.env.TRACKLOOM_SCREENSHOTS ?? join(tmpdir(), "trackloom-pictures");
const CELLS = 6;
const SLOW_MS = 300;

let browser;
before(async () => {
  browser = await startBrowser();
  await mkdir(FOLDER, { recursive: true });
});
after(() => browser.close());

const start = async (runs, name) =>
  (await api("/v1/jobs/campaign", { ...(await campaign(runs)), name })).id;

/** Runs that the page says are made, and that its grid says each cell has, at one moment. */
function told(page) {
  return page.evaluate(() => {
    const whole = (text) => Number(text.replaceAll(",", "").match(/\d+/)[0]);
    const cells = [...document.querySelectorAll(".grid-cell")].map((cell) =>
      whole(cell.querySelector(".sub:last-child").textContent),
    );
    return { runs: whole(document.querySelector(".how-far b").textContent), cells };
  });
}

const growsBeyond = (page, runs) =>
  page.waitForFunction(
    (least) =>
      Number(
        document.querySelector(".how-far b")?.textContent.replaceAll(",", "").match(/\d+/)?.[0] ??
          0,
      ) > least,
    runs,
    { timeout: 60_000 },
  );

/** As many runs of each cell as take about twenty seconds of one worker, ten chunks. */
async function tenChunks() {
  const runs = 200;
  const { job } = await finished("campaign", {
    ...(await campaign(runs)),
    seed: 77,
    timed_runs: 0,
  });
  const took_s = (Date.parse(job.finished_at) - Date.parse(job.started_at)) / 1000;
  return Math.round(runs * Math.min(100, Math.max(2, 12 / took_s)));
}

/** Pictures of a campaign that goes on, with what axe says of it. */
async function lookAtGrowing(id) {
  for (const theme of ["light", "dark"]) {
    const seen = await openPage(browser, `?view=job&job=${id}&theme=${theme}`, WIDE);
    await seen.locator(".how-far b").waitFor();
    assert.deepEqual(await findings(seen), [], theme);
    for (const [width, viewport] of Object.entries({ wide: WIDE, narrow: NARROW })) {
      await seen.setViewportSize(viewport);
      await seeAll(seen);
      await assertNothingSticksOut(seen, `a growing campaign, ${width}`);
      await seen.screenshot({
        path: join(FOLDER, `campaign-growing-${theme}-${width}.png`),
        fullPage: true,
      });
    }
    await closePage(seen);
  }
}

/** The same of one that was canceled. */
async function lookAtKept(id) {
  for (const [theme, viewport] of [
    ["light", NARROW],
    ["dark", WIDE],
  ]) {
    const seen = await openPage(browser, `?view=job&job=${id}&theme=${theme}`, viewport);
    await seen.locator(".grid-cell").first().waitFor();
    await seeAll(seen);
    assert.deepEqual(await findings(seen), [], theme);
    await assertNothingSticksOut(seen, `a canceled campaign, ${theme}`);
    await seen.screenshot({ path: join(FOLDER, `campaign-kept-${theme}.png`), fullPage: true });
    await closePage(seen);
  }
}

/** A campaign whose process has crashed keeps its numbers, too. */
async function assertKeptByCrash(id, address, cells) {
  const crashed = await openPage(browser, "", WIDE);
  const error = {
    type: "about:blank",
    title: "The job ended its process",
    status: 500,
    code: "crashed",
    detail: "Runs from the third on were given up.",
  };
  await crashed.route(`**/v1/jobs/${id}`, async (route) =>
    route.fulfill({ json: { ...(await api(`/v1/jobs/${id}`)), state: "failed", error } }),
  );
  await crashed.goto(address);
  await crashed.getByText(error.detail).waitFor();
  await crashed.locator(".grid-cell").first().waitFor();
  assert.deepEqual(await gridOf(crashed, "GOSPA"), cells);
  assert.equal(
    await crashed.getByRole("button", { name: "Rerun: make the missing runs" }).count(),
    1,
  );
  await closePage(crashed);
}

/** The grid and the table of a campaign that has ended are those of its report. */
async function assertReported(page, id, runs) {
  const { result } = await api(`/v1/jobs/${id}/report`);
  assert.deepEqual(
    result.cells.map((cell) => [cell.runs, cell.ended]),
    Array(CELLS).fill([runs, "runs"]),
  );
  assert.deepEqual(await gridOf(page, "GOSPA"), cellTexts(result, "GOSPA", runs));
  const rows = await frameOf(page, "All outcomes")
    .locator("tbody tr")
    .evaluateAll((all) =>
      all.map((row) => [...row.cells].map((cell) => cell.firstChild.textContent)),
    );
  assert.deepEqual(
    rows,
    result.cells.map((cell) => [
      cell.name,
      runs.toLocaleString("en-US"),
      ...result.outcomes.map((name) => shown(cell.outcomes[name].mean)),
    ]),
  );
}

test("while it runs, means, intervals, curves and differences grow; a hidden page does not ask", async () => {
  const runs = 100_000;
  const id = await start(runs, "growing");
  const page = await openPage(browser, `?view=job&job=${id}&outcome=GOSPA&x=associator`);
  const asked = [];
  // An answer that takes a while: the next question has to wait ten times as long.
  await page.route("**/cells", (route) =>
    new Promise((wake) => setTimeout(wake, SLOW_MS)).then(() => route.continue()),
  );
  const isCells = (request) => new URL(request.url()).pathname === `/v1/jobs/${id}/cells`;
  page.on("request", (request) => isCells(request) && asked.push({ begun: performance.now() }));
  page.on("requestfinished", (request) => {
    // What the page asked before these listeners stood has no beginning.
    const last = asked.at(-1);
    if (last && isCells(request)) last.ended = performance.now();
  });
  await page
    .getByText(`of ${(runs * CELLS).toLocaleString("en-US")}; the numbers still move.`)
    .waitFor();
  // With a handful of runs an interval is as wide as the chart, or there is none.
  await growsBeyond(page, 20 * CELLS);
  const early = await told(page);
  assert.equal(early.cells.length, CELLS);
  assert.equal(
    early.cells.reduce((sum, each) => sum + each, 0),
    early.runs,
  );
  for (const text of await gridOf(page, "GOSPA"))
    assert.match(text, /^[\d.]+\n\[-?[\d.]+, [\d.]+\]\n[\d,]+ of 100,000 runs$/);
  await frameOf(page, "GOSPA over associator").locator(".category-dots").waitFor();
  assert.equal(await frameOf(page, "Paired differences: GOSPA").locator("tbody tr").count(), 3);
  await growsBeyond(page, early.runs);
  const later = await told(page);
  assert.ok(
    later.cells.every((each, index) => each > early.cells[index]),
    `${later.cells} after ${early.cells}`,
  );
  await growsBeyond(page, later.runs);
  assert.deepEqual(
    [parameters(page).get("outcome"), parameters(page).get("x")],
    ["GOSPA", "associator"],
  );
  for (const [index, { begun }] of asked.slice(1).entries())
    assert.ok(
      begun - asked[index].ended > 10 * SLOW_MS - 100,
      `asked again ${begun - asked[index].ended} ms after the answer`,
    );

  await hide(page, true);
  await page.waitForTimeout(1000);
  const before = asked.length;
  await page.waitForTimeout(6000);
  assert.equal(asked.length, before, "nobody looks");
  const { runs: left } = await told(page);
  await hide(page, false);
  await growsBeyond(page, left);
  await closePage(page);

  await lookAtGrowing(id);
  await api(`/v1/jobs/${id}/cancel`, {});
});

test("canceled, its numbers stay; a rerun makes the other runs and ends with the report in the same places", async () => {
  const runs = await tenChunks();
  const id = await start(runs, "ten chunks");
  const page = await openPage(browser, `?view=job&job=${id}&outcome=GOSPA`);
  await page.locator(".how-far b").waitFor();
  await growsBeyond(page, (await told(page)).runs);
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByText("This job was canceled. Runs made:").waitFor();
  const kept = await api(`/v1/jobs/${id}/cells`);
  assert.equal(kept.is_final, false);
  await page.waitForFunction(
    (made) =>
      Number(
        document.querySelector(".how-far b")?.textContent.replaceAll(",", "").match(/\d+/)[0],
      ) === made,
    kept.runs,
  );
  assert.deepEqual(await gridOf(page, "GOSPA"), cellTexts(kept.result, "GOSPA", runs));
  assert.equal(await page.getByRole("button", { name: "Rerun" }).count(), 1);
  await page.reload();
  await page.getByText("They are kept.").waitFor();
  await page.locator(".grid-cell").first().waitFor();
  assert.deepEqual(await gridOf(page, "GOSPA"), cellTexts(kept.result, "GOSPA", runs));
  await lookAtKept(id);
  await assertKeptByCrash(id, page.url(), cellTexts(kept.result, "GOSPA", runs));

  await page.getByRole("button", { name: "Rerun: make the missing runs" }).click();
  await page.getByText("; the numbers still move.").waitFor();
  const again = parameters(page).get("job");
  assert.notEqual(again, id);
  assert.equal(parameters(page).get("outcome"), "GOSPA");
  const first = await told(page);
  assert.ok(first.runs >= kept.runs, `${first.runs} runs after ${kept.runs}`);
  const frame = frameOf(page, "Cells: GOSPA");
  const place = async () => Math.round((await frame.boundingBox()).y);
  const top = await place();
  await frame.evaluate((element) => (element.seen = true));
  assert.equal((await ended(again)).state, "succeeded");
  await page.getByRole("heading", { name: "Time of deciding", exact: true }).waitFor();
  assert.ok(await frame.evaluate((element) => element.seen === true), "it is the same table");
  assert.ok(
    Math.abs((await place()) - top) <= 2,
    `the table has moved from ${top} to ${await place()}`,
  );

  await assertReported(page, again, runs);
  await closePage(page);
});
