// Every view, light and dark, wide and narrow: a picture for people, and nothing wider than the window.

import { mkdir } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { assertNothingSticksOut, closePage, evaluated, NARROW, openPage, startBrowser, WIDE } from "./support.mjs";

const FOLDER = process.env.TRACKLOOM_SCREENSHOTS ?? join(tmpdir(), "trackloom-pictures");
const SETTLE_MS = 700;

let browser;
let views;
before(async () => {
  browser = await startBrowser();
  await mkdir(FOLDER, { recursive: true });
  const { job, report } = await evaluated();
  const target = report.result.tfa.targets.find((entry) => entry.verdict === "false");
  const chosen = `&time=${target.at_time_s}&truth=${target.truth_id}&track=${target.track_id}&centre=selection`;
  views = {
    jobs: "?",
    "jobs-none": "?state=failed&kind=simulate&q=nothing",
    presets: "?view=new",
    form: "?view=new&preset=liang2009-10",
    json: "?view=new&preset=liang2009-10&as=json",
    summary: `?view=job&job=${job.id}`,
    plan: `?view=job&job=${job.id}&tab=plan`,
    "plan-selected": `?view=job&job=${job.id}&tab=plan${chosen}`,
    verdicts: `?view=job&job=${job.id}&tab=verdicts`,
    request: `?view=job&job=${job.id}&tab=spec`,
  };
});
after(() => browser.close());

for (const theme of ["light", "dark"]) {
  for (const [width, viewport] of [["wide", WIDE], ["narrow", NARROW]]) {
    test(`pictures, ${theme}, ${width}`, async () => {
      for (const [name, query] of Object.entries(views)) {
        const page = await openPage(browser, `${query}&theme=${theme}`, viewport);
        await page.waitForLoadState("networkidle").catch(() => undefined);
        await page.waitForTimeout(SETTLE_MS);
        await assertNothingSticksOut(page, `${name} at ${viewport.width} px`);
        await page.screenshot({ path: join(FOLDER, `${name}-${theme}-${width}.png`) });
        await closePage(page);
      }
    });
  }
}
