// Names that try to be markup, run from right to left, are very long or hold pictures: every view
// shows them as the text they are.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  assertNothingSticksOut,
  closePage,
  finished,
  NARROW,
  openPage,
  startBrowser,
  uploaded,
} from "./support.mjs";

const SCRIPT = `<script>window.hacked=1</script><img src=x onerror="window.hacked=1">`;
const NAMES = {
  script: SCRIPT,
  rtl: "مرحبا ‮txet",
  emoji: "🚢🛰️👩‍🚀",
  quotes: `"a,b"\\'</td>`,
  long: "x".repeat(90),
};
// As long as an id may be.
const LONG_ID = "id-".repeat(66);

let browser;
let jobs;
let set;
const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
const ids = Object.values(NAMES).concat(LONG_ID);

/** Truth and tracks of targets with these names, each followed by a track with the same name. */
async function evaluatedNames() {
  const lines = (shift) =>
    ids.flatMap((id, row) =>
      Array.from({ length: 6 }, (_, step) =>
        [step, quoted(id), step * 10 + shift, row * 100].join(","),
      ),
    );
  const truth = await uploaded(
    `${SCRIPT}.csv`,
    `time_s,truth_id,x_m,y_m\n${lines(0).join("\n")}\n`,
    { name: NAMES.script },
  );
  const tracks = await uploaded("tracks.csv", `time_s,track_id,x_m,y_m\n${lines(1).join("\n")}\n`, {
    name: NAMES.rtl,
  });
  const source = ({ id }) => ({ source: "dataset", dataset_id: id });
  set = truth;
  return finished("evaluate", {
    name: NAMES.script,
    labels: { [NAMES.emoji]: NAMES.rtl },
    truth: source(truth),
    tracks: source(tracks),
  });
}

/** The same tracks as those of two sensors with such names. */
async function correlatedNames() {
  const rows = (sensor, shift) =>
    ids
      .slice(0, 4)
      .flatMap((id, row) =>
        Array.from({ length: 4 }, (_, step) =>
          [step, quoted(id), quoted(sensor), step * 10 + shift, row * 1000].join(","),
        ),
      );
  const sets = [];
  for (const [sensor, shift] of [
    [NAMES.script, 0],
    [NAMES.rtl, 1],
  ])
    sets.push(
      await uploaded(
        "set.csv",
        `time_s,track_id,sensor_id,x_m,y_m\n${rows(sensor, shift).join("\n")}\n`,
      ),
    );
  return finished("correlate", {
    name: NAMES.emoji,
    sets: sets.map(({ id }) => ({ source: "dataset", dataset_id: id })),
    alignment: { sigma_m: 5 },
    correlator: { method: "genetic" },
  });
}

async function campaignNames() {
  const base = { kind: "evaluate", ...(await api("/v1/presets/liang2009-10")).body };
  delete base.name;
  delete base.seed;
  const variants = Object.values(NAMES).map((name) => ({ name, set: [] }));
  return finished("campaign", {
    name: NAMES.quotes,
    base,
    grid: [{ by: "variants", name: NAMES.script, variants }],
    runs: 2,
    outcomes: [
      { name: NAMES.script, path: "tfa.probability.correct" },
      { name: NAMES.rtl, path: "tfa.counts.correct" },
    ],
  });
}

before(async () => {
  browser = await startBrowser();
  jobs = {
    evaluation: await evaluatedNames(),
    correlation: await correlatedNames(),
    campaign: await campaignNames(),
  };
});
after(() => browser.close());

async function assertHarmless(page, name) {
  await page.locator("h1").first().waitFor();
  await page.waitForFunction(() => !document.querySelector(".loading"));
  assert.equal(await page.evaluate(() => globalThis.hacked), undefined, name);
  assert.equal(await page.locator('#app script, #app img[src="x"]').count(), 0, name);
  for (const viewport of [NARROW, { width: 1440, height: 900 }]) {
    await page.setViewportSize(viewport);
    await page.waitForTimeout(100);
    await assertNothingSticksOut(page, `${name} at ${viewport.width} px`);
  }
}

const shows = (page, text) =>
  page.evaluate((wanted) => document.body.textContent.includes(wanted), text);

test("in the lists of jobs and of data sets, and on the page of a data set", async () => {
  const pages = {
    "": NAMES.script,
    "?view=datasets": NAMES.script,
    [`?view=dataset&dataset=${set.id}`]: NAMES.script,
    [`?q=${encodeURIComponent(NAMES.emoji)}`]: NAMES.emoji,
  };
  for (const [query, name] of Object.entries(pages)) {
    const page = await openPage(browser, query);
    await assertHarmless(page, query);
    assert.ok(await shows(page, name), `${query} shows ${name}`);
    await closePage(page);
  }
});

test("on every tab of jobs whose targets, tracks, sensors, cells and outcomes are called so", async () => {
  const wanted = {
    evaluation: {
      "": NAMES.script,
      verdicts: NAMES.rtl,
      metrics: NAMES.emoji,
      plan: NAMES.script,
      spec: NAMES.emoji,
    },
    correlation: { correlation: NAMES.script, plan: NAMES.rtl },
    campaign: { "": NAMES.long },
  };
  for (const [kind, tabs] of Object.entries(wanted)) {
    for (const [tab, name] of Object.entries(tabs)) {
      const page = await openPage(
        browser,
        `?view=job&job=${jobs[kind].job.id}&tab=${tab}&event=match`,
      );
      await assertHarmless(page, `${kind}, ${tab}`);
      await page
        .waitForFunction((text) => document.body.textContent.includes(text), name)
        .catch(() => assert.fail(`${kind}, ${tab} shows ${name}`));
      await closePage(page);
    }
  }
});

test("in tooltips and saved pictures, in the form of a job made from it, and side by side", async () => {
  const chosen = encodeURIComponent(NAMES.script);
  for (const query of [
    `?view=job&job=${jobs.evaluation.job.id}&tab=plan&track=${chosen}&truth=${chosen}`,
    `?view=new&from=${jobs.evaluation.job.id}`,
    `?view=compare&jobs=${jobs.evaluation.job.id},${jobs.correlation.job.id},${jobs.campaign.job.id}`,
  ]) {
    const page = await openPage(browser, query);
    await assertHarmless(page, query);
    assert.ok(
      (await shows(page, NAMES.script)) ||
        (await page
          .locator("input")
          .evaluateAll((all, name) => all.some((input) => input.value === name), NAMES.script)),
      query,
    );
    await closePage(page);
  }
});

test("a name that is too long is refused at its field", async () => {
  const page = await openPage(browser, "?view=new&preset=liang2009-10");
  await page.locator('[data-pointer="/name"]').fill("🚢".repeat(1000));
  await page
    .locator(".field", { has: page.locator('[data-pointer="/name"]') })
    .locator(".field-fault")
    .waitFor();
  await closePage(page);
});
