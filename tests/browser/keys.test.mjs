// A service that asks for keys, on its page: nothing shows without one, a key is kept where no script
// reads it, and signing out shuts the door again.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { dataFolder, startService } from "./service.mjs";
import { assertNothingSticksOut, findings, startBrowser } from "./support.mjs";

const MASTER = "0123456789abcdef0123456789abcdef";

let browser;
let service;
before(async () => {
  browser = await startBrowser();
  service = await startService(dataFolder(), 0, { TRACKLOOM_MASTER_KEY: MASTER });
});
after(async () => {
  await browser.close();
  await service.stop();
});

async function ask(path, method, body) {
  const answer = await fetch(`${service.base}${path}`, {
    method,
    headers: { authorization: `Bearer ${MASTER}`, "content-type": "application/json" },
    ...(body ? { body: JSON.stringify(body) } : {}),
  });
  assert.ok(answer.ok, `${path}: ${answer.status}`);
  return answer.status === 204 ? undefined : answer.json();
}

test("a page shows nothing until it has a key, and nothing after it gave it back", async () => {
  const job = { input: { source: "preset", preset: "liang2009-10" }, name: "a secret job" };
  await ask("/v1/jobs/evaluate", "POST", job);
  const { key, info } = await ask("/v1/keys", "POST", { name: "page", actions: ["read"] });
  const context = await browser.newContext({ viewport: { width: 390, height: 844 } });
  const page = await context.newPage();
  await page.goto(`${service.base}/`);
  await page.getByRole("heading", { name: "Sign in" }).waitFor();
  assert.ok(!(await page.content()).includes("a secret job"));
  assert.deepEqual(await findings(page), []);
  await assertNothingSticksOut(page);
  const field = page.getByLabel("Key");
  await field.fill("tlk_wrong");
  await page.keyboard.press("Enter");
  await page.getByText("the key is not one of this service").waitFor();
  await field.fill(key);
  await page.keyboard.press("Enter");
  await page.getByRole("link", { name: "a secret job" }).waitFor();
  const seen = await page.evaluate(() => document.cookie + JSON.stringify({ ...localStorage }));
  assert.ok(!seen.includes("tlk_"), seen);
  const [cookie] = await context.cookies();
  assert.deepEqual(
    [cookie.name, cookie.value, cookie.httpOnly, cookie.sameSite],
    ["trackloom_key", key, true, "Strict"],
  );
  await page.reload();
  await page.getByRole("link", { name: "a secret job" }).waitFor();
  await page.getByRole("button", { name: "Sign out" }).click();
  await page.getByRole("heading", { name: "Sign in" }).waitFor();
  assert.ok(!(await page.content()).includes("a secret job"));
  assert.deepEqual(await context.cookies(), []);
  // A key that is revoked meanwhile shuts the page at its next question.
  await page.getByLabel("Key").fill(key);
  await page.keyboard.press("Enter");
  await page.getByRole("link", { name: "a secret job" }).waitFor();
  await ask(`/v1/keys/${info.id}`, "DELETE");
  await page.reload();
  await page.getByRole("heading", { name: "Sign in" }).waitFor();
  await context.close();
});
