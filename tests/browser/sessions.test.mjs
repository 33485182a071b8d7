// A live session on the page: what it shows is what the service says, its clock follows or stays, a
// track is ended by hand, it survives a restart of the service, and its end leads to the job.

import assert from "node:assert/strict";
import { createServer } from "node:net";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { dataFolder, startService } from "./service.mjs";
import {
  allowRefusals,
  api,
  assertNothingSticksOut,
  closePage,
  decodedPng,
  findings,
  openPage,
  paletteColor,
  parameters,
  saved,
  startBrowser,
} from "./support.mjs";

const FOLDER = process.env.TRACKLOOM_SCREENSHOTS;
const PHONE = { width: 390, height: 844 };
const ORIGIN = { lat_deg: 63.43, lon_deg: 10.39 };

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

const SETTINGS = {
  name: "browser harbour",
  origin: ORIGIN,
  sensors: [
    {
      sensor_id: "radar",
      ...{ x_m: 0, y_m: 0, sigma_range_m: 10, sigma_bearing_deg: 0.1 },
      ...{ p_d: 0.9, clutter_per_m2: 1e-8, max_range_m: 6000 },
    },
  ],
  tracker: { initial_speed_sigma_mps: 10, confirmation: { rule: "existence" } },
};

/** Two boats: one goes east in the south, one north in the west. */
function scan(index, more = []) {
  const boats = [[-1500 + 20 * index, -1000], [-2000, -500 + 20 * index], ...more];
  const detections = boats.map(([x_m, y_m]) => ({
    range_m: Math.hypot(x_m, y_m),
    bearing_deg: (Math.atan2(x_m, y_m) * 180) / Math.PI,
  }));
  return { sensor_id: "radar", sequence: index, time_s: 1.7e9 + 2 * index, detections };
}

async function begun(more = {}) {
  return (await api("/v1/sessions", { ...SETTINGS, ...more })).id;
}

async function pushed(id, from, to, more) {
  for (let index = from; index < to; index++)
    await api(`/v1/sessions/${id}/scans`, scan(index, more));
}

const opened = (id, more = "", viewport) =>
  openPage(browser, `?view=session&session=${id}${more}`, viewport);

/** Waits until the page has taken this many scans. */
const scansAre = (page, count) =>
  page.waitForFunction((wanted) => globalThis.figure("Scans") === wanted, String(count));

async function withFigures(page) {
  await page.addInitScript(() => {
    globalThis.figure = (name) =>
      [...document.querySelectorAll(".figure")]
        .find((box) => box.querySelector("dt").textContent === name)
        ?.querySelector("b").textContent;
  });
  await page.reload();
  return page;
}

const figuresOf = (page) =>
  page.$$eval(".figure", (all) =>
    Object.fromEntries(
      all.map((box) => [
        box.querySelector("dt").textContent,
        box.querySelector("b").textContent.replaceAll(",", ""),
      ]),
    ),
  );

const rowsOf = (page) =>
  page.$$eval(".live-tracks tbody tr", (all) =>
    all.map((row) => [...row.querySelectorAll("td")].map((cell) => cell.textContent)),
  );

test("a session is paused and goes on, by whoever did it", async () => {
  const id = await begun();
  await pushed(id, 0, 3);
  const page = await withFigures(await opened(id));
  await scansAre(page, 3);
  await page.getByRole("button", { name: "Pause", exact: true }).click();
  const again = page.getByRole("button", { name: "Take scans again" });
  await again.waitFor();
  assert.equal((await api(`/v1/sessions/${id}`)).live.is_paused, true);
  assert.match(await page.locator(".title-row [role=status]").innerText(), /paused/);
  await again.click();
  await page.getByRole("button", { name: "Pause", exact: true }).waitFor();
  await pushed(id, 3, 5);
  await scansAre(page, 5);
  await api(`/v1/sessions/${id}/pause`, {});
  await again.waitFor();
  await closePage(page);
});

test("what the page shows of tracks, counts and events is what the service says", async () => {
  const id = await begun();
  await pushed(id, 0, 12);
  const page = await withFigures(await opened(id));
  await scansAre(page, 12);
  await pushed(id, 14, 16);
  await api(`/v1/sessions/${id}/scans`, { ...scan(12), time_s: 1.7e9 });
  await scansAre(page, 15);
  const picture = await api(`/v1/sessions/${id}/picture`);
  await page.waitForFunction(() => globalThis.figure("Late, dropped") === "1");
  const { counts, tracks, waiting } = picture;
  const shown = await figuresOf(page);
  assert.deepEqual(
    [shown.Tracks, shown.Scans, shown.Detections, shown.Missing, shown.Waiting],
    [tracks.length, counts.scans, counts.detections, counts.missing, waiting].map(String),
  );
  assert.deepEqual([tracks.length, counts.scans, counts.missing], [2, 15, 2]);
  const rows = await rowsOf(page);
  for (const [order, track] of tracks.entries()) {
    const speed = Math.hypot(track.vx_mps, track.vy_mps).toFixed(1);
    const course = ((Math.atan2(track.vx_mps, track.vy_mps) * 180) / Math.PI + 360) % 360;
    assert.deepEqual(rows[order].slice(0, 6), [
      track.track_id,
      track.status,
      track.existence === undefined ? "–" : track.existence.toFixed(3),
      speed,
      course.toFixed(0),
      String(track.detections),
    ]);
  }
  const history = await api(`/v1/sessions/${id}/history`);
  const events = await page.$$eval(".live-events li", (all) => all.map((row) => row.textContent));
  assert.equal(events.length, history.items.length);
  assert.match(events[0], /late, dropped, radar/);
  assert.match(events.at(-1), /track 1started/);
  // A press on an event goes to the track; the readout of its place is that of the service.
  await page.locator(".live-events li button").last().click();
  assert.equal(parameters(page).get("track"), "1");
  const facts = await page.locator(".live-selected").innerText();
  const [first] = tracks;
  assert.ok(facts.includes(`x ${first.x_m.toFixed(1)} m, y ${first.y_m.toFixed(1)} m`), facts);
  assert.ok(facts.includes(`${first.lat_deg.toFixed(5)}° N`), facts);
  await closePage(page);
});

test("there is ink where a track is, and the place under the pointer is that of the plane", async () => {
  const id = await begun();
  await pushed(id, 0, 12);
  const { tracks } = await api(`/v1/sessions/${id}/tracks`);
  const [track] = tracks;
  // The camera looks at the track: it stands in the middle, and the middle is a filled mark.
  const centre = `&centre=${track.x_m},${track.y_m}&span=400`;
  const page = await opened(id, centre);
  await page.locator(".live-tracks tbody tr").first().waitFor();
  const canvas = page.locator(".live-plan canvas");
  const color = await paletteColor(page, "--chart-track");
  const middle = await canvas.evaluate((sheet) => {
    const pen = sheet.getContext("2d");
    const { data } = pen.getImageData(sheet.width / 2 - 2, sheet.height / 2 - 2, 4, 4);
    return [...data.slice(20, 23)];
  });
  for (const [at, part] of color.entries())
    assert.ok(Math.abs(part - middle[at]) < 12, `${middle} is not ${color}`);
  const box = await canvas.boundingBox();
  await canvas.hover({ position: { x: box.width / 2, y: box.height / 2 } });
  const text = await page.locator(".plan-readout").innerText();
  const [, x, y] = /x (-?[\d.]+) m, y (-?[\d.]+) m/.exec(text);
  assert.ok(Math.abs(Number(x) - track.x_m) < 2 && Math.abs(Number(y) - track.y_m) < 2, text);
  const [, lat, lon] = /([\d.]+)° N, ([\d.]+)° E/.exec(text);
  assert.ok(Math.abs(Number(lat) - track.lat_deg) < 3e-5, `${lat} ${track.lat_deg}`);
  assert.ok(Math.abs(Number(lon) - track.lon_deg) < 6e-5, `${lon} ${track.lon_deg}`);
  const png = await saved(page, page.getByRole("button", { name: "PNG" }));
  const picture = await decodedPng(page, png.bytes, color);
  assert.ok(picture.ink > 2000 && picture.colored > 100, JSON.stringify(picture));
  await page.getByRole("button", { name: "Zoom in" }).click();
  await page.waitForFunction(
    () => Math.abs(Number(new URLSearchParams(location.search).get("span")) - 400 / 1.5) < 1,
  );
  await page.getByRole("button", { name: "Show everything" }).click();
  await page.waitForFunction(() => !new URLSearchParams(location.search).has("span"));
  await closePage(page);
});

test("the clock follows the feed, or stays and looks back, by hand and by keyboard", async () => {
  const id = await begun();
  await pushed(id, 0, 4);
  const page = await withFigures(await opened(id));
  const clock = page.getByRole("group", { name: "Clock" });
  for (let index = 4; index < 10; index++) {
    await pushed(id, index, index + 1);
    await clock.getByText(`scan ${index + 1}`, { exact: false }).waitFor();
  }
  await page.locator("h1").click();
  await page.keyboard.press("ArrowLeft");
  await clock.getByText("stays").waitFor();
  const rows = () => rowsOf(page).then(([[, , , , , detections]]) => detections);
  await page.waitForFunction(() =>
    /scan 9/.test(document.querySelector(".clock-text").textContent),
  );
  assert.equal(await rows(), "9");
  await pushed(id, 10, 12);
  await scansAre(page, 12);
  assert.equal(await rows(), "9", "the table stays with the picture");
  assert.match(await page.locator(".clock-text").innerText(), /scan 9\b[\s\S]*stays, 3 behind/);
  await page.keyboard.press("Space");
  await page.waitForFunction(() =>
    /scan 12/.test(document.querySelector(".clock-text").textContent),
  );
  await page.waitForFunction(
    () => document.querySelector(".live-tracks tbody td:nth-child(6)").textContent === "12",
  );
  await closePage(page);
});

test("a track is ended by hand, and a closed session leads to its data set and its job", async () => {
  const id = await begun();
  await pushed(id, 0, 10);
  const page = await opened(id, "&track=2");
  const panel = page.getByRole("region", { name: "Selected track" });
  await panel.getByRole("button", { name: "End this track" }).click();
  await page.keyboard.press("Escape");
  assert.equal((await api(`/v1/sessions/${id}/tracks`)).tracks.length, 2, "nothing is done yet");
  await panel.getByRole("button", { name: "End this track" }).click();
  await panel.getByRole("button", { name: "End track 2" }).click();
  await panel.getByText("It does not live at this moment.").waitFor();
  await page.waitForFunction(() =>
    document.querySelector(".live-events li")?.textContent.includes("track 2ended"),
  );
  const { tracks } = await api(`/v1/sessions/${id}/tracks`);
  assert.deepEqual(
    tracks.map((track) => track.track_id),
    ["1"],
  );
  assert.equal((await rowsOf(page)).length, 1);
  await page.getByRole("button", { name: "Close the session" }).click();
  await page.getByRole("button", { name: "Close it" }).click();
  await page.getByRole("heading", { name: "The session is closed" }).waitFor();
  allowRefusals(page, 409);
  const session = await api(`/v1/sessions/${id}`);
  assert.equal(session.state, "closed");
  if (FOLDER)
    await page.screenshot({ path: join(FOLDER, "session-closed-light.png"), fullPage: true });
  await page.getByRole("link", { name: "the job", exact: false }).click();
  await page.getByRole("heading", { name: "browser harbour" }).waitFor();
  assert.equal(parameters(page).get("job"), session.job_id);
  await page.locator(".plan canvas").first().waitFor();
  await page.goBack();
  await page.getByRole("link", { name: "The data set" }).click();
  await page.getByRole("heading", { name: "browser harbour" }).waitFor();
  assert.equal(parameters(page).get("dataset"), session.dataset_id);
  await closePage(page);
});

test("the list has each session as it stands; an empty one shows how a scan is pushed", async () => {
  const id = await begun({ name: "listed harbour" });
  const empty = await opened(id);
  await empty.getByText("No scan yet.").waitFor();
  const command = await empty.locator(".command pre").innerText();
  const body = JSON.parse(/-d '(.*)'/s.exec(command)[1]);
  assert.ok(command.includes(`/v1/sessions/${id}/scans`));
  // What the page proposes is taken.
  const answer = await api(`/v1/sessions/${id}/scans`, { ...body, sequence: 0, time_s: 1.7e9 });
  assert.equal(answer.scans[0].fate, "taken");
  await empty.locator(".live-plan canvas").waitFor();
  await closePage(empty);
  await pushed(id, 1, 8);
  const page = await openPage(browser, "?view=jobs");
  await page.getByRole("link", { name: "Live", exact: true }).click();
  const row = page.locator("tbody tr").filter({ hasText: "listed harbour" });
  await row.waitFor();
  await page.waitForFunction(() =>
    [...document.querySelectorAll("tbody tr")].some(
      (line) =>
        line.textContent.includes("listed harbour") &&
        line.querySelectorAll("td")[2].textContent === "8",
    ),
  );
  const { live } = await api(`/v1/sessions/${id}`);
  const cells = await row.locator("td").allInnerTexts();
  assert.deepEqual(
    [cells[1].trim(), cells[2], cells[3], cells[4]],
    ["open", ...[live.counts.scans, live.tracks, live.confirmed].map(String)],
  );
  await row.getByRole("link").click();
  await page.getByRole("heading", { name: "listed harbour" }).waitFor();
  await closePage(page);
  const unknown = await opened("0198c0de-0000-7000-8000-000000000000");
  await unknown.locator(".problem").waitFor();
  allowRefusals(unknown, 404);
  await closePage(unknown);
});

function freePort() {
  return new Promise((take) => {
    const probe = createServer().listen(0, "127.0.0.1", () => {
      const { port } = probe.address();
      probe.close(() => take(port));
    });
  });
}

test("a page survives a restart of the service, and goes on with the session", async () => {
  const [port, data] = [await freePort(), dataFolder()];
  let service = await startService(data, port);
  const asked = async (path, body) => {
    const headers = { "content-type": "application/json" };
    const answer = await fetch(`${service.base}${path}`, {
      ...(body ? { method: "POST", headers, body: JSON.stringify(body) } : {}),
    });
    assert.ok(answer.ok, await answer.clone().text());
    return answer.json();
  };
  const { id } = await asked("/v1/sessions", SETTINGS);
  for (let index = 0; index < 6; index++) await asked(`/v1/sessions/${id}/scans`, scan(index));
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(`${service.base}/?view=session&session=${id}`);
  const clock = page.locator(".clock-text");
  await clock.getByText("scan 6").waitFor();
  await service.stop();
  await page.getByText(/The service does not answer\. Shown as of/).waitFor();
  assert.match(await clock.innerText(), /scan 6/);
  service = await startService(data, port);
  await page.locator(".stale").waitFor({ state: "detached", timeout: 30_000 });
  await asked(`/v1/sessions/${id}/scans`, scan(6));
  await page.waitForFunction(() =>
    /scan 7/.test(document.querySelector(".clock-text").textContent),
  );
  // The ways of before are still there: the trail of the eastern boat is longer than the restart.
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() =>
    /scan 6/.test(document.querySelector(".clock-text").textContent),
  );
  await context.close();
  await service.stop();
});

test("a session elsewhere is told and asked for again; a failed one says why", async () => {
  const id = await begun();
  await pushed(id, 0, 3);
  const page = await opened(id);
  await page.locator(".clock-text").getByText("scan 3").waitFor();
  const detail = "the session is served by 10.0.0.7:8080; ask there";
  const problem = { type: "/problems/session_elsewhere", title: "Elsewhere", status: 409, detail };
  await page.route("**/picture*", (route) =>
    route.fulfill({
      status: 409,
      contentType: "application/problem+json",
      body: JSON.stringify({ ...problem, code: "session_elsewhere" }),
    }),
  );
  await pushed(id, 3, 4);
  await page.getByText(`${detail}. Shown as of`).waitFor();
  assert.match(await page.locator(".clock-text").innerText(), /scan [34]/, "the picture stays");
  await page.unroute("**/picture*");
  await page.locator(".stale").waitFor({ state: "detached" });
  await page.locator(".clock-text").getByText("scan 4").waitFor();
  allowRefusals(page, 409);
  const session = await api(`/v1/sessions/${id}`);
  const fault = {
    pointer: "",
    code: "too_large",
    detail: "more hypotheses than a tracker may hold",
  };
  await page.route(`**/v1/sessions/${id}`, (route) =>
    route.fulfill({ json: { ...session, state: "failed", fault, live: undefined } }),
  );
  await page.reload();
  await page.getByRole("heading", { name: "The session failed" }).waitFor();
  await page.getByText(fault.detail).waitFor();
  assert.equal(await page.getByRole("button", { name: "Close the session" }).count(), 0);
  await closePage(page);
});

test("axe finds nothing serious, in both themes and on a phone, and nothing sticks out", async () => {
  const id = await begun();
  await pushed(id, 0, 12);
  const empty = await begun({ name: "nothing yet" });
  const looked = async (query, name, viewport) => {
    const page = await openPage(browser, query, viewport);
    await page.locator("h1").waitFor();
    await page.locator(".live-plan canvas, .command, tbody tr").first().waitFor();
    await page.waitForTimeout(600);
    assert.deepEqual(await findings(page), [], name);
    await assertNothingSticksOut(page, name);
    if (FOLDER) await page.screenshot({ path: join(FOLDER, `${name}.png`), fullPage: true });
    await closePage(page);
  };
  for (const theme of ["light", "dark"]) {
    const of = (session) => `?view=session&session=${session}&theme=${theme}`;
    await looked(`${of(id)}&track=1`, `session-${theme}`);
    await looked(`${of(id)}&track=1`, `session-phone-${theme}`, PHONE);
    await looked(of(empty), `session-empty-${theme}`);
    await looked(`?view=sessions&theme=${theme}`, `sessions-${theme}`, PHONE);
  }
});
