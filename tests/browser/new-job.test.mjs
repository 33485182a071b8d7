// From a preset through the form to a result; a recording uploaded and evaluated; a long job
// watched and canceled.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import {
  api,
  byPointer,
  closePage,
  ended,
  frameOf,
  openPage,
  parameters,
  preset,
  startBrowser,
} from "./support.mjs";

const RECORDING = fileURLToPath(
  new URL("../../examples/data/autoferry-scenario2/", import.meta.url),
);
const COUNT = "/input/scenario/targets/count";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

async function submitted(page) {
  await page.getByRole("button", { name: /^Submit/ }).click();
  await page.waitForURL(/view=job/);
  return parameters(page).get("job");
}

test("a preset is changed in the form, a fault is shown at its field, and the corrected job runs", async () => {
  const page = await openPage(browser, "?view=new");
  await page.getByRole("link", { name: /^liang2009-10 / }).click();
  await page.getByText("The request is valid.").waitFor();
  await byPointer(page, COUNT).fill("0");
  const fault = page.locator(".field", { has: byPointer(page, COUNT) }).locator(".field-fault");
  await fault.waitFor();
  assert.match(await fault.innerText(), /allowed/);
  assert.equal(await byPointer(page, COUNT).getAttribute("aria-invalid"), "true");
  await page.locator(".check.bad").getByRole("button", { name: COUNT }).click();
  assert.equal(
    await byPointer(page, COUNT).evaluate((field) => field === document.activeElement),
    true,
    "the fault leads to its field",
  );
  await byPointer(page, COUNT).fill("12");
  await byPointer(page, "/name").fill("twelve targets");
  await page.getByText("The request is valid.").waitFor();
  const id = await submitted(page);
  await page.locator(".badge.state-succeeded").waitFor();
  const report = await api(`/v1/jobs/${id}/report`);
  assert.equal(report.spec.input.scenario.targets.count, 12);
  assert.equal(report.spec.name ?? "twelve targets", "twelve targets");
  // The badge may come before the report.
  await page.locator(".verdict-count").first().waitFor();
  const shown = await page.locator(".verdict-count").allInnerTexts();
  const counts = report.result.tfa.counts;
  assert.deepEqual(shown, [counts.correct, counts.missed, counts.false].map(String));
  await closePage(page);
});

test("the form and the JSON editor hold the same request", async () => {
  const page = await openPage(browser, "?view=new&preset=liang2009-10");
  await byPointer(page, COUNT).fill("17");
  await page.getByRole("tab", { name: "JSON" }).click();
  const editor = page.locator("#json-text");
  const body = JSON.parse(await editor.inputValue());
  assert.equal(body.input.scenario.targets.count, 17);
  body.seed = 77;
  body.nonsense = true;
  await editor.fill(JSON.stringify(body));
  await page.locator(".check.bad").getByText("/nonsense").waitFor();
  await page.getByRole("tab", { name: "Form" }).click();
  assert.equal(await byPointer(page, "/seed").inputValue(), "77");
  await closePage(page);
});

async function upload(page, part, file, kind) {
  const group = page
    .locator("fieldset.group", { has: byPointer(page, `${part}/dataset_id`) })
    .last();
  await group.getByRole("button", { name: "Upload a file" }).click();
  await group.locator("input[type=file]").setInputFiles(RECORDING + file);
  await group.getByLabel("Kind").selectOption(kind);
  await group.getByLabel("Format").selectOption("autoferry");
  await group.getByRole("button", { name: "Upload", exact: true }).click();
  await page.waitForFunction(
    (pointer) =>
      document
        .querySelector(`[data-pointer="${pointer}"]`)
        ?.selectedOptions[0]?.text.includes("rows"),
    `${part}/dataset_id`,
  );
}

test("a recording and its truth are uploaded; what the data do not say may be given", async () => {
  const page = await openPage(browser, "?view=new&kind=evaluate");
  await upload(page, "/input", "detections.json", "detections");
  await upload(page, "/truth", "groundTruth.json", "truth");
  if (await page.getByRole("button", { name: "Tfa", exact: true }).count())
    await page.getByRole("button", { name: "Tfa", exact: true }).click();
  await byPointer(page, "/tfa/symbols/kind").selectOption("nearest_truth");
  await byPointer(page, "/tfa/symbols/gate_m").fill("30");
  await byPointer(page, "/name").fill("harbour recording");
  await byPointer(page, "/input/sensor_ids").fill("radar");
  await page.getByRole("button", { name: "Sensors", exact: true }).click();
  const rows = await page
    .locator('[data-pointer^="/sensors/"][data-pointer$="/sensor_id"]')
    .evaluateAll((all) => all.map((field) => field.value));
  const row = rows.indexOf("radar");
  for (const field of ["sigma_x_m", "sigma_y_m"])
    await byPointer(page, `/sensors/${row}/${field}`).fill("4");
  await page.getByText("The request is valid.").waitFor();
  const id = await submitted(page);
  await page.locator(".badge.state-succeeded, .badge.state-failed").waitFor();
  const job = await ended(id);
  assert.equal(job.state, "succeeded", JSON.stringify(job.error));
  const report = await api(`/v1/jobs/${id}/report`);
  assert.equal(report.result.tfa.counts.targets, 2);
  await page.getByRole("link", { name: "Plan view" }).click();
  // Cameras have a chart of bearings, too; which of the two is drawn first is open.
  const plan = frameOf(page, "Plan view").locator("canvas").first();
  await plan.waitFor();
  assert.match(await plan.getAttribute("aria-label"), /2 truth lines/);
  await closePage(page);
});

/** A scene that takes minutes: many slow targets that never leave the field of view. */
async function longJob() {
  const body = await preset("liang2009-100");
  body.name = "long watch";
  body.input.scenario.scans = 12_000;
  body.input.scenario.targets = {
    kind: "random",
    count: 1000,
    area_side_m: 60_000,
    speed_min_mps: 0,
    speed_max_mps: 0.1,
  };
  return api("/v1/jobs/evaluate", body);
}

test("a long job shows its progress in the list and on its page, and can be canceled", async () => {
  const { id } = await longJob();
  const list = await openPage(browser, "?q=long+watch");
  const row = list.locator("tr", { hasText: "long watch" }).first();
  await row.locator("progress").waitFor();
  await row.getByText(/ %/).waitFor();
  await row.getByRole("link", { name: "long watch" }).click();
  const bar = list.locator(".waiting progress");
  await bar.waitFor();
  const first = Number(await bar.getAttribute("value"));
  await list.waitForFunction(
    (before) =>
      Number(document.querySelector(".waiting progress")?.getAttribute("value") ?? before) > before,
    first,
  );
  await list.getByRole("button", { name: "Cancel" }).click();
  await list.locator(".badge.state-canceled").waitFor();
  await list.getByText("This job was canceled.").waitFor();
  assert.equal((await ended(id)).state, "canceled");
  await closePage(list);
});

test("a job is run again from its page, with the same result", async () => {
  const first = await ended((await api("/v1/jobs/evaluate", await preset("liang2009-10"))).id);
  const page = await openPage(browser, `?view=job&job=${first.id}`);
  await page.getByRole("button", { name: "Rerun" }).click();
  await page.getByText("rerun of").waitFor();
  await page.locator(".badge.state-succeeded").waitFor();
  const again = parameters(page).get("job");
  assert.notEqual(again, first.id);
  const [before, after] = await Promise.all(
    [first.id, again].map((id) => api(`/v1/jobs/${id}/report`)),
  );
  assert.deepEqual(after.result, before.result);
  await closePage(page);
});
