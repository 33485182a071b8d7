// Every view, light and dark, and in light also narrow: a picture for people, nothing wider than the window,
// and no serious finding of axe.

import assert from "node:assert/strict";
import { mkdir } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import {
  api,
  assertNothingSticksOut,
  bearingsTracked,
  COLOR_RULES,
  campaign,
  closePage,
  clustered,
  correlated,
  evaluated,
  findings,
  finished,
  grouped,
  NARROW,
  openPage,
  preset,
  seeAll,
  settle,
  startBrowser,
  WIDE,
} from "./support.mjs";

const FOLDER = process.env.TRACKLOOM_SCREENSHOTS ?? join(tmpdir(), "trackloom-pictures");
/** Names of views to draw, divided by commas; all when absent. */
const ONLY = (process.env.TRACKLOOM_VIEWS ?? "").split(",").filter(Boolean);

let browser;
let views;
before(async () => {
  browser = await startBrowser();
  await mkdir(FOLDER, { recursive: true });
  const { job, report } = await evaluated();
  const other = await preset("liang2009-100");
  other.name = "browser scene, JPDA";
  other.associator = { method: "jpda" };
  const [second, tuples, bearings, grid, fuzzy, groups] = [
    await finished("evaluate", other),
    await correlated(),
    await bearingsTracked(),
    await finished("campaign", await campaign()),
    await clustered(),
    await grouped(),
  ];
  const target = report.result.tfa.targets.find((entry) => entry.verdict === "false");
  const chosen = `&time=${target.at_time_s}&truth=${target.truth_id}&track=${target.track_id}&centre=selection`;
  const wrong =
    tuples.report.result.tuples.find((tuple) => !tuple.right) ?? tuples.report.result.tuples[0];
  const track = bearings.report.result.association.tracks[0].track_id;
  const followed = report.result.association.tracks.find((line) => line.points > 10).track_id;
  const { x_m, y_m, time_s } = (await api(`/v1/jobs/${job.id}/plan?track=${followed}`)).tracks
    .columns;
  const [x, y] = [Math.round(x_m.at(-1)), Math.round(y_m.at(-1))];
  const measured = `&track=${followed}&time=${time_s.at(-1)}&centre=selection&ruler=${x},${y},${x + 1500},${y + 2000}`;
  const sets = (await api("/v1/datasets?kind=detections&limit=1")).items;
  views = {
    jobs: `?ticked=${job.id},${second.job.id}`,
    "jobs-none": "?state=failed&kind=simulate&q=nothing",
    presets: "?view=new",
    form: "?view=new&preset=liang2009-10",
    "form-correlate": "?view=new&preset=huo2008",
    json: "?view=new&preset=liang2009-10&as=json",
    summary: `?view=job&job=${job.id}`,
    plan: `?view=job&job=${job.id}&tab=plan`,
    "plan-selected": `?view=job&job=${job.id}&tab=plan${chosen}`,
    "plan-measured": `?view=job&job=${job.id}&tab=plan${measured}`,
    verdicts: `?view=job&job=${job.id}&tab=verdicts&truth=${target.truth_id}`,
    metrics: `?view=job&job=${job.id}&tab=metrics`,
    request: `?view=job&job=${job.id}&tab=spec`,
    correlation: `?view=job&job=${tuples.job.id}&tab=correlation`,
    "correlation-plan": `?view=job&job=${tuples.job.id}&tab=plan&track=${wrong.system_track_id}&centre=selection`,
    campaign: `?view=job&job=${grid.job.id}`,
    bearings: `?view=job&job=${bearings.job.id}&tab=plan&track=${track}`,
    search: `?view=job&job=${bearings.job.id}&tab=search`,
    memberships: `?view=job&job=${fuzzy.job.id}&tab=search`,
    groups: `?view=job&job=${groups.job.id}&tab=search`,
    compare: `?view=compare&jobs=${job.id},${second.job.id}`,
    "compare-none": "?view=compare",
    datasets: "?view=datasets&upload=1",
    dataset: `?view=dataset&dataset=${sets[0].id}`,
  };
});
after(() => browser.close());

async function picture(page, name, theme, width) {
  await seeAll(page);
  await assertNothingSticksOut(page, `${name}, ${width}`);
  await page.screenshot({ path: join(FOLDER, `${name}-${theme}-${width}.png`), fullPage: true });
}

for (const theme of ["light", "dark"]) {
  test(`pictures, ${theme}`, async () => {
    const found = {};
    for (const [name, query] of Object.entries(views).filter(
      ([name]) => !ONLY.length || ONLY.includes(name),
    )) {
      const page = await openPage(browser, `${query}&theme=${theme}`, WIDE);
      await page.locator("h1").first().waitFor();
      await page.waitForFunction(() => !document.querySelector(".loading"));
      await picture(page, name, theme, "wide");
      // What axe looks at is the same at any width, and but for colours in either theme.
      const bad = await findings(page, theme === "dark" ? COLOR_RULES : undefined);
      if (bad.length) found[name] = bad;
      // How things lie does not depend on the theme.
      if (theme === "light") {
        await page.setViewportSize(NARROW);
        await settle(page);
        await picture(page, name, theme, "narrow");
      }
      await closePage(page);
    }
    assert.deepEqual(found, {});
  });
}
