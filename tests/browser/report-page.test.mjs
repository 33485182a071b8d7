// The report of a job as one file: it stands alone, asks nobody, and says what the job says.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BASE, evaluated, findings, linesOf, NARROW, startBrowser, WIDE } from "./support.mjs";

let browser;
let job;
let report;
let folder;
before(async () => {
  browser = await startBrowser();
  ({ job, report } = await evaluated());
  folder = mkdtempSync(join(tmpdir(), "report-"));
});
after(() => browser.close());

/** The page of a file, without a network. */
async function opened(path, viewport = WIDE) {
  const context = await browser.newContext({ viewport, offline: true });
  const page = await context.newPage();
  const faults = [];
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) faults.push(request.url());
  });
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(message.text());
  });
  await page.goto(`file://${path}`);
  await page.locator(".ribbons canvas").waitFor();
  return { page, faults };
}

test("one file tells verdicts, metrics and sentences, alone and offline", async () => {
  const answer = await fetch(`${BASE}/v1/jobs/${job.id}/report.html`);
  assert.equal(answer.status, 200);
  assert.match(answer.headers.get("content-security-policy"), /default-src 'none'/);
  const text = await answer.text();
  assert.ok(text.length < 3e6, `${text.length} characters`);
  const path = join(folder, "job.html");
  writeFileSync(path, text);
  const { page, faults } = await opened(path);
  assert.equal(await page.locator("h1").innerText(), job.name);
  const { tfa, metrics } = report.result;
  const words = await page.locator("main").innerText();
  assert.ok(
    words.includes(
      `${tfa.counts.correct} correct, ${tfa.counts.missed} missed, ${tfa.counts.false} false`,
    ),
  );
  const failures = tfa.targets.filter(({ verdict }) => verdict !== "correct").length;
  assert.equal(
    await page.locator(".panel", { hasText: "Verdicts" }).locator("tbody tr").count(),
    failures,
  );
  const rows = Object.values(metrics).reduce(
    (sum, { quantities }) => sum + Object.keys(quantities).length,
    0,
  );
  assert.equal(await page.locator(".report-metrics tbody tr").count(), rows);
  const causes = (await linesOf(job, "causes.csv")).length - 1;
  const told = await page
    .locator(".panel", { hasText: "What happened" })
    .locator("tbody tr")
    .count();
  assert.equal(told, Math.min(causes, 200));
  assert.deepEqual(await findings(page), []);
  await page.getByRole("button", { name: "To the first scan" }).click();
  await page.locator(".clock-text", { hasText: "scan 1/" }).waitFor();
  assert.deepEqual(faults, []);
  await page.context().close();
});

test("the command line makes the same page of what a run left, and a telephone shows it", async () => {
  const out = join(folder, "run");
  const run = (...words) => execFileSync(process.env.TRACKLOOM_BIN, words, { stdio: "pipe" });
  run("run", "--preset", "liang2009-30", "--out", out);
  run("report", out);
  const { result } = JSON.parse(readFileSync(join(out, "report.json"), "utf8"));
  const { page, faults } = await opened(join(out, "report.html"), NARROW);
  const words = await page.locator("main").innerText();
  assert.ok(words.includes(`${result.tfa.counts.correct} correct`));
  const beyond = await page.evaluate(
    () => document.documentElement.scrollWidth - window.innerWidth,
  );
  assert.ok(beyond <= 0, `${beyond} px wider than the window`);
  assert.deepEqual(faults, []);
  await page.context().close();
});
