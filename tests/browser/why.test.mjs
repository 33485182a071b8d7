// Ribbons, the map of all tracks, and why: what they show against the files that the job left.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  BASE,
  closePage,
  decodedPng,
  drawn,
  finished,
  frameOf,
  openPage,
  paletteColor,
  parameters,
  parsedSvg,
  preset,
  saved,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
let job;
let files;
before(async () => {
  browser = await startBrowser();
  const body = await preset("liang2009-100");
  body.name = "browser: why";
  body.associator = { method: "jpda" };
  // Dense, so that tracks share detections and break.
  body.input.scenario.targets.area_side_m = 12_000;
  body.input.scenario.sensors[0].clutter_per_scan = 60;
  ({ job } = await finished("evaluate", body));
  files = await read(job.id);
});
after(() => browser.close());

/** Lines of CSV with quotes, as objects. */
function parsed(text) {
  const [head, ...rows] = [...text.trim().split(/\r?\n/)].map((line) =>
    [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(
      ([, quoted, bare]) => quoted?.replaceAll('""', '"') ?? bare,
    ),
  );
  return rows.map((row) => Object.fromEntries(head.map((name, at) => [name, row[at]])));
}

async function read(id) {
  const table = async (name) =>
    parsed(await (await fetch(`${BASE}/v1/jobs/${id}/artifacts/${name}`)).text());
  const [tracks, detections, causes, truth] = await Promise.all(
    ["tracks.csv", "detections.csv", "causes.csv", "truth.csv"].map(table),
  );
  const origins = new Map(detections.map((row) => [row.detection_id, row.truth_id]));
  const sums = new Map();
  for (const row of tracks) {
    const target = origins.get(row.detection_id);
    if (!row.detection_id || !target) continue;
    const of = sums.get(row.track_id) ?? new Map();
    sums.set(row.track_id, of);
    of.set(target, (of.get(target) ?? 0) + Number(row.probability));
  }
  const most = ([, of]) => [...of].reduce((best, each) => (each[1] > best[1] ? each : best))[0];
  const own = new Map([...sums].map((entry) => [entry[0], most(entry)]));
  return { tracks, origins, causes, own, truth };
}

/** Pseudo-random, the same each time. */
function picked(items, count) {
  let state = 7;
  const next = () => {
    state = (state * 1664525 + 1013904223) % 2 ** 32;
    return state / 2 ** 32;
  };
  return Array.from({ length: count }, () => items[Math.floor(next() * items.length)]);
}

const close = (one, other, message) =>
  assert.ok(
    Math.abs(one - other) <= 0.002 * Math.max(1, Math.abs(other)),
    `${message}: ${one}, ${other}`,
  );

async function goTo(page, track, time) {
  await page.evaluate(
    ([name, at]) => {
      const next = new URLSearchParams(location.search);
      next.set("track", name);
      next.set("time", at);
      next.delete("truth");
      history.replaceState(null, "", `?${next}`);
      dispatchEvent(new PopStateEvent("popstate"));
    },
    [track, time],
  );
}

const cells = (page, selector) =>
  page
    .locator(selector)
    .evaluateAll((rows) =>
      rows.map((row) => [...row.querySelectorAll("td")].map((cell) => cell.innerText)),
    );

/** What the panel should say of a track at a time. */
function expected(track, time) {
  const rows = files.tracks.filter((row) => row.track_id === track && row.time_s === time);
  const own = files.own.get(track);
  const now = Number(time);
  const causes = files.causes.filter(
    (row) =>
      Number(row.from_s) <= now &&
      Number(row.to_s) >= now &&
      (row.track_id === track || row.other_track_id === track || (own && row.truth_id === own)),
  );
  const origin = (id) => {
    const target = files.origins.get(id);
    if (!target) return "clutter";
    return target === own ? `own target ${target}` : `target ${target}`;
  };
  const candidates = rows
    .map(({ detection_id: id, probability }) => [
      id || "none (ε)",
      id ? origin(id) : "–",
      Number(probability).toFixed(3),
    ])
    .sort();
  return { causes, candidates, nis: rows[0].nis, rows, own };
}

test("panel, candidates, distances and sentences are those of the files at 100 moments", async () => {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan&track=1&time=0`);
  await page.locator(".why .candidates").waitFor();
  let sentences = 0;
  let compared = 0;
  for (const { track_id: track, time_s: time } of picked(files.tracks, 100)) {
    const { causes, candidates, nis, rows, own } = expected(track, time);
    await goTo(page, track, time);
    await page.waitForFunction(
      (ids) =>
        document.querySelector(".why .candidates")?.innerText &&
        ids.every((id) => document.querySelector(".why .candidates").innerText.includes(id)),
      candidates.map(([id]) => id),
    );
    if (nis)
      await page.waitForFunction(() =>
        [...document.querySelectorAll(".why .candidates tbody tr")].every(
          (row) => row.cells[0].innerText.startsWith("none") || row.cells[3].innerText !== "–",
        ),
      );
    const found = await cells(page, ".why .candidates tbody tr");
    assert.deepEqual(found.map((row) => row.slice(0, 3)).sort(), candidates, `${track} at ${time}`);
    const facts = await page.locator(".why dl.facts").innerText();
    const told = /NIS\s+(\S+)/.exec(facts)?.[1];
    assert.equal(told, nis ? shown(Number(nis)) : "–", `NIS of ${track} at ${time}`);
    if (nis) {
      // The tracker's own: the mean of the squared distances by their weights.
      const weights = new Map(rows.map((row) => [row.detection_id, Number(row.probability)]));
      const inside = found.filter(([id]) => weights.has(id));
      const sum = inside.reduce((total, [id]) => total + weights.get(id), 0);
      const mean = inside.reduce((total, row) => total + weights.get(row[0]) * Number(row[3]), 0);
      close(mean / sum, Number(nis), `mean d² of ${track} at ${time}`);
      compared += 1;
    }
    const place = files.truth.find((row) => row.truth_id === own && row.time_s === time);
    if (place) {
      const away = Math.hypot(rows[0].x_m - place.x_m, rows[0].y_m - place.y_m);
      assert.ok(facts.includes(`${away.toFixed(1)} m`), `distance ${away} in ${facts}`);
    }
    const told2 = await page.locator(".why .why-sentence > p:last-child").allInnerTexts();
    const should = causes.map(({ sentence }) => sentence[0].toUpperCase() + sentence.slice(1));
    assert.deepEqual(told2.sort(), should.sort(), `sentences of ${track} at ${time}`);
    sentences += should.length;
  }
  assert.ok(compared >= 30 && sentences >= 10, `${compared} distances, ${sentences} sentences`);
  await closePage(page);
});

/** The shares of a track at a time, from the files. */
function shares(track) {
  const own = files.own.get(track);
  const byTime = new Map();
  for (const { time_s, detection_id, probability } of files.tracks.filter(
    (row) => row.track_id === track,
  )) {
    const sum = byTime.get(time_s) ?? [0, 0, 0, 0];
    byTime.set(time_s, sum);
    const target = files.origins.get(detection_id);
    const kind = !detection_id ? 3 : !target ? 2 : target === own ? 0 : 1;
    sum[kind] += Number(probability);
  }
  return byTime;
}

test("the ribbon of a track is saved as it is: table, ink and shapes", async () => {
  const track = "2";
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan&track=${track}&kept=3`);
  const frame = frameOf(page, `Association probability, ${track} and 3`);
  await drawn(frame);
  const csv = parsed(
    (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes.toString(),
  );
  const rows = files.tracks.filter((row) => ["2", "3"].includes(row.track_id));
  assert.equal(csv.length, rows.length);
  const sum = (of) => of.reduce((total, row) => total + Number(row.probability), 0);
  close(sum(csv), sum(rows), "sum of all probabilities");
  const png = await saved(page, frame.getByRole("button", { name: "PNG" }));
  const color = await paletteColor(page, "--chart-track");
  const { colored } = await decodedPng(page, png.bytes, color);
  assert.ok(colored > 2000, `${colored} pixels of the own target`);
  const svg = await saved(page, frame.getByRole("button", { name: "SVG" }));
  const { fault, texts } = await parsedSvg(page, svg.bytes);
  assert.equal(fault, undefined);
  assert.ok(
    texts.includes(`track ${track}`) && texts.includes(`of target ${files.own.get(track)}`),
  );
  await closePage(page);
});

test("the map of all tracks has the shares of the files, and leads to track and scan", async () => {
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=plan`);
  const frame = frameOf(page, "All tracks");
  await drawn(frame);
  const csv = parsed(
    (await saved(page, frame.getByRole("button", { name: "CSV" }))).bytes.toString(),
  );
  const names = [...new Set(csv.map((row) => row.track_id))];
  assert.equal(names.length, new Set(files.tracks.map((row) => row.track_id)).size);
  const doubts = [];
  for (const name of names) {
    const of = shares(name);
    const mine = csv.filter((row) => row.track_id === name);
    assert.equal(mine.length, of.size, `scans of ${name}`);
    let doubt = 0;
    for (const row of mine) {
      const should = of.get(row.time_s);
      const has = [row.own_target, row.other_targets, row.clutter, row.none].map(Number);
      for (const [at, share] of should.entries())
        assert.ok(
          Math.abs(share - has[at]) <= 0.002,
          `${name} at ${row.time_s}: ${has}, ${should}`,
        );
      doubt += should[1] + should[2];
    }
    doubts.push(doubt);
  }
  for (const [at, doubt] of doubts.entries())
    assert.ok(at === 0 || doubts[at - 1] >= doubt - 1e-9, "the worst first");
  const canvas = frame.locator("canvas");
  const box = await canvas.boundingBox();
  await canvas.click({ position: { x: box.width / 2, y: 8 } });
  assert.equal(parameters(page).get("track"), names[0]);
  const time = Number(parameters(page).get("time"));
  assert.ok(Math.abs(time - 112) <= 16, `the middle of 0 to 232 s, not ${time}`);
  await page.locator(".why").waitFor();
  await closePage(page);
});

test("two presses lead from a count of the report to the picture and the sentence", async () => {
  const { result } = await api(`/v1/jobs/${job.id}/report`);
  assert.ok(result.events.counts.miss > 0);
  const page = await openPage(browser, `?view=job&job=${job.id}&tab=metrics&event=miss`);
  await frameOf(page, "Events").locator("tbody a").first().click();
  await page.locator(".plan canvas").first().waitFor();
  const told = await page.locator(".why .why-sentence > p:last-child").first().innerText();
  assert.ok(
    files.causes.some(({ sentence }) => sentence.toLowerCase() === told.toLowerCase()),
    told,
  );
  await closePage(page);
});
