// More detections than a page is sent: the density of all of them, a label that says so, and names
// that are found by typing.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  closePage,
  finished,
  openPage,
  parameters,
  startBrowser,
  uploaded,
} from "./support.mjs";

const [SCANS, PER_SCAN] = [100, 600];

let browser;
let job;
let plan;
before(async () => {
  browser = await startBrowser();
  let state = 5;
  const next = () => {
    state = (state * 1664525 + 1013904223) % 2 ** 32;
    return state / 2 ** 32;
  };
  const lines = Array.from(
    { length: SCANS * PER_SCAN },
    (_, row) =>
      `${2 * Math.floor(row / PER_SCAN)},${1 + Math.floor(row / PER_SCAN)},radar,d${row},${(20_000 * (next() - 0.5)).toFixed(1)},${(20_000 * (next() - 0.5)).toFixed(1)}`,
  );
  const set = await uploaded(
    "many.csv",
    ["time_s,scan,sensor_id,detection_id,x_m,y_m", ...lines].join("\n"),
  );
  const sensors = [
    { sensor_id: "radar", p_d: 0.9, clutter_per_m2: PER_SCAN / 4e8, sigma_x_m: 20, sigma_y_m: 20 },
  ];
  ({ job } = await finished("associate", {
    name: "browser: many detections",
    input: { source: "dataset", dataset_id: set.id },
    associator: { method: "nearest_neighbour" },
    sensors,
  }));
  plan = await api(`/v1/jobs/${job.id}/plan`);
});
after(() => browser.close());

test("the plan shows the density of all detections, single ones where there is room, and says which", async () => {
  const { east, north, count } = plan.density.columns;
  assert.equal(
    count.reduce((sum, each) => sum + each, 0),
    SCANS * PER_SCAN,
  );
  assert.ok(Math.max(...east) === 199 && Math.max(...north) <= 199);
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan`);
  await page.locator(".plan canvas").first().waitFor();
  const badge = page.locator(".plan .reduced");
  await badge.getByText("density of all 60,000 detections").waitFor();
  assert.ok(!(await badge.innerText()).includes("detections 30,000"), await badge.innerText());
  await closePage(page);
  const near = await openPage(browser, `?view=job&job=${job.id}&tab=plan&centre=0,0&span=2000`);
  await near
    .locator(".plan .reduced")
    .getByText("detections 30,000 of 60,000 (every nth)")
    .waitFor();
  await near.getByRole("button", { name: "To the first scan" }).click();
  await near.locator(".plan .reduced").getByText("density").waitFor({ state: "detached" });
  await closePage(near);
});

test("one of many tracks is found by typing its name", async () => {
  const names = [...new Set(plan.tracks.columns.track_id)];
  assert.ok(names.length > 500, `${names.length} tracks`);
  const name = names[Math.floor(names.length / 2)];
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan`);
  const field = page.locator(".selection").getByLabel("Track");
  await field.click();
  await page.keyboard.type(name);
  await page.locator(`datalist option[value="${name}"]`).waitFor({ state: "attached" });
  assert.ok((await page.locator("datalist option").count()) <= 50);
  await page.keyboard.press("Enter");
  await page.getByRole("heading", { name: `Association probability, ${name}` }).waitFor();
  assert.equal(parameters(page).get("track"), name);
  await closePage(page);
});
