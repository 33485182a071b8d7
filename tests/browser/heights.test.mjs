// Heights over time of what is in a volume: the points of the job, up to the clock, drawn where they
// are; and nothing of the kind where all is in the plane.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { twinOf } from "./reading.mjs";
import { dataset } from "./recordings.mjs";
import {
  closePage,
  decodedPng,
  drawn,
  finished,
  frameOf,
  hexOf,
  openPage,
  paletteColor,
  saved,
  settle,
  shown,
  startBrowser,
  uploaded,
} from "./support.mjs";

/** A climbs by unequal steps, its track 2 m above it and 1 m aside; B ends before. */
const HEIGHTS = [100, 110, 150, 160, 250];
const truthRows = HEIGHTS.flatMap((height, time) => [
  ["truth", "A", time, height],
  ...(time < 3 ? [["truth", "B", time, 300]] : []),
]);
const trackRows = HEIGHTS.map((height, time) => ["track", "T", time, height + 2]);

const tableOf = (rows, name, has) =>
  [
    `time_s,${name},x_m,y_m${has ? ",z_m" : ""}`,
    ...rows.map(([layer, id, time, height]) => {
      const place = `${10 * time},${layer === "truth" ? 0 : 1}`;
      return `${time},${id},${place}${has ? `,${height}` : ""}`;
    }),
  ].join("\n");

async function judged(name, hasHeights) {
  const sets = [
    await uploaded(`${name} truth.csv`, tableOf(truthRows, "truth_id", hasHeights)),
    await uploaded(`${name} tracks.csv`, tableOf(trackRows, "track_id", hasHeights)),
  ];
  const [truth, tracks] = sets.map((set) => dataset(set));
  return finished("evaluate", { name, truth, tracks, comparison: { gate_m: 10 } });
}

let browser;
let volume;
let plane;
before(async () => {
  browser = await startBrowser();
  [volume, plane] = [await judged("browser volume", true), await judged("browser plane", false)];
});
after(() => browser.close());

/** The points of all lines of one colour in a saved SVG, one list a line. */
const strokesOf = (page, bytes, color) =>
  page.evaluate(
    ([text, wanted]) => {
      const sheet = new DOMParser().parseFromString(text, "image/svg+xml");
      const paths = [...sheet.querySelectorAll("path")].filter(
        (path) =>
          path.getAttribute("stroke")?.toLowerCase() === wanted &&
          /^[ML\d. -]+$/.test(path.getAttribute("d")),
      );
      const lines = paths.flatMap((path) => path.getAttribute("d").split(/(?=M)/));
      return lines.map((line) =>
        [...line.matchAll(/(-?[\d.]+)[ ,](-?[\d.]+)/g)].map(([, x, y]) => [Number(x), Number(y)]),
      );
    },
    [bytes.toString(), color],
  );

test("heights are drawn over time where they are, and as in the table", async () => {
  const page = await openPage(browser, `?view=job&job=${volume.job.id}&tab=plan`);
  const frame = frameOf(page, "Height over time");
  await drawn(frame);
  await settle(page);
  const svg = await saved(page, frame.getByRole("button", { name: "SVG" }));
  const lines = await strokesOf(page, svg.bytes, await hexOf(page, "--chart-track"));
  const line = lines.find((points) => points.length === HEIGHTS.length);
  assert.ok(line, JSON.stringify(lines));
  // Pixels go down as heights go up, all by one scale; times are equal steps.
  const scale = (line[0][1] - line[4][1]) / (HEIGHTS[4] - HEIGHTS[0]);
  assert.ok(scale > 0.3, `${scale} px for a metre`);
  for (const [time, height] of HEIGHTS.entries()) {
    const [x, y] = line[time];
    assert.ok(Math.abs(y - (line[0][1] - scale * (height - HEIGHTS[0]))) < 1, `height ${height}`);
    assert.ok(Math.abs(x - (line[0][0] + (time / 4) * (line[4][0] - line[0][0]))) < 1, `x ${time}`);
  }
  const rows = (await twinOf(page, "Height over time")).map((row) => row.slice(0, 4));
  const order = (a, b) => `${a}`.localeCompare(`${b}`);
  const wanted = [...truthRows, ...trackRows].map(([layer, id, time, height]) => [
    layer,
    id,
    shown(time),
    shown(height),
  ]);
  assert.deepEqual(rows.sort(order), wanted.sort(order));
  await closePage(page);
});

test("the clock and the layers of the plan are those of the heights", async () => {
  const page = await openPage(browser, `?view=job&job=${volume.job.id}&tab=plan`);
  const frame = frameOf(page, "Height over time");
  await drawn(frame);
  const color = await paletteColor(page, "--chart-truth");
  const inked = async () => {
    await settle(page);
    const png = await saved(page, frame.getByRole("button", { name: "PNG" }));
    return (await decodedPng(page, png.bytes, color)).colored;
  };
  const all = await inked();
  await page.getByRole("button", { name: "truth", exact: true }).click();
  const without = await inked();
  assert.ok(all > without + 200, `${all} pixels of truth, ${without} when it is hidden`);
  await page.getByRole("button", { name: "truth", exact: true }).click();
  await page.getByRole("button", { name: "To the first scan" }).click();
  assert.deepEqual(
    (await twinOf(page, "Height over time")).map((row) => row.slice(0, 4)),
    [
      ["truth", "A", "0", "100"],
      ["truth", "B", "0", "300"],
      ["track", "T", "0", "102"],
    ],
  );
  await closePage(page);
});

test("what is in the plane has no picture of heights", async () => {
  const page = await openPage(browser, `?view=job&job=${plane.job.id}&tab=plan`);
  await drawn(frameOf(page, "Plan view"));
  assert.equal(await frameOf(page, "Height over time").count(), 0);
  await closePage(page);
});
