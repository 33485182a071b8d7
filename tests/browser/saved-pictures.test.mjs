// What is saved holds what is shown: charts as pictures and as drawings.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { filmed, recorded } from "./recordings.mjs";
import {
  bearingsTracked,
  campaign,
  closePage,
  clustered,
  correlated,
  decodedPng,
  drawn,
  evaluated,
  finished,
  frameOf,
  hexOf,
  openPage,
  paletteColor,
  parsedSvg,
  saved,
  seeAll,
  startBrowser,
} from "./support.mjs";

const OPACITY = 0.75;

let browser;
let scene;
let harbour;
let video;
let grid;
before(async () => {
  browser = await startBrowser();
  scene = await evaluated();
  harbour = await recorded();
  video = await filmed();
  grid = await finished("campaign", await campaign());
});
after(() => browser.close());

/** Saves every chart of a page both ways and looks into the files. */
async function assertSavedWell(page, name) {
  await seeAll(page);
  const frames = page.locator(".chart-frame", { has: page.getByRole("button", { name: "SVG" }) });
  const count = await frames.count();
  assert.ok(count > 0, `${name} has charts`);
  for (let index = 0; index < count; index++) {
    const frame = frames.nth(index);
    const title = await frame.locator("h2").innerText();
    await frame.scrollIntoViewIfNeeded();
    await frame.locator("canvas, svg.drawing").first().waitFor();
    const svg = await parsedSvg(
      page,
      (await saved(page, frame.getByRole("button", { name: "SVG" }))).bytes,
    );
    assert.equal(svg.fault, undefined, `${name}, ${title}: ${svg.fault}`);
    assert.ok(
      svg.texts.some((text) => text.startsWith(title)),
      `${title} stands in its file: ${svg.texts}`,
    );
    const png = await decodedPng(
      page,
      (await saved(page, frame.getByRole("button", { name: "PNG" }))).bytes,
    );
    assert.ok(png.ink > 2000, `${name}, ${title}: ${png.ink} pixels of ink`);
    // The key of the page stands in the file, name by name.
    const names = await frame.locator(".curve-key").allInnerTexts();
    for (const each of names)
      assert.ok(svg.texts.includes(each.trim()), `${title}: ${each} in ${svg.texts}`);
    assert.equal(
      (await frame.locator("canvas").count()) === 0 || !/e\+9/.test(svg.texts.join(" ")),
      true,
      `${title}: times can be read`,
    );
  }
  return count;
}

test("every chart is saved as a file that an XML parser takes and as a picture with ink", async () => {
  const [tuples, bearings, fuzzy] = [
    await correlated(),
    await bearingsTracked(),
    await clustered(),
  ];
  const { track_id } = scene.report.result.association.tracks[0];
  const views = {
    summary: `?view=job&job=${scene.job.id}`,
    plan: `?view=job&job=${scene.job.id}&tab=plan&track=${track_id}`,
    verdicts: `?view=job&job=${scene.job.id}&tab=verdicts`,
    metrics: `?view=job&job=${scene.job.id}&tab=metrics`,
    "recording, plan": `?view=job&job=${harbour.job.id}&tab=plan`,
    "recording, metrics": `?view=job&job=${harbour.job.id}&tab=metrics`,
    video: `?view=job&job=${video.job.id}&tab=metrics`,
    correlation: `?view=job&job=${tuples.job.id}&tab=correlation`,
    bearings: `?view=job&job=${bearings.job.id}&tab=plan`,
    search: `?view=job&job=${fuzzy.job.id}&tab=search`,
    campaign: `?view=job&job=${grid.job.id}`,
  };
  let charts = 0;
  for (const [name, query] of Object.entries(views)) {
    const page = await openPage(browser, query);
    await page.locator(".chart-frame").first().waitFor();
    charts += await assertSavedWell(page, name);
    await closePage(page);
  }
  assert.ok(charts >= 16, `${charts} charts`);
});

test("a saved plan has every detection, however many are in view", async () => {
  const many = await evaluated(300);
  const detections = many.report.result.association.counts.detections;
  assert.ok(detections > 2000, `${detections} detections`);
  const page = await openPage(
    browser,
    `?view=job&job=${many.job.id}&tab=plan&hide=tracks,truth,rings&theme=light`,
  );
  await page.locator(".plan canvas").first().waitFor();
  const color = await paletteColor(page, "--chart-sensor-1", OPACITY);
  const frame = page.locator(".plan");
  const png = await decodedPng(
    page,
    (await saved(page, frame.getByRole("button", { name: "PNG" }))).bytes,
    color,
  );
  // A dot is 6 pixels wide; many lie over each other.
  assert.ok(png.colored > 4 * detections, `${png.colored} pixels of ${detections} detections`);
  const svg = await parsedSvg(
    page,
    (await saved(page, frame.getByRole("button", { name: "SVG" }))).bytes,
  );
  const dots = svg.places[`fill ${await hexOf(page, "--chart-sensor-1")}`];
  // One of them is the mark of the key.
  assert.equal(dots, detections + 1);
  await page.getByRole("button", { name: /^detections/ }).click();
  const empty = await decodedPng(
    page,
    (await saved(page, frame.getByRole("button", { name: "PNG" }))).bytes,
    color,
  );
  assert.ok(empty.colored < 20, `${empty.colored} pixels without detections`);
  await closePage(page);
});

test("a saved chart has no slider, and its marks are those of the page", async () => {
  const { track_id } = scene.report.result.association.tracks[0];
  const page = await openPage(
    browser,
    `?view=job&job=${scene.job.id}&tab=plan&track=${track_id}&theme=light`,
  );
  const frame = frameOf(page, `Association probability, ${track_id}`);
  await drawn(frame);
  const text = (await saved(page, frame.getByRole("button", { name: "SVG" }))).bytes.toString();
  const track = await hexOf(page, "--chart-track");
  assert.ok(
    !new RegExp(`fill="(${track}22|rgba)`).test(text) && !/fill-opacity="0\.13/.test(text),
    "the field of the slider",
  );
  const marks = await frame
    .locator(".curve-key path:last-child")
    .evaluateAll((all) => all.map((path) => path.getAttribute("d")));
  assert.ok(marks.length >= 3, `${marks.length} marks`);
  for (const mark of marks) assert.ok(text.includes(`d="${mark}"`), `${mark} in the file`);
  await closePage(page);
});
