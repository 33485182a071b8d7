// Tabs of one browser share the event stream of a job: one connection, and every tab lives.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { api, BASE, campaign, hide, startBrowser } from "./support.mjs";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

/** Event streams that were ever opened at the service. */
async function streams() {
  const text = await (await fetch(`${BASE}/metrics`)).text();
  const lines = text
    .split("\n")
    .filter(
      (line) =>
        line.startsWith("trackloom_http_requests_total{") &&
        line.includes('route="/v1/jobs/{id}/events"'),
    );
  return lines.reduce((sum, line) => sum + Number(line.split(" ").at(-1)), 0);
}

/** How far the page says that the campaign is. */
const shareOn = (page) => page.locator(".progress progress").evaluate((bar) => bar.value);
const comesBeyond = (page, share) =>
  page.waitForFunction(
    (least) => document.querySelector(".progress progress")?.value > least,
    share,
  );

/**
 * A page of the context that notes every complaint of the browser, and how often it asks for the
 * job.
 */
async function open(context, id) {
  const page = await context.newPage();
  page.faults = [];
  page.asked = 0;
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) page.faults.push(message.text());
  });
  page.on("request", (request) => {
    if (new URL(request.url()).pathname === `/v1/jobs/${id}`) page.asked += 1;
  });
  await page.goto(`${BASE}/?view=job&job=${id}`);
  await page.locator(".grid-cell b").first().waitFor();
  return page;
}

test("two tabs at one job have one event stream, and the second goes on when the first is closed", async () => {
  const { id } = await api("/v1/jobs/campaign", {
    ...(await campaign(100_000)),
    name: "shared by tabs",
  });
  const before = await streams();
  const context = await browser.newContext({ viewport: { width: 1000, height: 700 } });
  const [first, second] = [await open(context, id), await open(context, id)];
  for (const page of [first, second]) await comesBeyond(page, await shareOn(page));
  assert.equal((await streams()) - before, 1, "one stream for both");
  const asked = [first.asked, second.asked];
  await first.waitForTimeout(4500);
  for (const [index, page] of [first, second].entries())
    assert.ok(
      page.asked - asked[index] <= 1,
      `with a stream the job itself is hardly asked for: ${page.asked - asked[index]} times in 4.5 s`,
    );
  for (const page of [first, second]) {
    await comesBeyond(page, await shareOn(page));
    assert.deepEqual(page.faults, []);
  }
  await first.close();
  await comesBeyond(second, await shareOn(second));
  const { faults } = second;
  assert.equal(
    (await streams()) - before,
    1,
    "the stream outlives the tab that asked for it first",
  );
  await api(`/v1/jobs/${id}/cancel`, {});
  await second.getByText("This job was canceled. Runs made:").waitFor();
  assert.deepEqual(faults, []);
  await context.close();
});

test("a hidden page leaves the stream and asks now and then with its tag; seen again it streams", async () => {
  const { id } = await api("/v1/jobs/campaign", {
    ...(await campaign(100_000)),
    name: "a page out of sight",
  });
  const before = await streams();
  const context = await browser.newContext();
  const page = await open(context, id);
  await comesBeyond(page, await shareOn(page));
  await hide(page, true);
  await page.waitForTimeout(1500);
  const [asked, shown] = [page.asked, await shareOn(page)];
  await page.waitForTimeout(3000);
  assert.deepEqual(
    [page.asked, await shareOn(page)],
    [asked, shown],
    "nothing moves that nobody sees",
  );
  const next = await page.waitForRequest(
    (request) => new URL(request.url()).pathname === `/v1/jobs/${id}`,
    { timeout: 20_000 },
  );
  assert.match((await next.allHeaders())["if-none-match"] ?? "", /^W\/"/);
  await comesBeyond(page, shown);
  assert.equal((await streams()) - before, 1);
  await hide(page, false);
  await comesBeyond(page, await shareOn(page));
  await comesBeyond(page, await shareOn(page));
  await page.waitForTimeout(500);
  assert.equal((await streams()) - before, 2, "the stream is opened once more");
  await api(`/v1/jobs/${id}/cancel`, {});
  await context.close();
});

test("without shared workers a page has a stream of its own", async () => {
  const { id } = await api("/v1/jobs/campaign", {
    ...(await campaign(100_000)),
    name: "a browser without shared workers",
  });
  const before = await streams();
  const context = await browser.newContext();
  await context.addInitScript(() => delete globalThis.SharedWorker);
  const [first, second] = [await open(context, id), await open(context, id)];
  for (const page of [first, second]) await comesBeyond(page, await shareOn(page));
  assert.equal((await streams()) - before, 2);
  await api(`/v1/jobs/${id}/cancel`, {});
  await second.getByText("This job was canceled. Runs made:").waitFor();
  await context.close();
});
