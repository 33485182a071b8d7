// The correlation of a job: its numbers are those of the report, a tuple leads to the plan view,
// and the form knows the kind.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  byPointer,
  closePage,
  correlated,
  drawn,
  ended,
  finished,
  linesOf,
  openPage,
  parameters,
  preset,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let job;
let result;
let spec;
before(async () => {
  browser = await startBrowser();
  const found = await correlated();
  job = found.job;
  ({ result, spec } = found.report);
});
after(() => browser.close());

async function open(more = "") {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=correlation${more}`);
  await page.locator(".tuples tbody tr").first().waitFor();
  return page;
}

const figure = (page, name) =>
  page
    .locator(".figure", { has: page.locator("dt", { hasText: name }) })
    .locator("b")
    .first()
    .innerText();

test("cost, bound, gap and what is right are the report's", async () => {
  assert.ok(
    result.truth.tuples_right > 0 && result.truth.tuples_right < result.counts.tuples,
    "some tuples are right, some are wrong",
  );
  const page = await open();
  assert.equal(await figure(page, "Cost J"), shown(result.cost));
  assert.equal(await figure(page, "Dual bound"), shown(result.dual_bound));
  assert.equal(
    await figure(page, "Gap"),
    result.gap < 1e-9 ? "0 %" : `${shown(result.gap * 100)} %`,
  );
  assert.equal(
    await figure(page, "Tuples right"),
    `${result.truth.tuples_right} of ${result.truth.tuples}`,
  );
  assert.equal(await figure(page, "Pairs"), result.truth.pairwise_precision.toFixed(3));
  await closePage(page);
});

test("every tuple stands in the matrix with its tracks, statistic and p-value", async () => {
  const page = await open();
  const rows = await page.$$eval(".tuples tbody tr", (all) =>
    all.map((row) => [...row.cells].map((cell) => cell.innerText.trim())),
  );
  assert.equal(rows.length, result.tuples.length);
  const sensors = result.sensors.length;
  rows.forEach((cells, index) => {
    const tuple = result.tuples[index];
    assert.equal(cells[0], tuple.system_track_id);
    assert.deepEqual(
      cells.slice(1, 1 + sensors),
      tuple.tracks.map((track) => track ?? "absent"),
    );
    const below = tuple.p_value < spec.statistic.alpha;
    assert.deepEqual(cells.slice(1 + sensors, 6 + sensors), [
      shown(tuple.cost),
      shown(tuple.b),
      shown(tuple.statistic),
      String(tuple.degrees_of_freedom),
      below ? cells[5 + sensors] : shown(tuple.p_value),
    ]);
    assert.equal(cells.at(-1), tuple.right ? "right" : "wrong");
  });
  await page.getByRole("combobox", { name: "Tuples" }).selectOption("wrong");
  assert.equal(parameters(page).get("tuples"), "wrong");
  assert.equal(
    await page.locator(".tuples tbody tr").count(),
    result.tuples.filter((tuple) => !tuple.right).length,
  );
  await closePage(page);
});

test("the p-values and the search are charts with a table twin and files", async () => {
  const page = await open();
  const chart = page.locator(".chart-frame", {
    hasText: "How well the tracks of each tuple agree",
  });
  await drawn(chart);
  const csv = await saved(page, chart.getByRole("button", { name: "CSV" }));
  assert.equal(csv.bytes.toString().trim().split("\r\n").length, result.tuples.length + 1);
  const search = page.locator(".chart-frame", { hasText: "generations," });
  await drawn(search);
  const svg = (await saved(page, search.getByRole("button", { name: "SVG" }))).bytes.toString();
  assert.match(svg, /^<svg [^>]*xmlns/);
  for (const name of ["Search", "best", "mean", "generation"])
    assert.ok(svg.includes(`>${name}<`), `${name} is in the SVG file`);
  const png = await saved(page, search.getByRole("button", { name: "PNG" }));
  assert.deepEqual([...png.bytes.subarray(1, 4)], [...Buffer.from("PNG")]);
  await search.getByRole("button", { name: "Table" }).click();
  const last = (await search.locator("tbody tr").last().innerText())
    .split("\t")
    .map((text) => text.trim());
  assert.deepEqual(last, [
    String(result.search.generations),
    shown(result.search.best.at(-1)),
    shown(result.search.mean.at(-1)),
  ]);
  await closePage(page);
});

test("a tuple leads to the plan view, where its system track and the local tracks are drawn", async () => {
  const page = await open();
  const wrong = result.tuples.find((tuple) => !tuple.right);
  await page
    .getByRole("button", { name: `Show system track ${wrong.system_track_id} in the plan view` })
    .focus();
  await page.keyboard.press("Enter");
  await page.locator(".plan canvas").first().waitFor();
  assert.equal(parameters(page).get("track"), wrong.system_track_id);
  const note = await page
    .locator(".panel", { hasText: `Tuple ${wrong.system_track_id}` })
    .innerText();
  assert.ok(
    note.includes("wrong") &&
      note.includes(shown(wrong.p_value)) &&
      note.includes(shown(wrong.cost)),
    note,
  );
  for (const { sensor_id } of result.sensors)
    await page.getByRole("button", { name: `tracks of ${sensor_id}` }).waitFor();
  const csv = (await saved(page, page.locator(".plan").getByRole("button", { name: "CSV" }))).bytes
    .toString()
    .trim()
    .split("\r\n")
    .slice(1);
  const ofLayer = (name) =>
    csv.filter((line) => line.startsWith(`${name},`)).map((line) => line.split(",")[1]);
  assert.equal(new Set(ofLayer("track")).size, result.counts.system_tracks);
  const local = await linesOf(job, "local_tracks.csv");
  assert.equal(ofLayer("local track").length, local.length - 1);
  await page.goBack();
  await page.locator(".tuples tbody tr").first().waitFor();
  await closePage(page);
});

test("a search that knows the answer at once says so", async () => {
  const body = await preset("huo2008");
  const { job: at_once, report } = await finished("correlate", body);
  const page = await openPage(browser, `?view=job&job=${at_once.id}&tab=correlation`);
  await page.locator(".figures").waitFor();
  assert.equal(report.result.search.generations, 1);
  await page
    .getByText(
      `The search ended with its first answers (${report.result.search.stop}): best ${shown(report.result.search.best[0])}`,
    )
    .waitFor();
  assert.equal(await figure(page, "Gap"), "0 %");
  await closePage(page);
});

test("a correlate job is made in the form, from the preset", async () => {
  const page = await openPage(browser, "?view=new");
  await page.getByRole("link", { name: /^huo2008 / }).click();
  await byPointer(page, "/input/tracks/targets").fill("5");
  await byPointer(page, "/correlator/method").selectOption("weighted");
  await byPointer(page, "/name").fill("five targets");
  await page.getByText("The request is valid.").waitFor();
  await page.getByRole("button", { name: /^Submit/ }).click();
  await page.waitForURL(/view=job/);
  const id = parameters(page).get("job");
  assert.equal((await ended(id)).state, "succeeded");
  await page.getByRole("link", { name: "Correlation" }).click();
  await page.locator(".figures").waitFor();
  const report = await api(`/v1/jobs/${id}/report`);
  assert.equal(report.spec.input.tracks.targets, 5);
  assert.equal(await figure(page, "Cost J"), shown(report.result.cost));
  await page.getByText("Weighted does not search by generations").waitFor();
  await closePage(page);
  const list = await openPage(browser, "?kind=correlate&q=five+targets");
  await list.locator("tbody tr").first().waitFor();
  await closePage(list);
});
