// One drop on the page: a file is looked at before it is uploaded, faults stand where they are
// cured, and how a file was read is there for the next one.

import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { gzipSync } from "node:zlib";
import { baseStation, position, sentence } from "./ais.mjs";
import {
  allowRefusals,
  api,
  assertNothingSticksOut,
  BASE,
  byPointer,
  closePage,
  findings,
  NARROW,
  openPage,
  parameters,
  saved,
  startBrowser,
  uploaded,
} from "./support.mjs";

const FOLDER = process.env.TRACKLOOM_SCREENSHOTS ?? tmpdir();

/** 2023-11-14 22:13:20 UTC. */
const START_S = 1_700_000_000;
const SHIPS = [
  [235_000_001, 50.8],
  [235_000_002, 50.81],
];

/** Two ships at three times, a base station, and a sentence whose checksum is wrong. */
function ships() {
  const lines = [0, 1, 2].flatMap((step) =>
    SHIPS.map(([mmsi, lat_deg]) => {
      const at_s = START_S + 10 * step;
      return sentence(position(mmsi, lat_deg, -1.1 + step / 1000, at_s), at_s);
    }),
  );
  const broken = sentence(position(235_000_001, 50.8, -1.09, START_S + 30), START_S + 30);
  lines.push(sentence(baseStation(2_320_001), START_S + 25), broken.replace(/..$/, "00"));
  return `${lines.join("\n")}\n`;
}

/** Heights in feet, decimal commas, semicolons. */
const FEET = `who;when;lat;lon;alt
alpha;0;50,80;-1,10;1000
alpha;10;50,80;-1,09;1100
bravo;0;50,90;-1,20;2000
`;
const CURE = {
  who: "truth_id",
  when: "time_s",
  lat: "lat_deg",
  lon: "lon_deg",
  alt: "height_m [ft]",
};

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = await mkdtemp(join(tmpdir(), "trackloom-drop-"));
});
after(() => browser.close());

/** Holds files over the page and lets them go there. */
async function dropAll(page, files) {
  const dataTransfer = await page.evaluateHandle((all) => {
    const held = new DataTransfer();
    for (const [called, content] of all) held.items.add(new File([content], called));
    return held;
  }, files);
  // The page before has a heading, too, and takes nothing.
  await page.locator(".drop-page").waitFor();
  await page.dispatchEvent("h1", "dragover", { dataTransfer });
  await page.locator(".drop-page.over").waitFor();
  await page.dispatchEvent("h1", "drop", { dataTransfer });
  await page.locator(".drop-page.over").waitFor({ state: "detached" });
}

const drop = (page, name, text) => dropAll(page, [[name, text]]);

async function dropped(name, text) {
  const page = await openPage(browser, "?view=datasets");
  await page.locator("h1").waitFor();
  await drop(page, name, text);
  await page.locator(".look").waitFor();
  return page;
}

const column = (page, name) => page.locator(`[data-column="${name}"]`);
const faultOf = (page, name) =>
  page.locator("tr", { has: column(page, name) }).locator(".field-fault");
const kind = (page) => page.locator(".upload > label", { hasText: "Kind" }).locator("select");
const upload = (page) => page.getByRole("button", { name: "Upload", exact: true });

async function fillCure(page) {
  await kind(page).selectOption("truth");
  for (const [name, to] of Object.entries(CURE)) await column(page, name).fill(to);
}

/** What stands in a list of names and values. */
const factsOf = async (list) => {
  const [names, values] = await Promise.all(
    ["dt", "dd"].map((tag) => list.locator(tag).allInnerTexts()),
  );
  return Object.fromEntries(names.map((name, index) => [name, values[index]]));
};

/** Waits for the answer to what was told last: before it, the facts of the last answer stay. */
const factComes = (page, name, value) =>
  page.locator(`.found .facts dt:text-is("${name}") + dd:text-is("${value}")`).waitFor();

const unitsOf = (page) =>
  page
    .locator("table.units tbody tr")
    .evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.innerText)));

test("a feed dropped on the page is looked at; its units, times and places are told", async () => {
  const page = await dropped("harbour.nmea", ships());
  assert.equal(
    await page.locator("input[type=file]").evaluate((input) => input.files[0].name),
    "harbour.nmea",
  );
  await page.locator(".found").waitFor();
  const { Origin, ...facts } = await factsOf(page.locator(".found .facts"));
  assert.deepEqual(facts, {
    Kind: "truth",
    Format: "ais",
    Rows: "6",
    Targets: "2",
    From: "2023-11-14 22:13:20.000 UTC",
    To: "2023-11-14 22:13:40.000 UTC",
    Lasts: "20.0 s",
    Latitude: "50.8° to 50.81°",
    Longitude: "-1.1° to -1.098°",
  });
  assert.match(Origin, /^50\.8\d*°, -1\.\d+°$/);
  assert.match(await page.locator("table.units caption").innerText(), /^8 \w+s in the file$/);
  assert.deepEqual(await unitsOf(page), [
    ["used", "–", "6", "–"],
    ["ignored", "message 4", "1", "–"],
    ["rejected", "checksum", "1", "8"],
  ]);
  // Nothing of it was kept.
  assert.equal((await api("/v1/datasets?q=harbour.nmea")).items.length, 0);
  await upload(page).click();
  await page.waitForURL(/view=dataset&/);
  const set = await api(`/v1/datasets/${parameters(page).get("dataset")}`);
  assert.deepEqual([set.kind, set.format, set.rows, set.objects], ["truth", "ais", 6, 2]);
  await closePage(page);
});

test("the job to start from is opened with the data set in its form", async () => {
  const page = await dropped("strait.nmea", ships());
  await page.getByText("A job to start from: evaluate").click();
  await page.getByRole("button", { name: "Upload and open this job" }).click();
  await page.waitForURL(/view=new/);
  const set = (await api("/v1/datasets?q=strait.nmea")).items[0];
  await byPointer(page, "/truth/dataset_id").waitFor();
  assert.equal(await byPointer(page, "/truth/dataset_id").inputValue(), set.id);
  await page.getByText("The request is valid.").waitFor();
  await closePage(page);
});

test("a feed without times asks for its start, and is looked at again", async () => {
  const page = await dropped("bare.nmea", ships().replaceAll(/^\\.*?\\/gm, ""));
  const start = byPointer(page, "/upload/start");
  await start.fill("2023-11-14T22:13:20Z");
  await factComes(page, "To", "2023-11-14 22:13:40.000 UTC");
  assert.equal(await page.locator(".look .problem").count(), 0);
  allowRefusals(page, 422);
  await closePage(page);
});

test("semicolons and feet are cured by a mapping, which the next file is read with", async () => {
  const page = await dropped("first.csv", FEET);
  await page.locator(".look .problem").waitFor();
  await fillCure(page);
  await factComes(page, "Latitude", "50.8° to 50.9°");
  const facts = await factsOf(page.locator(".found .facts"));
  assert.deepEqual([facts.Rows, facts.Targets], ["3", "2"]);
  await upload(page).click();
  await page.waitForURL(/view=dataset&/);
  const id = parameters(page).get("dataset");
  const { columns, rows } = await api(`/v1/datasets/${id}/preview`);
  // 1000, 1100 and 2000 international feet of 0.3048 m.
  const heights = rows.map((row) => Number(row[columns.indexOf("height_m")]));
  assert.deepEqual(
    heights.sort((a, b) => a - b).map((height) => height.toFixed(2)),
    ["304.80", "335.28", "609.60"],
  );
  await page.getByRole("link", { name: "Data", exact: true }).click();
  await drop(page, "second.csv", FEET.replaceAll("alpha", "gamma"));
  await page.locator(".found").waitFor();
  const today = new Date().toLocaleDateString("sv");
  await page.getByText(`Read as with first.csv on ${today}.`).waitFor();
  assert.equal(await column(page, "alt").inputValue(), "height_m [ft]");
  assert.equal(await kind(page).inputValue(), "truth");
  // One click gives it up, and the file is looked at anew.
  await page.getByRole("button", { name: "Drop it" }).click();
  await page.locator(".look .problem").waitFor();
  assert.equal(await column(page, "alt").inputValue(), "");
  await drop(page, "other.csv", FEET.replace("who;", "name;"));
  await column(page, "name").waitFor();
  await page.locator(".look .problem").waitFor();
  assert.equal(await page.locator(".read-as").count(), 0);
  allowRefusals(page, 422);
  await closePage(page);
});

test("a mapping is saved as the program takes it, and loaded for another file", async () => {
  const page = await dropped("saved.csv", FEET);
  await fillCure(page);
  await page.getByText("Options", { exact: true }).click();
  await byPointer(page, "/upload/clock_offset_s").fill("2.5");
  const file = await saved(page, page.getByRole("button", { name: "Save the mapping" }));
  assert.equal(file.name, "saved-mapping.json");
  assert.deepEqual(JSON.parse(file.bytes), { columns: CURE, clock_offset_s: 2.5 });
  await factComes(page, "From", "2.5 s");
  const path = join(folder, file.name);
  await writeFile(path, file.bytes);
  await drop(page, "loaded.csv", FEET);
  await kind(page).selectOption("truth");
  const [chooser] = await Promise.all([
    page.waitForEvent("filechooser"),
    page.getByRole("button", { name: "Load a mapping" }).click(),
  ]);
  await chooser.setFiles(path);
  await page.getByText("Read as saved-mapping.json says.").waitFor();
  assert.equal(await byPointer(page, "/upload/clock_offset_s").inputValue(), "2.5");
  await factComes(page, "From", "2.5 s");
  allowRefusals(page, 422);
  await closePage(page);
});

test("a fault stands at its column before anything is uploaded, and goes with its cure", async () => {
  const page = await dropped("faulty.csv", FEET.replace("1100", "high"));
  await fillCure(page);
  await faultOf(page, "alt").getByText("expected a number, found 'high'").waitFor();
  assert.match(await faultOf(page, "alt").innerText(), /line 3/);
  assert.equal(await column(page, "alt").getAttribute("aria-invalid"), "true");
  await column(page, "alt").fill("height_m [furlong]");
  await faultOf(page, "alt").getByText("'furlong' is no unit", { exact: false }).waitFor();
  await page.getByText("shown above at the column", { exact: false }).waitFor();
  await column(page, "alt").fill("");
  await page.locator(".found").waitFor();
  assert.equal(await page.locator(".field-fault").count(), 0);
  allowRefusals(page, 422);
  await closePage(page);
});

test("of two answers the one to what is told last is shown", async () => {
  const page = await openPage(browser, "?view=datasets");
  let looks = 0;
  await page.route("**/v1/datasets?dry_run=true", async (route) => {
    looks += 1;
    if (looks === 1) await new Promise((wake) => setTimeout(wake, 1500));
    await route.continue().catch(() => undefined);
  });
  await page.locator("h1").waitFor();
  await drop(page, "slow.nmea", ships());
  await page.getByText("Looking…").waitFor();
  await kind(page).selectOption("detections");
  await page.locator(".found").waitFor();
  await page.waitForTimeout(2000);
  assert.equal((await factsOf(page.locator(".found .facts"))).Kind, "detections");
  assert.equal(looks, 2);
  await closePage(page);
});

test("a large file is looked at only when somebody asks", async () => {
  const path = join(folder, "large.bin");
  await writeFile(path, new Uint8Array(50_000_001));
  const page = await openPage(browser, "?view=datasets&upload=1");
  let looks = 0;
  page.on("request", (request) => (looks += request.url().includes("dry_run") ? 1 : 0));
  await page.locator("input[type=file]").setInputFiles(path);
  await page.getByText("The file has 50.0 MB.").waitFor();
  await page.waitForTimeout(1000);
  assert.equal(looks, 0);
  await page.getByRole("button", { name: "Look into it" }).click();
  await page.locator(".upload > label", { hasText: /the format could not be told/i }).waitFor();
  assert.equal(looks, 1);
  allowRefusals(page, 422);
  await closePage(page);
});

test("columns are shown of packed tables, of JSON, and under a comment; of feeds none", async () => {
  const record = { who: "alpha", when: 0, lat: 50.8, where: { lat: 1 } };
  const files = {
    "packed.csv.gz": [gzipSync(FEET), ["who", "when", "lat", "lon", "alt"]],
    "records.json": [JSON.stringify([record, record]), ["who", "when", "lat"]],
    "lines.json": [
      `${JSON.stringify(record)}\n${JSON.stringify(record)}\n`,
      ["who", "when", "lat"],
    ],
    "columns.json": [JSON.stringify({ columns: { who: ["alpha"], when: [0] } }), ["who", "when"]],
    "comment.csv": [
      "# a remark\n# Timestamp,MMSI\n01/02/2016 10:00:00,2\n",
      ["# Timestamp", "MMSI"],
    ],
    "quoted.txt": ['"a;b"|"c"\n1|2\n', ["a;b", "c"]],
    "harbour.nmea": [ships(), []],
  };
  const page = await openPage(browser, "?view=datasets&upload=1");
  for (const [name, [content, names]] of Object.entries(files)) {
    const buffer = Buffer.from(content);
    await page
      .locator("input[type=file]")
      .setInputFiles({ name, buffer, mimeType: "application/octet-stream" });
    await page.locator(".look .found, .look .problem, .look .field-fault").first().waitFor();
    const shown = await page
      .locator("[data-column]")
      .evaluateAll((all) => all.map((input) => input.dataset.column));
    assert.deepEqual(shown, names, name);
  }
  allowRefusals(page, 422);
  await closePage(page);
});

test("every column that the service knows is offered", async () => {
  const page = await dropped("names.csv", FEET);
  const offered = await page
    .locator("#upload-names option")
    .evaluateAll((all) => all.map((option) => option.value));
  for (const wanted of ["detections", "truth", "tracks"]) {
    const form = new FormData();
    const meta = { kind: wanted, columns: { who: "nothing" } };
    form.append("meta", new Blob([JSON.stringify(meta)], { type: "application/json" }));
    form.append("file", new Blob([FEET]), "names.csv");
    const answer = await fetch(`${BASE}/v1/datasets?dry_run=true`, { method: "POST", body: form });
    const fault = (await answer.json()).errors.find(({ pointer }) => pointer.endsWith("/who"));
    const missing = fault.allowed.split(", ").filter((name) => !offered.includes(name));
    assert.deepEqual(missing, [], wanted);
  }
  for (const name of ["covariance", "velocity"])
    assert.ok(offered.includes({ covariance: "p_xx", velocity: "vz_mps" }[name]), name);
  allowRefusals(page, 422);
  await closePage(page);
});

test("the page of a data set says how its file was read, and lends it to another", async () => {
  await uploaded("lender.csv", FEET, { kind: "truth", columns: CURE });
  const page = await openPage(browser, "?view=datasets");
  await page.getByRole("link", { name: "lender.csv" }).click();
  await page.getByRole("heading", { name: "Units of the file" }).waitFor();
  assert.deepEqual(await unitsOf(page), [["used", "–", "3", "–"]]);
  const panel = page.locator(".panel", { hasText: "How the file was read" });
  assert.deepEqual(await factsOf(panel), { kind: "truth", format: "csv", ...CURE });
  await panel.getByRole("link", { name: "Use for another file" }).click();
  await page.getByText("The next file is read as with lender.csv on", { exact: false }).waitFor();
  await drop(page, "borrower.csv", FEET.replace("alt", "up"));
  await page.getByText("Read as with lender.csv on", { exact: false }).waitFor();
  await page.locator(".found").waitFor();
  assert.equal(await column(page, "who").inputValue(), "truth_id");
  // A column that this file does not have is not told.
  assert.equal(await column(page, "up").inputValue(), "");
  await closePage(page);
});

test("the keyboard reaches everything, in order", async () => {
  const page = await dropped("keys.csv", FEET);
  await page.locator(".look .problem").waitFor();
  const asked = ["input[type=file]", "select", "select", "button.primary", ".mapping", "input"];
  await page.locator("input[type=file]").focus();
  for (const selector of asked) {
    const isThere = await page.evaluate((of) => document.activeElement.matches(of), selector);
    assert.ok(isThere, `${selector} has the focus`);
    await page.keyboard.press("Tab");
  }
  await page.locator(".options summary").focus();
  await page.keyboard.press("Enter");
  await byPointer(page, "/upload/time_format").waitFor();
  allowRefusals(page, 422);
  await closePage(page);
});

for (const theme of ["light", "dark"]) {
  test(`nothing sticks out at 360 px and axe finds nothing, ${theme}`, async () => {
    for (const [name, text] of [
      ["found.nmea", ships()],
      ["faulty.csv", FEET.replace("1100", "high")],
    ]) {
      const page = await openPage(browser, `?view=datasets&theme=${theme}`, {
        width: 1280,
        height: 900,
      });
      await page.locator("h1").waitFor();
      await drop(page, name, text);
      await page.locator(".look .found, .look .problem").waitFor();
      if (name === "faulty.csv") {
        await fillCure(page);
        await faultOf(page, "alt").waitFor();
        await page.getByText("Options", { exact: true }).click();
        allowRefusals(page, 422);
      } else await page.getByText("A job to start from").click();
      assert.deepEqual(await findings(page), []);
      for (const viewport of [{ width: 1280, height: 900 }, NARROW]) {
        await page.setViewportSize(viewport);
        await assertNothingSticksOut(page, `${name} at ${viewport.width} px`);
        const picture = `upload-${name.split(".")[0]}-${theme}-${viewport.width}.png`;
        await page.screenshot({ path: join(FOLDER, picture), fullPage: true });
      }
      await closePage(page);
    }
  });
}

test("of several dropped files one comes after the other, and one may be skipped", async () => {
  const page = await openPage(browser, "?view=datasets");
  const truth = (name) => [name, `time_s,truth_id,x_m,y_m\n0,${name},0,0\n1,${name},1,1\n`];
  await dropAll(page, ["one.csv", "two.csv", "three.csv"].map(truth));
  await page.getByText("2 more files: two.csv, three.csv").waitFor();
  await page.locator(".found").waitFor();
  await upload(page).click();
  await page.getByText("1 more file: three.csv").waitFor();
  await page.getByRole("link", { name: "one.csv" }).first().waitFor();
  await page.getByRole("button", { name: "Skip this one" }).click();
  await page.getByText("1 more file").waitFor({ state: "detached" });
  await page.locator(".found").waitFor();
  await upload(page).click();
  await page.getByRole("heading", { name: "three.csv" }).waitFor();
  const found = await (await fetch(`${BASE}/v1/datasets?q=two.csv`)).json();
  assert.equal(found.items.length, 0);
  await closePage(page);
});
