// Bearings over time, and how searches went: the bat algorithm's objective, the memberships of
// fuzzy c-means.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { traceOf } from "./reading.mjs";
import {
  api,
  bearingsTracked,
  closePage,
  clustered,
  drawn,
  frameOf,
  openPage,
  parameters,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let bearings;
let fuzzy;
before(async () => {
  browser = await startBrowser();
  [bearings, fuzzy] = [await bearingsTracked(), await clustered()];
});
after(() => browser.close());

test("bearings run down the time with truth and tracks over them, up to the clock", async () => {
  const page = await openPage(browser, `?view=job&job=${bearings.job.id}&tab=plan`);
  const frame = frameOf(page, "Bearing–time");
  await drawn(frame);
  const series = await api(`/v1/jobs/${bearings.job.id}/series/bearing_time`);
  const csv = async () =>
    (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
      .toString()
      .trim()
      .split("\r\n")
      .slice(1);
  const limitOf = async () =>
    Number((await page.locator(".clock-text b").innerText()).replace(" s", ""));
  const upTo = (limit) => series.columns.time_s.filter((time) => time <= limit).length;
  assert.equal((await csv()).length, upTo(await limitOf()));
  await page.getByRole("button", { name: "To the first scan" }).click();
  const first = await limitOf();
  assert.equal((await csv()).length, upTo(first));
  assert.ok(upTo(first) < series.columns.time_s.length / 10);
  const levels = frame.getByRole("button", { name: /^levels, .* dB$/ });
  const shaded = await frame.locator("canvas").first().screenshot();
  await levels.click();
  assert.equal(await levels.getAttribute("aria-pressed"), "false");
  await page.waitForTimeout(300);
  assert.ok(
    !shaded.equals(await frame.locator("canvas").first().screenshot()),
    "the record lies under the bearings",
  );
  await levels.click();
  await frame.getByRole("button", { name: "truth", exact: true }).click();
  assert.equal(parameters(page).get("hide"), "truth");
  await closePage(page);
});

test("a track of bearings is chosen and its facts are those of the series", async () => {
  const { track_id } = bearings.report.result.association.tracks[0];
  const page = await openPage(browser, `?view=job&job=${bearings.job.id}&tab=plan`);
  await drawn(frameOf(page, "Bearing–time"));
  await page.locator(".selection").getByLabel("Track").selectOption(track_id);
  const { columns } = await api(`/v1/jobs/${bearings.job.id}/series/bearing_time`);
  const last = columns.id.findLastIndex(
    (id, row) => id === track_id && columns.layer[row] === "track",
  );
  const text = await page.locator(".selection").innerText();
  assert.ok(text.includes(`${shown(columns.bearing_deg[last])}°`), text);
  assert.ok(text.includes(`${shown(columns.bearing_rate_degps[last])}°/s`), text);
  await page.getByRole("heading", { name: `Association probability, ${track_id}` }).waitFor();
  await page.getByText("The record as the service drew it").click();
  await page.locator(".record img").waitFor();
  await page.waitForFunction(() => document.querySelector(".record img")?.naturalWidth > 0);
  await closePage(page);
});

test("the search of the bat algorithm is drawn with its optimum, for any cluster", async () => {
  const trace = await traceOf(bearings.job, "association_trace.csv");
  const page = await openPage(browser, `?view=job&job=${bearings.job.id}&tab=search`);
  await page.getByRole("combobox", { name: "Search" }).waitFor();
  const chosen = trace.at(-1);
  const name = `occasion ${chosen.occasion}, cluster ${chosen.cluster}`;
  await page.getByRole("combobox", { name: "Search" }).selectOption(name);
  const frame = frameOf(page, `Convergence, ${name}`);
  await drawn(frame);
  const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n")
    .slice(1);
  const rows = trace.filter(
    (row) => row.occasion === chosen.occasion && row.cluster === chosen.cluster,
  );
  assert.deepEqual(
    csv,
    rows.map((row) => [row.iteration, row.best_j, row.mean_j, row.optimal_j].map(Number).join(",")),
  );
  const told = bearings.report.result.association.diagnostics;
  assert.ok((await page.locator(".diagnostics").innerText()).includes(shown(told.evaluations)));
  await closePage(page);
});

test("memberships of every iteration are the trace's, and sum to one for each detection", async () => {
  const trace = await traceOf(fuzzy.job, "association_trace.csv");
  const page = await openPage(browser, `?view=job&job=${fuzzy.job.id}&tab=search`);
  const frame = frameOf(page, "Memberships");
  await frame.locator("tbody tr").first().waitFor();
  const name = await page.getByRole("combobox", { name: "Search" }).inputValue();
  const [occasion, cluster] = name.match(/\d+/g);
  for (const iteration of ["0", null]) {
    if (iteration !== null) await frame.locator("input[type=range]").fill(iteration);
    const csv = (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes
      .toString()
      .trim()
      .split("\r\n")
      .slice(1)
      .map((line) => line.split(","));
    for (const row of csv) {
      const sum = row.slice(1).reduce((total, cell) => total + Number(cell), 0);
      assert.ok(Math.abs(sum - 1) < 1e-6, `detection ${row[0]}: ${sum}`);
    }
    const number = iteration ?? (await frame.innerText()).match(/Iteration (\d+)/)[1];
    const mine = trace.filter(
      (row) =>
        row.occasion === occasion &&
        row.cluster === cluster &&
        row.iteration === number &&
        row.quantity === "u" &&
        row.track === "",
    );
    assert.deepEqual(
      csv.map((row) => [row[0], Number(row[1])]),
      mine.map((row) => [row.detection, Number(row.value)]),
      "the noise of each detection",
    );
  }
  await closePage(page);
});
