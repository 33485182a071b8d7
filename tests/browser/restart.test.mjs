// A service that is restarted under open pages: the list says that it is old and recovers, a
// running job is taken up again and ends.

import assert from "node:assert/strict";
import { createServer } from "node:net";
import { after, before, test } from "node:test";
import { dataFolder, startService } from "./service.mjs";
import { campaign, startBrowser } from "./support.mjs";

let browser;
let service;
before(async () => (browser = await startBrowser()));
after(async () => {
  await browser.close();
  await service?.stop();
});

function freePort() {
  return new Promise((take) => {
    const probe = createServer().listen(0, "127.0.0.1", () => {
      const { port } = probe.address();
      probe.close(() => take(port));
    });
  });
}

test("pages survive a restart of the service, and so does the job they show", async () => {
  const [port, data] = [await freePort(), dataFolder()];
  service = await startService(data, port);
  const post = {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ ...(await campaign(1000)), name: "over a restart" }),
  };
  const { id } = await (await fetch(`${service.base}/v1/jobs/campaign`, post)).json();
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  const [list, page] = [await context.newPage(), await context.newPage()];
  await page.goto(`${service.base}/?view=job&job=${id}`);
  await page.waitForFunction(() =>
    [...document.querySelectorAll(".grid-cell b")].some((cell) => Number(cell.textContent) > 0),
  );
  await list.goto(`${service.base}/`);
  await list.locator("tbody tr").first().waitFor();
  await service.stop();
  const stopped = Date.now();
  await list.bringToFront();
  await list.getByText(/The service does not answer\. Shown as of/).waitFor();
  assert.ok((await list.locator("tbody tr").count()) > 0, "what was there stays");
  service = await startService(data, port);
  await list.locator(".stale").waitFor({ state: "detached", timeout: 20_000 });
  await page.bringToFront();
  await page
    .getByRole("heading", { name: "Time of deciding", exact: true })
    .waitFor({ timeout: 180_000 });
  assert.equal(
    await page.locator(".problem").count(),
    0,
    "nothing of the outage is left on the page",
  );
  const job = await (await fetch(`${service.base}/v1/jobs/${id}`)).json();
  assert.equal(job.state, "succeeded");
  assert.ok(
    Date.parse(job.started_at) < stopped && stopped < Date.parse(job.finished_at),
    "it ran before and after",
  );
  await context.close();
});
