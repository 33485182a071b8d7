// A service that keeps one ended job: a pinned one stays beside it, and the list says how it stands.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { dataFolder, startService } from "./service.mjs";
import { assertNothingSticksOut, findings, startBrowser } from "./support.mjs";

let browser;
let service;
before(async () => {
  browser = await startBrowser();
  service = await startService(dataFolder(), 0, { TRACKLOOM_KEEP_JOBS: "1" });
});
after(async () => {
  await browser.close();
  await service.stop();
});

async function run(name) {
  const preset = await (await fetch(`${service.base}/v1/presets/liang2009-10`)).json();
  const answer = await fetch(`${service.base}/v1/jobs/evaluate`, {
    method: "POST",
    headers: { "content-type": "application/json", prefer: "wait=30" },
    body: JSON.stringify({ ...preset.body, name, seed: name.length }),
  });
  const job = await answer.json();
  assert.equal(job.state, "succeeded", JSON.stringify(job));
  return job;
}

test("a pinned job stays when old jobs make room, and the page says so", async () => {
  const first = await run("first");
  const page = await (await browser.newContext()).newPage();
  await page.goto(`${service.base}/?view=job&job=${first.id}`);
  await page.getByRole("button", { name: "Pin" }).click();
  const pinned = page.getByRole("button", { name: "Pinned" });
  await pinned.waitFor();
  assert.equal(await pinned.getAttribute("aria-pressed"), "true");
  assert.deepEqual(await findings(page), []);
  await run("second");
  await run("the last one");
  await page.goto(`${service.base}/`);
  await page.getByText("1 of 1 ended jobs, 1 pinned").waitFor({ timeout: 20_000 });
  await page.getByRole("link", { name: "second" }).waitFor({ state: "detached" });
  const names = await page.locator("td.cell-name a").allTextContents();
  assert.deepEqual(names, ["the last one", "first"]);
  assert.equal(await page.locator("td.cell-name .label").textContent(), "pinned");
  assert.deepEqual(await findings(page), []);
  await page.setViewportSize({ width: 390, height: 844 });
  await assertNothingSticksOut(page);
});
