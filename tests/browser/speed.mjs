// How long views take, measured and not judged. Run it with a service on a free machine:
//
//   TRACKLOOM_URL=http://… node speed.mjs            makes the data, then measures
//
// Printed: the middle of seven loads in fresh browser contexts (milliseconds), and the ratio to the
// data of 10⁴ detections. Then the frames a second of a live session of 200 tracks at ten scans a second, while
// it follows and while it is dragged all the time.

import { chromium } from "playwright-core";

const BASE = process.env.TRACKLOOM_URL ?? "http://127.0.0.1:8080";
const LOADS = 7;
const ARGUMENTS = [
  "--no-sandbox",
  "--disable-gpu",
  "--no-first-run",
  "--disable-background-networking",
];

async function asked(path, body) {
  const answer = await fetch(
    `${BASE}${path}`,
    body
      ? {
          method: "POST",
          headers: { "content-type": "application/json", prefer: "wait=30" },
          body: JSON.stringify(body),
        }
      : {},
  );
  if (!answer.ok) throw new Error(`${path}: ${await answer.text()}`);
  return answer.json();
}

async function done(job) {
  let now = job;
  while (["queued", "running"].includes(now.state)) {
    await new Promise((wake) => setTimeout(wake, 500));
    now = await asked(`/v1/jobs/${job.id}`);
  }
  if (now.state !== "succeeded") throw new Error(JSON.stringify(now.error));
  return now.id;
}

/** Ten targets at 1000 scans among uniform clutter, tracked. */
async function tracked(perScan) {
  let state = 7;
  const next = () => {
    state = (state * 1664525 + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
  const lines = ["time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id"];
  for (let scan = 0; scan < 1000; scan++) {
    for (let index = 0; index < perScan; index++) {
      const ofTarget = index < 10;
      const x = ofTarget ? -9000 + 18 * scan + 40 * (next() - 0.5) : 20_000 * (next() - 0.5);
      const y = ofTarget ? -8000 + 1700 * index + 40 * (next() - 0.5) : 20_000 * (next() - 0.5);
      lines.push(
        `${2 * scan},${scan + 1},radar,${lines.length},${x.toFixed(2)},${y.toFixed(2)},${ofTarget ? `t${index}` : ""}`,
      );
    }
  }
  const form = new FormData();
  form.append(
    "meta",
    new Blob([JSON.stringify({ name: `speed ${perScan}` })], { type: "application/json" }),
  );
  form.append("file", new Blob([lines.join("\n")]), "speed.csv");
  const set = await (await fetch(`${BASE}/v1/datasets`, { method: "POST", body: form })).json();
  const clutter_per_m2 = Math.max(perScan - 10, 1) / 4e8;
  const sensors = [{ sensor_id: "radar", p_d: 0.9, clutter_per_m2, sigma_x_m: 20, sigma_y_m: 20 }];
  return done(
    await asked("/v1/jobs/associate", {
      name: `speed ${perScan}`,
      input: { source: "dataset", dataset_id: set.id },
      associator: { method: "nearest_neighbour" },
      sensors,
      tracker: { initial_speed_sigma_mps: 5 },
    }),
  );
}

/** An evaluation of 1000 scans with everything that a report holds. */
async function longEvaluation() {
  const { body } = await asked("/v1/presets/liang2009-30");
  body.name = "speed: 1000 scans";
  body.input.scenario.scans = 1000;
  return done(await asked("/v1/jobs/evaluate", body));
}

/**
 * Milliseconds from the navigation until a canvas of this place is drawn; a drawn canvas has ink in
 * its middle rows.
 */
async function firstPicture(browser, query, place) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  const start = performance.now();
  await page.goto(`${BASE}/${query}`, { waitUntil: "commit" });
  await page.waitForFunction(
    (selector) => {
      const canvas = document.querySelector(`${selector} canvas`);
      if (!canvas?.width) return false;
      const { data } = canvas
        .getContext("2d")
        .getImageData(0, Math.floor(canvas.height / 2), canvas.width, 1);
      return data.some((value) => value > 0);
    },
    place,
    { polling: "raf" },
  );
  return { page, context, spent: performance.now() - start };
}

const middle = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Milliseconds of a press on "Zoom in", until two frames after it are on the screen. */
function zoomTime(page) {
  return page.evaluate(async () => {
    const frame = () => new Promise((next) => requestAnimationFrame(next));
    const times = [];
    for (let press = 0; press < 7; press++) {
      const start = performance.now();
      document.querySelector("[aria-label='Zoom in']").click();
      await frame();
      await frame();
      times.push(performance.now() - start);
    }
    return times;
  });
}

async function measured(browser, query, place, zooms) {
  const loads = [];
  let zoom = [];
  for (let load = 0; load < LOADS; load++) {
    const { page, context, spent } = await firstPicture(browser, query, place);
    loads.push(spent);
    if (zooms) zoom = await zoomTime(page);
    await context.close();
  }
  return {
    first: loads[0],
    rest: middle(loads.slice(1)),
    zoom: zoom.length ? middle(zoom) : undefined,
  };
}

const TARGETS = 200;
const LIVE_S = 10;

/** The scan of a moment: 200 targets on a grid, each with its own course. */
function liveScan(index) {
  const time_s = 0.1 * index;
  const detections = Array.from({ length: TARGETS }, (_, target) => ({
    x_m: 600 * (target % 20) + 100 * Math.sin(target) * time_s + 8 * Math.sin(7 * target + index),
    y_m: 600 * Math.floor(target / 20) + 100 * Math.cos(target) * time_s,
  }));
  return { sensor_id: "radar", sequence: index, time_s, detections };
}

/** Pushes ten scans a second until it is told to stop; answers how many. */
async function fed(path, feed) {
  const begun = performance.now();
  let index = 0;
  for (; feed.goesOn; index++) {
    await asked(`${path}/scans`, liveScan(index));
    const due = begun + 100 * (index + 1);
    await new Promise((wake) => setTimeout(wake, Math.max(due - performance.now(), 0)));
  }
  return { scans: index, seconds: (performance.now() - begun) / 1000 };
}

/** Milliseconds between the frames of some seconds. */
function frameTimes(page, seconds) {
  return page.evaluate(async (long) => {
    const times = [];
    const begun = performance.now();
    let before = begun;
    while (before - begun < long * 1000) {
      const now = await new Promise((next) => requestAnimationFrame(next));
      times.push(now - before);
      before = now;
    }
    return times.slice(1);
  }, seconds);
}

/** Frames a second on the whole, and in the worst second. */
function rates(times) {
  let [worst, frames, spent] = [Infinity, 0, 0];
  for (const time of times) {
    frames += 1;
    spent += time;
    if (spent < 1000) continue;
    worst = Math.min(worst, (frames * 1000) / spent);
    [frames, spent] = [0, 0];
  }
  const all = times.reduce((sum, time) => sum + time, 0);
  const slowest = Math.max(...times);
  return { whole: (times.length * 1000) / all, worst, slowest };
}

async function liveFrames(browser) {
  const sensors = [
    { sensor_id: "radar", sigma_x_m: 10, sigma_y_m: 10, p_d: 0.95, clutter_per_m2: 1e-9 },
  ];
  const tracker = { initial_speed_sigma_mps: 80 };
  const { id } = await asked("/v1/sessions", { name: "speed", sensors, tracker });
  const path = `/v1/sessions/${id}`;
  const feed = { goesOn: true };
  const feeding = fed(path, feed);
  const page = await browser.newPage({ viewport: { width: 1440, height: 900 } });
  await page.goto(`${BASE}/?view=session&session=${id}`);
  await page.locator(".live-plan canvas").waitFor();
  await page.waitForTimeout(8000);
  const following = rates(await frameTimes(page, LIVE_S));
  const box = await page.locator(".live-plan canvas").boundingBox();
  await page.mouse.move(box.x + 400, box.y + 200);
  await page.mouse.down();
  const hand = { moves: true };
  const dragging = (async () => {
    for (let step = 0; hand.moves; step++)
      await page.mouse.move(box.x + 400 + 80 * Math.sin(step / 9), box.y + 200);
  })();
  const dragged = rates(await frameTimes(page, LIVE_S));
  hand.moves = false;
  await dragging;
  feed.goesOn = false;
  const { scans, seconds } = await feeding;
  const { tracks, last_scan } = await asked(`${path}/picture`);
  const drawn = await page.locator(".clock-text").innerText();
  await page.close();
  return { following, dragged, scans, seconds, tracks: tracks.length, last_scan, drawn };
}

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ARGUMENTS,
});
const rows = [];
const long = await longEvaluation();
rows.push([
  "summary, 1000 scans, 30 targets",
  await measured(browser, `?view=job&job=${long}`, ".counts-canvas", false),
]);
rows.push([
  "plan, 1000 scans, 30 targets",
  await measured(browser, `?view=job&job=${long}&tab=plan`, ".plan", true),
]);
for (const perScan of [10, 100, 1000]) {
  const id = await tracked(perScan);
  rows.push([
    `plan, ${perScan * 1000} detections`,
    await measured(browser, `?view=job&job=${id}&tab=plan`, ".plan", true),
  ]);
}
const live = await liveFrames(browser);
await browser.close();
const base = rows.find(([name]) => name === "plan, 10000 detections")[1];
console.log("view | first load | later loads | zoom | ratio of later loads and zoom to 10⁴");
for (const [name, { first, rest, zoom }] of rows) {
  const ratio =
    zoom === undefined ? "" : `${(rest / base.rest).toFixed(2)}, ${(zoom / base.zoom).toFixed(2)}`;
  console.log([name, first.toFixed(0), rest.toFixed(0), zoom?.toFixed(0) ?? "", ratio].join(" | "));
}
console.log("live session | frames a second | in the worst second | longest frame (ms)");
for (const name of ["following", "dragged"]) {
  const { whole, worst, slowest } = live[name];
  console.log([name, whole.toFixed(1), worst.toFixed(1), slowest.toFixed(0)].join(" | "));
}
const { scans, seconds, tracks, last_scan, drawn } = live;
console.log(
  `${tracks} tracks, ${(scans / seconds).toFixed(1)} scans a second, ${last_scan} taken; on the page: ${drawn}`,
);
