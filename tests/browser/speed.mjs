// How long views take, measured and not judged. Run it with a service on a free machine:
//
//   TRACKLOOM_URL=http://… node speed.mjs            makes the data, then measures
//
// Printed: the middle of seven loads in fresh browser contexts (milliseconds), and the ratio to the
// data of 10⁴ detections.

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
await browser.close();
const base = rows.find(([name]) => name === "plan, 10000 detections")[1];
console.log("view | first load | later loads | zoom | ratio of later loads and zoom to 10⁴");
for (const [name, { first, rest, zoom }] of rows) {
  const ratio =
    zoom === undefined ? "" : `${(rest / base.rest).toFixed(2)}, ${(zoom / base.zoom).toFixed(2)}`;
  console.log([name, first.toFixed(0), rest.toFixed(0), zoom?.toFixed(0) ?? "", ratio].join(" | "));
}
