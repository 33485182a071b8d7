// Jobs of every kind, and jobs that have little to show: every tab opens, says what there is, and
// nothing fails.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  assertNothingSticksOut,
  closePage,
  drawn,
  finished,
  grouped,
  NARROW,
  openPage,
  preset,
  startBrowser,
  uploaded,
} from "./support.mjs";

const TRUTH =
  "time_s,truth_id,x_m,y_m\n0,A,0,0\n1,A,10,0\n2,A,20,0\n0,B,0,50\n1,B,10,50\n2,B,20,50\n";
const TRACKS = "time_s,track_id,x_m,y_m\n0,1,0,1\n1,1,10,1\n2,2,20,1\n";
/** MOTChallenge: frame, id, left, top, width, height, confidence, class, visibility. */
const BOXES = {
  truth: "1,1,10,10,20,40,1,1,1\n2,1,12,10,20,40,1,1,1\n",
  tracks: "1,7,11,10,20,40,1,-1,-1,-1\n2,8,13,10,20,40,1,-1,-1,-1\n",
};

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

const source = (set) => ({ source: "dataset", dataset_id: set.id });

async function judged(truth, tracks, more = {}) {
  return finished("evaluate", { truth: source(truth), tracks: source(tracks), ...more });
}

/** Opens every tab of a job and answers their names. */
async function tabsOf(id) {
  const page = await openPage(browser, `?view=job&job=${id}`);
  await page.locator(".tabs a").first().waitFor();
  const names = await page.locator(".tabs a").allInnerTexts();
  for (const name of names) {
    await page.locator(".tabs a", { hasText: name }).click();
    await page.locator(".tabs a[aria-current]", { hasText: name }).waitFor();
    await page.waitForFunction(() => !document.querySelector(".loading"));
    assert.deepEqual(await page.locator(".problem").allInnerTexts(), [], name);
    await page.setViewportSize(NARROW);
    await assertNothingSticksOut(page, name);
    await page.setViewportSize({ width: 1440, height: 900 });
  }
  await closePage(page);
  return names;
}

test("a simulation and an association", async () => {
  const scenario = { ...(await preset("liang2009-10")).input.scenario, scans: 5 };
  const simulated = await finished("simulate", { scenario, name: "kinds: a scene" });
  assert.deepEqual(await tabsOf(simulated.job.id), ["Summary", "Plan view", "Request and files"]);
  const associated = await finished("associate", {
    input: { source: "job", job_id: simulated.job.id },
  });
  assert.deepEqual(await tabsOf(associated.job.id), ["Summary", "Plan view", "Request and files"]);
});

test("tracks that were judged by metrics alone, of points and of boxes, and in sequences", async () => {
  const [truth, tracks] = [
    await uploaded("truth.csv", TRUTH),
    await uploaded("tracks.csv", TRACKS),
  ];
  const points = await judged(truth, tracks, { comparison: { gate_m: 5 } });
  assert.deepEqual(await tabsOf(points.job.id), [
    "Summary",
    "Plan view",
    "Verdicts",
    "Metrics",
    "Request and files",
  ]);
  const boxes = await judged(
    await uploaded("gt.txt", BOXES.truth, { format: "mot", kind: "truth" }),
    await uploaded("res.txt", BOXES.tracks, { format: "mot", kind: "tracks" }),
    { profile: "vision" },
  );
  assert.ok((await tabsOf(boxes.job.id)).includes("Metrics"));
  const sequences = ["one", "two"].map((name) => ({
    name,
    truth: source(truth),
    tracks: source(tracks),
  }));
  const several = await finished("evaluate", { sequences });
  assert.ok((await tabsOf(several.job.id)).includes("Metrics"));
  const page = await openPage(browser, `?view=job&job=${several.job.id}&tab=metrics&sequence=two`);
  await page.locator(".metric-group").first().waitFor();
  assert.equal(await page.getByRole("combobox", { name: "Sequence" }).inputValue(), "two");
  await page.getByRole("heading", { name: "Who followed whom" }).waitFor();
  await closePage(page);
});

test("reports of several sensors put together, with the memberships of each instant", async () => {
  const { job } = await grouped();
  assert.deepEqual(await tabsOf(job.id), ["Summary", "Plan view", "Method", "Request and files"]);
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=search`);
  await page.getByRole("heading", { name: "Memberships" }).waitFor();
  const ways = page.locator(".chart-frame", {
    has: page.getByRole("heading", { name: /^Ways of the centres/ }),
  });
  await drawn(ways);
  await closePage(page);
});

test("a scene in which nothing was there to see", async () => {
  const body = await preset("liang2009-10");
  Object.assign(body.input.scenario, { scans: 2 });
  Object.assign(body.input.scenario.sensors[0], { p_d: 1e-9, clutter_per_scan: 0 });
  const { job } = await finished("evaluate", body);
  assert.ok((await tabsOf(job.id)).includes("Verdicts"));
});

test("a job that failed says why, one that is unknown does so too, and so does an unknown page", async () => {
  // Their clocks do not meet, which only the job finds.
  const [truth, late] = [
    await uploaded("truth.csv", TRUTH),
    await uploaded("late.csv", "time_s,track_id,x_m,y_m\n900,1,0,1\n901,1,10,1\n"),
  ];
  const { id } = await api("/v1/jobs/evaluate", { truth: source(truth), tracks: source(late) });
  const failed = await openPage(browser, `?view=job&job=${id}`);
  await failed.locator(".badge.state-failed").waitFor();
  assert.ok((await failed.locator(".problem .faults li").count()) > 0);
  await closePage(failed);
  const unknown = await openPage(browser, "?view=job&job=00000000-0000-7000-8000-000000000000");
  await unknown.getByRole("alert").waitFor();
  unknown.faults = unknown.faults.filter((fault) => !fault.includes("status of 404"));
  await closePage(unknown);
  const nowhere = await openPage(browser, "?view=nowhere");
  await nowhere.getByText("There is no such page.").waitFor();
  await closePage(nowhere);
});
