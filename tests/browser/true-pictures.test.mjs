// Pictures that are true: axes and intervals stay within what is possible, times can be read, what
// has ended is not drawn as living, and words say what happened.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { dataset, filmed, recorded } from "./recordings.mjs";
import {
  api,
  BASE,
  byPointer,
  campaign,
  closePage,
  correlated,
  drawn,
  evaluated,
  finished,
  frameOf,
  hexOf,
  linesOf,
  openPage,
  parameters,
  parsedSvg,
  preset,
  saved,
  seeAll,
  shown,
  startBrowser,
} from "./support.mjs";

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

test("times of a recording can be read everywhere, and are whole where they are taken away", async () => {
  const { job } = harbour;
  const start = (await api(`/v1/jobs/${job.id}/plan`)).scans[0].time_s;
  const utc = new Date(Math.round(start * 1000)).toISOString();
  const head = `${utc.slice(0, 10)} ${utc.slice(11, 23)} UTC`;
  for (const tab of ["", "&tab=plan&track=3", "&tab=verdicts", "&tab=metrics&event=match"]) {
    const page = await openPage(browser, `?view=job&job=${job.id}${tab}`);
    await page.locator(".chart-frame").first().waitFor();
    await seeAll(page);
    assert.doesNotMatch(await page.locator("main").innerText(), /\de\+9/, tab);
    const buttons = page.getByRole("button", { name: "Table", exact: true });
    // A pressed one is called "Chart".
    while (await buttons.count()) await buttons.first().click();
    assert.doesNotMatch(await page.locator("main").innerText(), /\de\+9|\b1620\d{6}/, tab);
    await closePage(page);
  }
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=metrics&event=match`);
  const table = frameOf(page, "Events");
  await table.locator("tbody tr").first().waitFor();
  const log = (await linesOf(job, "events.csv")).slice(1);
  const times = log.filter((row) => row[2] === "match").map((row) => Number(row[1]));
  const cells = await table.locator("tbody td:first-child").allInnerTexts();
  assert.deepEqual(
    cells,
    times.slice(0, 200).map((time) => String(Number((time - start).toFixed(3)))),
  );
  assert.equal(await table.locator("thead th").first().innerText(), `Time after ${head} (s)`);
  assert.match(
    await table.locator("tbody td").first().getAttribute("title"),
    new RegExp(`^${head}, ${start}`),
  );
  const markdown = (
    await saved(page, table.getByRole("button", { name: "Markdown" }))
  ).bytes.toString();
  assert.ok(markdown.includes(`| time after ${head} (s) |`), markdown.slice(0, 200));
  assert.ok(markdown.includes(`| ${cells[5]} | match |`), markdown.slice(0, 800));
  assert.doesNotMatch(
    markdown + (await saved(page, table.getByRole("button", { name: "LaTeX" }))).bytes.toString(),
    /e\+9/,
  );
  const csv = (await saved(page, table.getByRole("button", { name: "CSV" }))).bytes.toString();
  assert.ok(csv.includes(`,${times[5]},match`), "the file has the times as they are");
  await closePage(page);
  const data = await openPage(browser, `?view=dataset&dataset=${harbour.detections.id}`);
  await data.locator(".table-frame tbody tr").first().waitFor();
  const text = await data.locator("main").innerText();
  assert.doesNotMatch(text, /\de\+9/);
  assert.match(
    text,
    new RegExp(
      `From\\s+2021-05-04 \\d\\d:\\d\\d:\\d\\d\\.\\d{3} UTC, ${harbour.detections.start_s} s`,
    ),
  );
  await closePage(data);
});

const boxesOf = (page) => page.locator(".check, .problem");

test("a request is either valid or not, and what failed before stands at its fields until it is changed", async () => {
  const body = {
    input: dataset(harbour.detections),
    truth: dataset(harbour.truth),
    name: "not known noise",
  };
  const errors = [
    {
      pointer: "/filter/method",
      code: "unsupported",
      detail: "sensor 'infrared' reports bearings without ranges",
    },
    {
      pointer: "/sensors/0/sigma_x_m",
      code: "required",
      detail: "the noise of sensor 'lidar' is not known",
    },
  ];
  const page = await openPage(browser, "?view=jobs");
  const problem = {
    type: "/problems/validation",
    title: "The request is not valid",
    status: 422,
    code: "validation",
    detail: "2 faults",
    errors,
  };
  // The check lets the request pass and the job fails: the worst that can happen to the form.
  await page.route("**/v1/validate", (route) =>
    route.fulfill({ json: { valid: true, errors: [], warnings: [] } }),
  );
  await page.route(`**/v1/jobs/${scene.job.id}`, (route) =>
    route.fulfill({ json: { ...scene.job, state: "failed", error: problem } }),
  );
  await page.route(`**/v1/jobs/${scene.job.id}/spec`, (route) =>
    route.fulfill({ json: { ...body, filter: { method: "kalman" } } }),
  );
  await page.goto(`${BASE}/?view=new&from=${scene.job.id}`);
  await page.locator(".check.bad").waitFor();
  await page.waitForTimeout(800);
  assert.equal(await boxesOf(page).count(), 1);
  assert.match(await page.locator(".check.bad").innerText(), /2 faults/);
  const atFilter = page
    .locator(".field", { has: byPointer(page, "/filter/method") })
    .locator(".field-fault");
  assert.match(await atFilter.innerText(), /infrared/);
  assert.equal(await byPointer(page, "/filter/method").getAttribute("aria-invalid"), "true");
  // The form has no row of sensors yet: the fault stands where they would be added.
  assert.match(
    await page.locator(".absent", { hasText: "Sensors" }).locator(".field-fault").innerText(),
    /noise of sensor 'lidar'/,
  );
  await byPointer(page, "/name").fill("another");
  await page.locator(".check.ok").waitFor();
  assert.equal(await boxesOf(page).count(), 1);
  assert.match(await page.locator(".check.ok").innerText(), /Not checked: the rows of the data/);
  assert.equal(await page.locator(".field-fault").count(), 0);
  await closePage(page);
});

test("the form opens the sensors with a row for each sensor of the data set, and asks again when one is chosen", async () => {
  const page = await openPage(browser, "?view=new&kind=evaluate");
  const asked = [];
  page.on(
    "request",
    (request) =>
      request.url().endsWith("/v1/validate") &&
      asked.push(request.postDataJSON().input?.dataset_id),
  );
  await byPointer(page, "/input/dataset_id").selectOption(harbour.detections.id);
  await byPointer(page, "/truth/dataset_id").selectOption(harbour.truth.id);
  await page.waitForTimeout(1000);
  assert.equal(asked.at(-1), harbour.detections.id);
  assert.ok((await boxesOf(page).count()) <= 1);
  await page.getByRole("button", { name: "Sensors", exact: true }).click();
  const rows = page.locator('[data-pointer^="/sensors/"][data-pointer$="/sensor_id"]');
  assert.deepEqual(
    await rows.evaluateAll((all) => all.map((field) => field.value)),
    harbour.detections.sensor_ids,
  );
  await closePage(page);
});

test("a video says how many boxes there are, and its events lead to what exists", async () => {
  const page = await openPage(browser, `?view=job&job=${video.job.id}&tab=plan`);
  await page
    .getByText("2 truths and 3 tracks of boxes in a video: boxes are not drawn in this view.")
    .waitFor();
  await page.getByRole("link", { name: "The metrics tab" }).click();
  await frameOf(page, "Events").locator("tbody tr").first().waitFor();
  const links = page.locator(".lanes a, .table-frame tbody a");
  const hrefs = await links.evaluateAll((all) => all.map((link) => link.getAttribute("href")));
  assert.ok(hrefs.length > 0, "events have links");
  assert.deepEqual(
    hrefs.filter((href) => href.includes("tab=plan")),
    [],
  );
  await frameOf(page, "Events").locator("tbody a").first().click();
  assert.equal(parameters(page).get("tab"), "metrics");
  assert.equal(parameters(page).get("time"), "4", "the switch is in the fourth frame");
  await page.locator(".drawing-now").waitFor({ state: "attached" });
  assert.equal(
    await page.locator(".drawing-name.chosen").evaluate((text) => text.firstChild.textContent),
    "1",
  );
  await closePage(page);
});

test("shares and counts of HOTA have an axis each, and the names that TrackEval has", async () => {
  const page = await openPage(browser, `?view=job&job=${video.job.id}&tab=metrics&theme=light`);
  const names = async (title) =>
    (await frameOf(page, title).locator(".curve-key").allInnerTexts()).map((text) => text.trim());
  await frameOf(page, "HOTA over alpha").waitFor();
  assert.deepEqual(await names("HOTA over alpha"), [
    "HOTA",
    "DetA",
    "AssA",
    "LocA",
    "DetRe",
    "DetPr",
    "AssRe",
    "AssPr",
    "OWTA",
  ]);
  assert.deepEqual(await names("HOTA over alpha: counts"), ["HOTA_TP", "HOTA_FN", "HOTA_FP"]);
  const group = page.locator('.metric-group[aria-label="hota"]');
  assert.match(await group.innerText(), /alphas 0\.05 to 0\.95 in steps of 0\.05,/);
  assert.match(await group.innerText(), /HOTA\(0\)\n/);
  await drawn(frameOf(page, "HOTA over alpha"));
  const { texts } = await parsedSvg(
    page,
    (await saved(page, frameOf(page, "HOTA over alpha").getByRole("button", { name: "SVG" })))
      .bytes,
  );
  for (const label of ["0", "0.2", "0.8", "1", "0.05", "0.95"])
    assert.ok(texts.includes(label), `${label} in ${texts}`);
  assert.ok(!texts.some((text) => /\d{7}/.test(text)), `long numbers in ${texts}`);
  await closePage(page);
});

test("means over names are rows with dots and whiskers, the greatest above", async () => {
  const page = await openPage(browser, `?view=job&job=${grid.job.id}&x=associator&theme=light`);
  const frame = frameOf(page, "P correct over associator");
  await frame.locator(".category-dots").waitFor();
  assert.equal(await frame.locator("canvas").count(), 0);
  const { cells } = grid.report.result;
  const mean = (name) => {
    const means = cells
      .filter((cell) => cell.parameters.associator === name)
      .map((cell) => cell.outcomes["P correct"].mean);
    return means.reduce((sum, each) => sum + each, 0) / means.length;
  };
  const rows = frame.locator(".category-row");
  const order = ["NN", "JPDA"].sort((a, b) => mean(b) - mean(a));
  assert.deepEqual(
    await rows
      .locator(".drawing-name")
      .evaluateAll((all) => all.map((text) => text.firstChild.textContent)),
    order,
  );
  assert.deepEqual(await rows.locator("> text:last-child").allTextContents(), ["n = 4", "n = 4"]);
  const titles = await rows.first().locator(".estimate > title").allTextContents();
  const wanted = cells
    .filter((cell) => cell.parameters.associator === order[0])
    .map(
      ({ outcomes: { "P correct": of } }) =>
        `${order[0]}: ${shown(of.mean)} [${shown(of.interval.low)}, ${shown(of.interval.high)}], 4 runs`,
    );
  assert.deepEqual(titles, wanted);
  // No line joins the rows: each mark has its whisker and its symbol, and nothing else.
  assert.equal(await frame.locator(".estimate").count(), 6);
  const ticks = (await frame.locator(".drawing-axis text").allTextContents())
    .slice(0, -1)
    .map(Number);
  assert.ok(Math.max(...ticks) <= 1 && Math.min(...ticks) >= 0, `${ticks}`);
  for (const { outcomes } of cells) {
    const { interval } = outcomes["P correct"];
    assert.ok(interval.low >= 0 && interval.high <= 1, JSON.stringify(interval));
  }
  await closePage(page);
});

test("a track that has ended is told as ended, and has no place", async () => {
  const last = scene.report.result.association.tracks
    .map((track) => track.end_time_s)
    .reduce((a, b) => Math.max(a, b));
  const dead = scene.report.result.association.tracks.find(
    (track) => track.end_time_s < last - 40 && track.points > 8,
  );
  const columns = (await api(`/v1/jobs/${scene.job.id}/plan?track=${dead.track_id}`)).tracks
    .columns;
  const misses =
    columns.status.length - 1 - columns.status.findLastIndex((status) => status !== "coasted");
  const { max_missed } = scene.report.spec.tracker;
  const ending =
    misses + 1 === max_missed
      ? ` (${max_missed} misses)`
      : misses
        ? ` (no detection in its last ${misses === 1 ? "1 scan" : `${misses} scans`})`
        : "";
  const look = async (time) => {
    const page = await openPage(
      browser,
      `?view=job&job=${scene.job.id}&tab=plan&track=${dead.track_id}&time=${time}&theme=light`,
    );
    await page.locator(".plan canvas").first().waitFor();
    const text = await page.locator(".selection").innerText();
    const selected = await hexOf(page, "--chart-selected");
    const svg = await parsedSvg(
      page,
      (await saved(page, page.locator(".plan").getByRole("button", { name: "SVG" }))).bytes,
    );
    await closePage(page);
    return { text, strokes: svg.colors[`stroke ${selected}`] ?? 0, texts: svg.texts };
  };
  const living = await look(dead.end_time_s);
  assert.match(living.text, /Position/);
  assert.ok(living.strokes >= 3, `the track, its ellipses and its ring: ${living.strokes}`);
  const after = await look(last);
  assert.ok(after.text.includes(`ended at ${shown(dead.end_time_s)} s${ending}`), after.text);
  assert.doesNotMatch(after.text, /Position|1σ|coasted/);
  assert.equal(after.strokes, 0);
  assert.ok(after.texts.includes(`selected ${dead.track_id}, which has ended`), `${after.texts}`);
});

test("the threshold of a correlation is drawn at its very value", async () => {
  const body = await preset("huo2008");
  body.statistic = { kind: "chain", alpha: 1e-4 };
  const { job } = await finished("correlate", body);
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=correlation&theme=light`);
  const frame = frameOf(page, "How well the tracks of each tuple agree");
  await drawn(frame);
  const svg = await parsedSvg(
    page,
    (await saved(page, frame.getByRole("button", { name: "SVG" }))).bytes,
  );
  // The mark of the key, and the line.
  assert.equal(svg.colors[`stroke ${await hexOf(page, "--chart-selected")}`], 2);
  assert.ok(svg.texts.includes("α = 0.0001"), `${svg.texts}`);
  await closePage(page);
});

test("words say what happened, and of how many", async () => {
  const { job, report } = scene;
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=metrics&event=reacquisition`);
  const table = frameOf(page, "Events");
  await table.locator("tbody tr").first().waitFor();
  const cells = await table.locator("tbody tr").first().locator("td").allInnerTexts();
  await table.locator("tbody a").first().click();
  const selection = page.locator(".selection");
  await selection.getByText("Reacquisition").waitFor();
  assert.match(
    await selection.innerText(),
    new RegExp(
      `From here on track ${cells[3]} follows ${cells[2]}, which no track followed just before\\.`,
    ),
  );
  await page.getByRole("button", { name: "One scan back" }).click();
  // Elsewhere the event is not told.
  await selection.getByText("From here on").waitFor({ state: "detached" });
  await closePage(page);
  const verdicts = await openPage(browser, `?view=job&job=${job.id}&tab=verdicts&verdict=missed`);
  await verdicts.locator(".verdict-row").first().waitFor();
  const reasons = await verdicts.locator(".verdict-row .reason").allInnerTexts();
  assert.equal(reasons.length, report.result.tfa.counts.missed);
  for (const reason of reasons)
    assert.match(
      reason,
      /^(No track began with the target's first detection, at scan \d+\.|The target was never detected\.)/,
    );
  assert.match(
    await verdicts.locator(".verdict-definition").innerText(),
    /The three need not add up to 1/,
  );
  await closePage(verdicts);
  // One target of the recording is followed, the other is or is not: never "1 failures".
  const plan = await openPage(browser, `?view=job&job=${harbour.job.id}&tab=plan`);
  await plan.locator(".selection").waitFor();
  assert.doesNotMatch(
    await plan.locator("main").innerText(),
    /\b1 (failures|scans|tracks|events|targets)\b/,
  );
  await closePage(plan);
  const tuples = await correlated();
  const correlation = await openPage(browser, `?view=job&job=${tuples.job.id}&tab=correlation`);
  await correlation
    .getByText("A tuple is right when it holds every track of one target and no other track.")
    .waitFor();
  await closePage(correlation);
});
