// Data sets: a file whose columns have other names is uploaded, mistakes are shown at the column,
// and its page says what it holds.

import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import {
  allowRefusals,
  api,
  BASE,
  closePage,
  openPage,
  parameters,
  startBrowser,
} from "./support.mjs";

const ROWS = ["0,1,radar,a,10.5,20.25", "0,1,radar,b,30,40", "2,2,radar,c,11,21"];
const RECORDING = fileURLToPath(
  new URL("../../examples/data/autoferry-scenario2/detections.json", import.meta.url),
);

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = await mkdtemp(join(tmpdir(), "trackloom-upload-"));
});
after(() => browser.close());

async function file(name, text) {
  const path = join(folder, name);
  await writeFile(path, text);
  return path;
}

async function chosen(path) {
  const page = await openPage(browser, "?view=datasets&upload=1");
  await page.locator("input[type=file]").setInputFiles(path);
  return page;
}

const column = (page, name) => page.locator(`[data-column="${name}"]`);
const faultOf = (page, name) =>
  page.locator("tr", { has: column(page, name) }).locator(".field-fault");

test("a mistake in the names of columns is shown at the column and corrected there", async () => {
  const page = await chosen(
    await file("renamed.csv", `t,scan,sensor_id,detection_id,east,y_m\n${ROWS.join("\n")}\n`),
  );
  await column(page, "t").fill("time_s");
  await column(page, "east").fill("x_metres");
  await page.getByRole("button", { name: "Upload", exact: true }).click();
  await faultOf(page, "east").getByText("'x_metres' is not a column of detections").waitFor();
  assert.equal(await column(page, "east").getAttribute("aria-invalid"), "true");
  assert.equal(await column(page, "t").getAttribute("aria-invalid"), null);
  await column(page, "east").fill("x_m");
  await page.getByRole("button", { name: "Upload", exact: true }).click();
  await page.waitForURL(/view=dataset&/);
  const set = await api(`/v1/datasets/${parameters(page).get("dataset")}`);
  assert.deepEqual([set.kind, set.rows, set.scans], ["detections", 3, 2]);
  await page.getByRole("heading", { name: "renamed.csv" }).waitFor();
  await page.locator(".table-frame tbody tr").first().waitFor();
  const shownRows = await page
    .locator(".table-frame tbody tr")
    .evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.innerText)));
  assert.deepEqual(shownRows[0].slice(-2), ["10.5", "20.25"]);
  assert.equal(shownRows.length, 3);
  allowRefusals(page, 422);
  await closePage(page);
});

test("a value that cannot be read is shown at its column, with its line", async () => {
  const page = await chosen(
    await file(
      "broken.csv",
      `time_s,scan,sensor_id,detection_id,x_m,y_m\n${ROWS[0]}\n0,1,radar,b,oops,40\n`,
    ),
  );
  await page.getByRole("button", { name: "Upload", exact: true }).click();
  const fault = faultOf(page, "x_m");
  await fault.waitFor();
  assert.match(await fault.innerText(), /expected a number, found 'oops'.*line 3/i);
  allowRefusals(page, 422);
  await closePage(page);
});

test("a column that is missing is named in full", async () => {
  const page = await chosen(
    await file("short.csv", `time_s,scan,sensor_id,detection_id,x_m\n0,1,radar,a,1\n`),
  );
  await page.getByRole("button", { name: "Upload", exact: true }).click();
  await page
    .getByRole("alert")
    .getByText("column 'y_m' is missing", { exact: false })
    .first()
    .waitFor();
  allowRefusals(page, 422);
  await closePage(page);
});

test("a recording of the harbour is uploaded, listed, looked at and deleted", async () => {
  const page = await chosen(RECORDING);
  await page.getByLabel("Format").selectOption("autoferry");
  await page.locator(".upload").getByLabel("Kind").selectOption("detections");
  await page.getByRole("button", { name: "Upload", exact: true }).click();
  await page.waitForURL(/view=dataset&/);
  const id = parameters(page).get("dataset");
  const set = await api(`/v1/datasets/${id}`);
  const panel = await page.locator(".panel", { hasText: "Contents" }).innerText();
  assert.ok(
    panel.includes(set.rows.toLocaleString("en-US")) &&
      panel.includes(set.scans.toLocaleString("en-US")),
    panel,
  );
  assert.match(
    await page.locator(".panel", { hasText: "Provenance" }).innerText(),
    /upload of detections\.json/,
  );
  for (const warning of set.warnings) await page.getByText(warning).waitFor();
  await page.getByRole("link", { name: "Data sets" }).first().click();
  await page.getByLabel("Kind").first().selectOption("detections");
  await page.locator(`tbody a[href*="${id}"]`).first().click();
  page.once("dialog", (dialog) => dialog.accept());
  await page.getByRole("button", { name: "Delete" }).click();
  await page.waitForURL(/view=datasets/);
  assert.equal((await fetch(`${BASE}/v1/datasets/${id}`)).status, 410);
  await closePage(page);
});
