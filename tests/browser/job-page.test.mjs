// The job page: clock, selection, verdicts, links that show the same again, exports, themes.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { closePage, evaluated, openPage, parameters, saved, startBrowser } from "./support.mjs";

/** The address is written when the hand rests; a busy machine may rest in the middle of a drag. */
const AT_REST_MS = 700;

let browser;
let job;
let report;
before(async () => {
  browser = await startBrowser();
  ({ job, report } = await evaluated());
});
after(() => browser.close());

const planOf = (page) => page.locator(".plan canvas").first();
const clockText = (page) => page.locator(".clock-text").innerText();

async function openPlan(more = "") {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan${more}`);
  await planOf(page).waitFor();
  return page;
}

test("the clock plays, steps by button and by key, and the address follows", async () => {
  const page = await openPlan();
  assert.match(await clockText(page), /scan 30\/30/);
  assert.equal(parameters(page).get("time"), null, "without a time the clock stands at the end");
  await page.getByRole("button", { name: "To the first scan" }).click();
  assert.match(await clockText(page), /scan 1\/30/);
  await page.getByRole("button", { name: "One scan forward" }).click();
  assert.equal(parameters(page).get("time"), "8");
  await page.keyboard.press("ArrowRight");
  assert.match(await clockText(page), /scan 3\/30/);
  await page.keyboard.press("ArrowLeft");
  assert.match(await clockText(page), /scan 2\/30/);
  await page.locator("h1").click();
  await page.keyboard.press(" ");
  await page.getByRole("button", { name: "Pause" }).waitFor();
  await page.waitForFunction(() =>
    /scan ([5-9]|\d\d)\/30/.test(document.querySelector(".clock-text")?.textContent ?? ""),
  );
  await page.keyboard.press(" ");
  await page.getByRole("button", { name: "Play" }).waitFor();
  const stood = await clockText(page);
  await page.waitForTimeout(500);
  assert.equal(await clockText(page), stood, "a paused clock stands still");
  assert.ok(Number(parameters(page).get("time")) >= 32);
  await closePage(page);
});

test("a verdict leads to the scan that decided it, and its address shows the same in a fresh browser", async () => {
  const wrong = report.result.tfa.targets.find((target) => target.verdict === "false");
  assert.ok(wrong, "the dense scene has a false verdict");
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=verdicts&verdict=false`);
  const rows = page.locator(".verdict-row");
  await rows.first().waitFor();
  assert.equal(await rows.count(), report.result.tfa.counts.false);
  const row = rows.filter({
    has: page.getByRole("button", { name: `Show ${wrong.truth_id} in the plan view` }),
  });
  await row.getByRole("button").focus();
  await page.keyboard.press("Enter");
  await planOf(page).waitFor();
  const address = parameters(page);
  assert.equal(Number(address.get("time")), wrong.at_time_s);
  assert.equal(address.get("truth"), wrong.truth_id);
  assert.equal(address.get("track"), wrong.track_id);
  const texts = (await clockText(page)) + (await page.locator(".selection").innerText());
  assert.match(texts, new RegExp(`At scan ${wrong.at_scan} track ${wrong.track_id}`));
  const again = await openPage(browser, new URL(page.url()).search);
  await planOf(again).waitFor();
  for (const each of [page, again]) {
    await each.locator(".probability-canvas canvas").first().waitFor();
    await each.mouse.move(0, 0);
    await each.waitForTimeout(300);
  }
  assert.equal(await clockText(again), await clockText(page));
  const [one, two] = await Promise.all([planOf(page).screenshot(), planOf(again).screenshot()]);
  assert.ok(one.equals(two), "the plan view looks the same, pixel by pixel");
  await page.goBack();
  await rows.first().waitFor();
  await closePage(again);
  await closePage(page);
});

test("verdicts are filtered and sorted, and the address says so", async () => {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=verdicts`);
  const rows = page.locator(".verdict-row");
  await rows.first().waitFor();
  assert.equal(await rows.count(), Math.min(report.result.tfa.targets.length, 200));
  await page.getByRole("button", { name: "Errors" }).click();
  await page.getByRole("button", { name: "Errors" }).click();
  assert.equal(parameters(page).get("sort"), "-errors");
  const errors = await page.locator(".verdict-row td:nth-child(7)").allInnerTexts();
  const most = Math.max(...report.result.tfa.targets.map((target) => target.errors));
  assert.equal(Number(errors[0]), most);
  await page.keyboard.press("Escape");
  await page.locator("h1").click();
  await page.keyboard.press("/");
  const { truth_id } = report.result.tfa.targets[0];
  await page.keyboard.type(truth_id);
  await page.waitForFunction(
    (id) => new URLSearchParams(location.search).get("find") === id,
    truth_id,
  );
  assert.ok((await rows.count()) >= 1);
  await closePage(page);
});

/** Waits until the page has handled what the mouse and the keys did. */
const idle = (page) => page.evaluate(() => new Promise((done) => requestIdleCallback(done)));

/** Waits until a parameter of the address has left this value and stays at another. */
async function atRest(page, name, before) {
  await page.waitForFunction(
    ([of, value]) => new URLSearchParams(location.search).get(of) !== value,
    [name, before],
  );
  let seen;
  while (seen !== parameters(page).get(name)) {
    seen = parameters(page).get(name);
    await idle(page);
    await page.waitForTimeout(AT_REST_MS);
  }
}

/**
 * East and north metres per pixel, read from two points that a drag of the plan view leaves in the
 * address.
 */
async function draggedBy(page, dx, dy) {
  const centre = async () => parameters(page).get("centre").split(",").map(Number);
  const box = await planOf(page).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const before = parameters(page).get("centre");
  const start = await centre();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps: 4 });
  await page.mouse.up();
  await atRest(page, "centre", before);
  const end = await centre();
  return [Math.abs(end[0] - start[0]), Math.abs(end[1] - start[1])];
}

test("one metre east is as long as one metre north, also after a zoom and in a narrow window", async () => {
  const page = await openPlan();
  for (const size of [
    { width: 1440, height: 900 },
    { width: 420, height: 800 },
  ]) {
    await page.setViewportSize(size);
    await page.locator(".plan-touch").scrollIntoViewIfNeeded();
    const before = parameters(page).get("span");
    await page.getByRole("button", { name: "Zoom in" }).click();
    await atRest(page, "span", before);
    const [east] = await draggedBy(page, 80, 0);
    const [, north] = await draggedBy(page, 0, 80);
    assert.ok(Math.abs(east / north - 1) < 0.01, `80 px are ${east} m east and ${north} m north`);
  }
  await closePage(page);
});

test("a drag goes on while the address is written, and loses nothing", async () => {
  const page = await openPlan();
  const everything = parameters(page).get("span");
  await page.getByRole("button", { name: "Zoom in" }).click();
  await atRest(page, "span", everything);
  const [whole] = await draggedBy(page, 60, 0);
  const before = parameters(page).get("centre");
  const box = await planOf(page).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  // The pointer moves in the moment after the address has changed, before the page is drawn again.
  await page.evaluate(
    ([clientX, clientY]) => {
      const write = history.replaceState.bind(history);
      history.replaceState = (...all) => {
        history.replaceState = write;
        write(...all);
        const options = { pointerId: 1, bubbles: true, clientX, clientY };
        const move = new PointerEvent("pointermove", options);
        queueMicrotask(() => document.querySelector(".plan-touch").dispatchEvent(move));
      };
    },
    [x + 40, y],
  );
  await page.mouse.move(x + 20, y);
  await page.waitForFunction(
    (old) => new URLSearchParams(location.search).get("centre") !== old,
    before,
  );
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done))));
  await page.mouse.move(x + 60, y);
  await page.mouse.up();
  await atRest(page, "centre", before);
  const [from, to] = [before, parameters(page).get("centre")].map((text) =>
    Number(text.split(",")[0]),
  );
  assert.ok(Math.abs(Math.abs(to - from) / whole - 1) < 0.01, `${to - from} m are not ${whole} m`);
  await closePage(page);
});

test("legend, selection and trail are in the address", async () => {
  const page = await openPlan();
  await page.getByRole("button", { name: "truth", exact: true }).click();
  assert.equal(parameters(page).get("hide"), "truth");
  await page.getByLabel("Trail").selectOption("5");
  const { track_id } = report.result.tfa.output_tracks[0];
  await page.locator(".selection").getByLabel("Track").selectOption(track_id);
  assert.equal(parameters(page).get("track"), track_id);
  await page.getByRole("heading", { name: `Association probability, ${track_id}` }).waitFor();
  await page.locator(".probability-canvas canvas").first().waitFor();
  assert.match(
    await page.locator(".probability-canvas canvas").first().getAttribute("aria-label"),
    new RegExp(`track ${track_id} `),
  );
  assert.equal(parameters(page).get("trail"), "5");
  await closePage(page);
});

test("a chart is exported as PNG and CSV, and has a table twin with the same rows", async () => {
  const page = await openPlan("&time=0");
  const frame = page.locator(".plan");
  await page.waitForTimeout(AT_REST_MS);
  const drawn = await planOf(page).screenshot();
  const csv = await saved(page, frame.getByRole("button", { name: "CSV" }));
  assert.match(csv.name, /^plan-.*\.csv$/);
  const lines = csv.bytes.toString().trim().split("\r\n");
  assert.equal(lines[0], "layer,id,time_s,x_m,y_m,detail");
  assert.ok(
    lines.slice(1).every((line) => line.split(",")[2] === "0"),
    "only what is drawn at the clock's time",
  );
  const png = await saved(page, frame.getByRole("button", { name: "PNG" }));
  assert.deepEqual([...png.bytes.subarray(1, 4)], [...Buffer.from("PNG")]);
  await frame.getByRole("button", { name: "Table" }).click();
  assert.equal(await frame.locator("tbody tr").count(), Math.min(lines.length - 1, 200));
  await frame.getByRole("button", { name: "Chart" }).click();
  await planOf(page).waitFor();
  await page.mouse.move(0, 0);
  await page.waitForTimeout(AT_REST_MS);
  assert.ok(
    drawn.equals(await planOf(page).screenshot()),
    "back from the table the same picture stands",
  );
  await closePage(page);
});

test("the theme changes the page and its charts, and stays in the address", async () => {
  const page = await openPlan("&theme=light");
  const light = await planOf(page).screenshot();
  await page.getByLabel("Theme").selectOption("dark");
  assert.equal(await page.locator("html").getAttribute("data-theme"), "dark");
  assert.equal(parameters(page).get("theme"), "dark");
  await page.waitForTimeout(300);
  assert.ok(!light.equals(await planOf(page).screenshot()), "the chart is drawn anew");
  await page.getByRole("link", { name: "Summary" }).click();
  assert.equal(parameters(page).get("theme"), "dark");
  await closePage(page);
});
