// A browser at the service, and pages that note everything they should not do.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";
import { serviceAddress } from "./service.mjs";

export const BASE = await serviceAddress();

export const WIDE = { width: 1440, height: 900 };
export const NARROW = { width: 360, height: 740 };

const CHROMIUM_ARGUMENTS = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

export function startBrowser() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: CHROMIUM_ARGUMENTS,
  });
}

/**
 * A page in a fresh context. `page.faults` gathers console errors, exceptions and requests that
 * leave the origin.
 */
export async function openPage(browser, query, viewport = WIDE) {
  const context = await browser.newContext({ viewport });
  const page = await context.newPage();
  page.faults = [];
  page.allowed = [];
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning")
      page.faults.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => page.faults.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    const inside = request.url().startsWith(BASE) || /^(data|blob):/.test(request.url());
    if (!inside) page.faults.push(`outside the origin: ${request.url()}`);
  });
  // A loaded machine is no fault of the page.
  page.setDefaultTimeout(60_000);
  await page.goto(`${BASE}/${query}`);
  return page;
}

/** Asserts what must hold on every page, then closes it. */
export async function closePage(page) {
  await assertCanvasesNamed(page);
  const isAllowed = (fault) => page.allowed.some((part) => fault.includes(part));
  assert.deepEqual(
    page.faults.filter((fault) => !isAllowed(fault)),
    [],
  );
  await page.context().close();
}

export async function assertCanvasesNamed(page) {
  const nameless = await page.$$eval(
    "canvas",
    (all) =>
      all.filter(
        (canvas) => canvas.getAttribute("role") !== "img" || !canvas.getAttribute("aria-label"),
      ).length,
  );
  assert.equal(nameless, 0, "every canvas has role=img and an aria-label");
}

export async function assertNothingSticksOut(page, name) {
  const beyond = await page.evaluate(
    () => document.documentElement.scrollWidth - window.innerWidth,
  );
  assert.ok(beyond <= 0, `${name} is ${beyond} px wider than the window`);
}

export async function api(path, body) {
  const options =
    body === undefined
      ? {}
      : {
          method: "POST",
          headers: { "content-type": "application/json" },
          body: JSON.stringify(body),
        };
  const answer = await fetch(`${BASE}${path}`, options);
  assert.ok(answer.ok, `${path} answered ${answer.status}: ${await answer.clone().text()}`);
  return answer.json();
}

/** Waits until the job of this id has ended; answers the job. */
export async function ended(id) {
  for (let tries = 0; tries < 600; tries++) {
    const job = await api(`/v1/jobs/${id}`);
    if (!["queued", "running"].includes(job.state)) return job;
    await new Promise((wake) => setTimeout(wake, 100));
  }
  throw new Error(`job ${id} did not end within a minute`);
}

export async function preset(name) {
  return structuredClone((await api(`/v1/presets/${name}`)).body);
}

/** A finished evaluation of a scene dense enough that some verdicts are false. */
export async function evaluated(count = 100) {
  const body = await preset("liang2009-100");
  body.name = `browser scene ${count}`;
  body.input.scenario.targets.count = count;
  const job = await ended((await api("/v1/jobs/evaluate", body)).id);
  assert.equal(job.state, "succeeded");
  return { job, report: await api(`/v1/jobs/${job.id}/report`) };
}

export function parameters(page) {
  return new URL(page.url()).searchParams;
}

export const byPointer = (page, pointer) => page.locator(`[data-pointer="${pointer}"]`);

/** Runs a job to its end and answers it with its report. */
export async function finished(kind, body) {
  const job = await ended((await api(`/v1/jobs/${kind}`, body)).id);
  assert.equal(job.state, "succeeded", JSON.stringify(job.error));
  return { job, report: await api(`/v1/jobs/${job.id}/report`) };
}

/**
 * Tracks of three sensors put together by a search that does not find the least cost: half of its
 * tuples are wrong.
 */
export async function correlated() {
  const body = await preset("huo2008");
  body.name = "browser tuples";
  Object.assign(body.input.tracks, { targets: 6, spacing_m: 800, p_d: 0.9 });
  body.statistic = { kind: "all_pairs" };
  // The published variant searches for some generations; the improved one knows the answer at once.
  body.correlator = { method: "genetic", variant: "paper" };
  return finished("correlate", body);
}

/**
 * Targets of directions in a bearing-time record, tracked by the bat algorithm, whose search is
 * written down.
 */
export async function bearingsTracked() {
  const body = await preset("wang-bat-record");
  body.name = "browser bearings";
  body.associator = { ...body.associator, trace: true };
  return finished("evaluate", body);
}

/** A small grid of two axes, with times. */
export async function campaign(runs = 4) {
  const base = await preset("liang2009-10");
  delete base.name;
  delete base.seed;
  return {
    name: "browser grid",
    seed: 3,
    base: { kind: "evaluate", ...base },
    grid: [
      {
        by: "values",
        name: "P_D",
        path: "/input/scenario/sensors/0/p_d",
        values: [0.7, 0.8, 0.95],
      },
      {
        by: "variants",
        name: "associator",
        variants: [
          { name: "NN", set: [{ path: "/associator", value: { method: "nearest_neighbour" } }] },
          { name: "JPDA", set: [{ path: "/associator", value: { method: "jpda" } }] },
        ],
      },
    ],
    runs,
    timed_runs: 2,
    outcomes: [
      { name: "P correct", path: "tfa.probability.correct" },
      { name: "GOSPA", path: "metrics.gospa.quantities.gospa" },
      { name: "all right", path: "tfa.consistent", interval: "wilson" },
    ],
  };
}

/** Fuzzy c-means over tracks, with its trace. */
export async function clustered() {
  const body = await preset("liang2009-30");
  body.name = "browser memberships";
  body.input.scenario.targets.count = 60;
  body.associator = { method: "fuzzy_c_means", trace: true };
  return finished("evaluate", body);
}

/** Reports of the same instants put into groups by fuzzy c-means, with its trace. */
export async function grouped() {
  const { kind: _, ...base } = (await preset("cai-fuzzy-cv-10")).base;
  return finished("group", {
    ...base,
    name: "browser groups",
    grouper: { ...base.grouper, method: "fuzzy_c_means", trace: true },
  });
}

/** A number as the dashboard prints it. */
export function shown(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e7)) return value.toExponential(3);
  return String(Number(value.toPrecision(size >= 1000 ? 7 : 4)));
}

/** The lines of a CSV file that a job made, cut at commas; the first names the columns. */
export async function linesOf(job, file) {
  const csv = await (await fetch(`${BASE}/v1/jobs/${job.id}/artifacts/${file}`)).text();
  return csv
    .trim()
    .split("\n")
    .map((line) => line.split(","));
}

/** Presses a button that saves a file; answers its name and content. */
export async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

/** Waits until the chart in a frame is drawn: that happens when it comes into view. */
export async function drawn(frame) {
  await frame.scrollIntoViewIfNeeded();
  await frame.locator("canvas").first().waitFor();
}

/**
 * Browsers note every refused request as an error; these were asked for. Where no number is given,
 * as many as there are until the page is closed.
 */
export function allowRefusals(page, status, times) {
  if (times === undefined) {
    page.allowed.push(`status of ${status}`);
    return;
  }
  const asked = page.faults.filter((fault) => fault.includes(`status of ${status}`));
  assert.equal(asked.length, times, `refusals with ${status}`);
  page.faults = page.faults.filter((fault) => !asked.includes(fault));
}

/** Uploads a file of this content; answers the data set. */
export async function uploaded(name, text, meta = {}) {
  const form = new FormData();
  form.append("meta", new Blob([JSON.stringify(meta)], { type: "application/json" }));
  form.append("file", new Blob([text]), name);
  const answer = await fetch(`${BASE}/v1/datasets`, { method: "POST", body: form });
  assert.ok(answer.ok, `upload of ${name}: ${await answer.clone().text()}`);
  return answer.json();
}

/** A framed chart or table by its title. */
export const frameOf = (page, name) =>
  page.locator(".chart-frame", { has: page.getByRole("heading", { name, exact: true }) });

/** What stands in the grid of a campaign, cell by cell, its lines divided by "\n". */
export async function gridOf(page, outcome) {
  const cells = await frameOf(page, `Cells: ${outcome}`).locator(".grid-cell").allInnerTexts();
  return cells.map((text) => text.replaceAll(/\n+/g, "\n"));
}

/**
 * What the grid should say; with the runs that a cell will have, where they are not all made yet.
 */
export function cellTexts(result, outcome, planned) {
  return result.cells.map(({ ended, runs, outcomes }) => {
    const { mean, interval, count } = outcomes[outcome];
    const made =
      ended === "not_yet"
        ? `${runs.toLocaleString("en-US")} of ${planned.toLocaleString("en-US")}`
        : count.toLocaleString("en-US");
    return [
      shown(mean),
      interval ? `[${shown(interval.low)}, ${shown(interval.high)}]` : "no interval",
      `${made} runs`,
    ].join("\n");
  });
}

/** Rules of axe whose findings depend on the theme. */
export const COLOR_RULES = ["color-contrast", "link-in-text-block"];

/** Rules of axe that fail seriously, with where; of these rules, or of all. */
export async function findings(page, rules) {
  // The page allows no inline script; axe comes in through the protocol of the browser.
  await page.evaluate(
    await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"),
  );
  const options = { resultTypes: ["violations"], ...(rules ? { runOnly: rules } : {}) };
  // What passes is long, and of no interest here.
  const violations = await page.evaluate(
    async (asked) => (await globalThis.axe.run(asked)).violations,
    options,
  );
  const reason = ({ any, all }) => any[0]?.message ?? all[0]?.message ?? "";
  const place = (node) => `${node.target.join(" ")} (${reason(node)})`;
  return violations
    .filter((rule) => ["serious", "critical"].includes(rule.impact))
    .map((rule) => `${rule.id}: ${rule.nodes.slice(0, 3).map(place).join("; ")}`);
}

/** Waits until all that is in view has come and is drawn. */
export async function settle(page) {
  await page.waitForFunction(() => {
    const isSeen = (box) => {
      const { top, bottom, width } = box.getBoundingClientRect();
      return width > 0 && bottom > 1 && top < window.innerHeight - 1;
    };
    const boxes = [...document.querySelectorAll(".chart-canvas")].filter(isSeen);
    return !document.querySelector(".loading") && boxes.every((box) => box.querySelector("canvas"));
  });
  await frames(page, 3);
}

/** Pictures that the browser makes: the first notes a change, the next ones show what follows. */
const frames = (page, count) =>
  page.evaluate(async (left) => {
    for (let made = 0; made < left; made++) await new Promise(requestAnimationFrame);
  }, count);

/** Charts are drawn when they come into view. */
export async function seeAll(page) {
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  for (let y = 0; y < height; y += page.viewportSize().height / 2) {
    await page.evaluate((to) => window.scrollTo(0, to), y);
    await settle(page);
  }
  await page.evaluate(() => window.scrollTo(0, 0));
  await settle(page);
}

/** The page believes that it is hidden, or seen again. */
export const hide = (page, hidden) =>
  page.evaluate((is) => {
    Object.defineProperty(document, "hidden", { configurable: true, get: () => is });
    document.dispatchEvent(new Event("visibilitychange"));
  }, hidden);

/**
 * What an XML parser makes of a saved SVG: its first fault, else how many shapes of each colour and
 * the texts there are.
 */
export async function parsedSvg(page, bytes) {
  return page.evaluate((text) => {
    const sheet = new DOMParser().parseFromString(text, "image/svg+xml");
    const fault = sheet.querySelector("parsererror")?.textContent;
    if (fault) return { fault };
    const shapes = [...sheet.querySelectorAll("path, rect, circle, line, polyline")];
    const colors = {};
    const places = {};
    const count = (table, key, by) => (table[key] = (table[key] ?? 0) + by);
    for (const shape of shapes.filter((each) => each.getAttribute("d") !== "")) {
      for (const name of ["fill", "stroke"]) {
        const color = shape.getAttribute(name) ?? shape.style[name];
        if (!color || color === "none" || color === "transparent") continue;
        count(colors, `${name} ${color.toLowerCase()}`, 1);
        // One path may hold many marks: each begins with a move.
        count(
          places,
          `${name} ${color.toLowerCase()}`,
          (shape.getAttribute("d")?.match(/m/gi) ?? [1]).length,
        );
      }
    }
    return {
      colors,
      places,
      texts: [...sheet.querySelectorAll("text")].map((node) => node.textContent),
    };
  }, bytes.toString());
}

/**
 * A saved PNG decoded: its size, how many pixels have the given colour, and how many are not the
 * background.
 */
export async function decodedPng(page, bytes, color) {
  return page.evaluate(
    async ([data, wanted]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [image.width, image.height];
      const pen = canvas.getContext("2d");
      pen.drawImage(image, 0, 0);
      const { data: pixels } = pen.getImageData(0, 0, canvas.width, canvas.height);
      const back = [pixels[0], pixels[1], pixels[2]];
      const near = (at, [r, g, b], by) =>
        Math.abs(pixels[at] - r) < by &&
        Math.abs(pixels[at + 1] - g) < by &&
        Math.abs(pixels[at + 2] - b) < by;
      let [ink, colored] = [0, 0];
      for (let at = 0; at < pixels.length; at += 4) {
        if (!near(at, back, 6)) ink += 1;
        if (wanted && near(at, wanted, 22)) colored += 1;
      }
      return { width: image.width, height: image.height, ink, colored };
    },
    [bytes.toString("base64"), color],
  );
}

/** A colour of the page's palette, laid over its surface with an opacity. */
export async function paletteColor(page, name, opacity = 1) {
  const read = (of) =>
    page.evaluate(
      (each) => getComputedStyle(document.documentElement).getPropertyValue(each).trim(),
      of,
    );
  const parts = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  const [color, surface] = [parts(await read(name)), parts(await read("--surface"))];
  return color.map((value, index) =>
    Math.round(value * opacity + (surface[index] ?? 255) * (1 - opacity)),
  );
}

export const hexOf = (page, name) =>
  page.evaluate(
    (each) =>
      getComputedStyle(document.documentElement).getPropertyValue(each).trim().toLowerCase(),
    name,
  );
