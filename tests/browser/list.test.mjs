// The job list: filters in the address, pages, what it says when the service is away; and how much
// is loaded at first.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  BASE,
  closePage,
  ended,
  openPage,
  parameters,
  preset,
  startBrowser,
} from "./support.mjs";

const FIRST_LOAD_BYTES = 90_000;
const ALL_BYTES = 307_000;
/** A live session, which needs no chart library. */
const SESSION_BYTES = 91_000;

let browser;
let job;
before(async () => {
  browser = await startBrowser();
  const body = await preset("liang2009-10");
  body.name = "a job to find";
  job = await ended((await api("/v1/jobs/evaluate", body)).id);
});
after(() => browser.close());

test("filters narrow the list and stand in the address; nothing found says so", async () => {
  const page = await openPage(browser, "");
  await page.locator("h1").click();
  await page.keyboard.press("/");
  await page.keyboard.type("a job to find");
  const rows = page.locator("tbody tr");
  await page.waitForFunction(() =>
    [...document.querySelectorAll("tbody tr")].every((row) =>
      row.textContent.includes("a job to find"),
    ),
  );
  assert.ok((await rows.count()) >= 1);
  assert.equal(parameters(page).get("q"), "a job to find");
  await page.getByLabel("State").selectOption("failed");
  await page.getByText("No job matches these filters.").waitFor();
  assert.equal(parameters(page).get("state"), "failed");
  await page.getByRole("button", { name: "Clear the filters" }).click();
  await rows.first().waitFor();
  assert.equal(parameters(page).toString(), "");
  await closePage(page);
});

test("more jobs than a page are loaded by cursor, each once", async () => {
  const body = {
    scenario: { ...(await preset("liang2009-10")).input.scenario, scans: 1 },
    name: "many",
  };
  const ids = await Promise.all(
    Array.from({ length: 55 }, async () => (await api("/v1/jobs/simulate", body)).id),
  );
  await Promise.all(ids.map(ended));
  const page = await openPage(browser, "?q=many&kind=simulate");
  await page.getByRole("button", { name: "Load more" }).click();
  await page.waitForFunction(() => document.querySelectorAll("tbody tr").length > 50);
  const links = await page.$$eval("tbody a", (all) =>
    all.map((link) => new URL(link.href).searchParams.get("job")),
  );
  assert.equal(new Set(links).size, links.length);
  for (const id of ids) assert.ok(links.includes(id));
  await closePage(page);
});

test("a list that cannot be renewed stays, and says how old it is", async () => {
  const page = await openPage(browser, "");
  await page.locator("tbody tr").first().waitFor();
  await page.route("**/v1/jobs?*", (route) => route.abort());
  await page.getByText(/The service does not answer\. Shown as of/).waitFor();
  assert.ok((await page.locator("tbody tr").count()) > 0);
  await page.unroute("**/v1/jobs?*");
  await page.locator(".stale").waitFor({ state: "detached" });
  page.faults = page.faults.filter((fault) => !fault.includes("net::ERR_FAILED"));
  await closePage(page);
});

test("the link that a job carries opens its page", async () => {
  const page = await openPage(browser, job.links.ui.replace(/^\//, ""));
  await page.getByRole("heading", { name: "a job to find" }).waitFor();
  assert.equal(parameters(page).get("job"), job.id);
  await closePage(page);
});

test("the first load is small, and the charts come only when they are looked at", async () => {
  const page = await openPage(browser, "");
  // What went over the wire, compressed as the service compresses it.
  const loaded = () =>
    page.evaluate(() =>
      performance
        .getEntriesByType("resource")
        .filter((entry) => /\.(js|css)$/.test(entry.name))
        .map((entry) => entry.encodedBodySize),
    );
  await page.locator("h1").waitFor();
  const first = await loaded();
  const sum = (sizes) => sizes.reduce((total, size) => total + size, 0);
  assert.ok(first.length >= 2 && sum(first) <= FIRST_LOAD_BYTES, `${sum(first)} bytes at first`);
  await page.goto(`${BASE}/?view=job&job=${job.id}&tab=plan`);
  await page.locator(".plan canvas").first().waitFor();
  const all = await loaded();
  assert.ok(all.length > first.length && sum(all) <= ALL_BYTES, `${sum(all)} bytes with charts`);
  const radar = { sensor_id: "r", sigma_x_m: 9, sigma_y_m: 9, p_d: 0.9, clutter_per_m2: 1e-8 };
  const tracker = { initial_speed_sigma_mps: 9 };
  const session = await api("/v1/sessions", { sensors: [radar], tracker });
  await page.goto(`${BASE}/?view=session&session=${session.id}`);
  await page.getByText("No scan yet.").waitFor();
  const live = sum(await loaded());
  assert.ok(live <= SESSION_BYTES, `${live} bytes with a live session`);
  await closePage(page);
});
