// How probable each motion model was, where a filter has several: drawn, and as in the file of tracks.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { twinOf } from "./reading.mjs";
import {
  closePage,
  decodedPng,
  drawn,
  finished,
  frameOf,
  linesOf,
  openPage,
  paletteColor,
  preset,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let several;
let one;
before(async () => {
  browser = await startBrowser();
  const body = await preset("atc-maneuver");
  several = await finished("evaluate", body);
  const filter = { method: "kalman", process_noise_m2ps3: 20 };
  one = await finished("evaluate", { ...body, filter });
});
after(() => browser.close());

test("models are stacked by their probabilities, as in the file", async () => {
  const page = await openPage(browser, `?view=job&job=${several.job.id}&tab=plan&track=1`);
  const frame = frameOf(page, "Motion models, 1");
  await drawn(frame);
  const [columns, ...lines] = await linesOf(several.job, "tracks.csv");
  const all = lines.map((line) => Object.fromEntries(columns.map((name, at) => [name, line[at]])));
  const rows = all.filter((row) => row.track_id === "1");
  const mean = (name) => rows.reduce((sum, row) => sum + Number(row[name]), 0) / rows.length;
  const png = await saved(page, frame.getByRole("button", { name: "PNG" }));
  const inked = async (color) =>
    (await decodedPng(page, png.bytes, await paletteColor(page, color, 0.55))).colored;
  const [straight, turning] = [await inked("--chart-track"), await inked("--chart-sensor-1")];
  assert.ok(straight > 500, `${straight} pixels of straight flight`);
  const share = turning / (straight + turning);
  assert.ok(Math.abs(share - mean("mode_2")) < 0.08, `${share} drawn, ${mean("mode_2")} meant`);
  const twin = await twinOf(page, "Motion models, 1");
  const wanted = rows.flatMap((row) =>
    [1, 2].map((model) => [
      shown(Number(row.time_s)),
      "1",
      `${model}`,
      shown(Number(row[`mode_${model}`])),
    ]),
  );
  assert.deepEqual(twin, wanted);
  await closePage(page);
});

test("a filter of one model has no such picture", async () => {
  const page = await openPage(browser, `?view=job&job=${one.job.id}&tab=plan&track=1`);
  await page.getByRole("heading", { name: "Association probability, 1" }).waitFor();
  assert.equal(await page.getByRole("heading", { name: "Motion models, 1" }).count(), 0);
  await closePage(page);
});
