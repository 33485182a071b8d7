// The ruler of the plan view, by hand and by keyboard, and the gate of a chosen track.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  closePage,
  evaluated,
  openPage,
  parameters,
  saved,
  startBrowser,
} from "./support.mjs";

let browser;
let job;
let report;
before(async () => {
  browser = await startBrowser();
  ({ job, report } = await evaluated(40));
});
after(() => browser.close());

async function open(more = "") {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan${more}`);
  await page.locator(".plan canvas").first().waitFor();
  await page.locator(".plan-touch").scrollIntoViewIfNeeded();
  return page;
}

/**
 * Waits until the address has this many coordinates; a page behind another hears of a press a
 * little later.
 */
const pointsAre = (page, count) =>
  page.waitForFunction(
    (wanted) => new URLSearchParams(location.search).get("ruler").split(",").length === wanted,
    count,
  );
const result = (page) => page.locator(".ruler-result").innerText();

test("two presses measure, in metres as the camera says, and the address shows the same elsewhere", async () => {
  const page = await open("&centre=0,0&span=10000");
  await page.getByRole("button", { name: "Ruler" }).click();
  assert.equal(parameters(page).get("ruler"), "on");
  const box = await page.locator(".plan canvas").first().boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.click(x, y);
  await pointsAre(page, 2);
  await page.mouse.click(x + 100, y - 100);
  await pointsAre(page, 4);
  const [x0, y0, x1, y1] = parameters(page).get("ruler").split(",").map(Number);
  // 10 000 m lie across the shorter side of the drawing area; margins are 72 px wide and 54 px
  // high.
  const scale = 10_000 / Math.min(box.width - 72, box.height - 54);
  assert.ok(
    Math.abs(x1 - x0 - 100 * scale) < scale && Math.abs(y1 - y0 - 100 * scale) < scale,
    `${x1 - x0}, ${y1 - y0} for ${100 * scale}`,
  );
  const distance = Math.hypot(x1 - x0, y1 - y0);
  assert.match(
    await result(page),
    new RegExp(`^${(distance / 1000).toFixed(3)} km, 4[45]\\.\\d°$`),
  );
  assert.equal(parameters(page).get("track"), null, "a press with the ruler selects nothing");
  const again = await openPage(browser, new URL(page.url()).search);
  await again.locator(".plan canvas").first().waitFor();
  assert.equal(await result(again), await result(page));
  await closePage(again);
  await page.mouse.click(x - 50, y);
  // A third press begins anew.
  await pointsAre(page, 2);
  await closePage(page);
});

test("a drag measures and does not pan; the ruler is put away by key", async () => {
  const page = await open("&centre=0,0&span=10000");
  await page.locator(".plan-touch").focus();
  await page.keyboard.press("r");
  const box = await page.locator(".plan canvas").first().boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y + 120, { steps: 5 });
  await page.mouse.up();
  await pointsAre(page, 4);
  assert.match(await result(page), /, 180\.0°$/);
  assert.equal(parameters(page).get("centre"), "0,0");
  await page.locator(".plan-touch").focus();
  await page.keyboard.press("Escape");
  assert.equal(parameters(page).get("ruler"), null);
  assert.equal(await page.locator(".ruler").count(), 0);
  await closePage(page);
});

test("the keyboard alone measures: 300 m east and 400 m north are 500 m at 36.9°", async () => {
  const page = await open();
  await page.locator(".plan-touch").focus();
  await page.keyboard.press("r");
  for (const [name, value] of [
    ["from x (m)", "1000"],
    ["from y (m)", "-200"],
    ["to x (m)", "1300"],
    ["to y (m)", "200"],
  ]) {
    await page.getByLabel(name).focus();
    await page.keyboard.press("ControlOrMeta+a");
    await page.keyboard.type(value);
    await page.keyboard.press("Tab");
  }
  assert.equal(parameters(page).get("ruler"), "1000,-200,1300,200");
  assert.equal(await result(page), "500.0 m, 36.9°");
  await page.getByRole("button", { name: "Put away" }).press("Enter");
  assert.equal(parameters(page).get("ruler"), null);
  await closePage(page);
});

test("a chosen track shows its gate at the scan, and the legend hides it", async () => {
  const track = report.result.association.tracks.find((line) => line.points > 10).track_id;
  const gates = await api(`/v1/jobs/${job.id}/series/gates?track=${track}`);
  const page = await open(`&track=${track}&time=${gates.columns.time_s[2]}&centre=selection`);
  const frame = page.locator(".plan");
  await frame.getByRole("button", { name: "gate", exact: true }).waitFor();
  const svg = async () =>
    (await saved(page, frame.getByRole("button", { name: "SVG" }))).bytes.toString();
  const dashes = (text) => (text.match(/stroke-dasharray/g) ?? []).length;
  const withGate = dashes(await svg());
  await frame.getByRole("button", { name: "gate", exact: true }).click();
  assert.equal(parameters(page).get("hide"), "gate");
  assert.ok(dashes(await svg()) < withGate, "the dashed curve is gone");
  await closePage(page);
});
