// Every number on the page is the report's, to the last printed digit: all views, all tables, all
// rows.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  api,
  BASE,
  campaign,
  closePage,
  clustered,
  correlated,
  evaluated,
  finished,
  grouped,
  openPage,
  preset,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

const count = (value) =>
  value === null || value === undefined ? "–" : value.toLocaleString("en-US");
const share = (value) => (value === null || value === undefined ? "–" : value.toFixed(3));
const range = (interval) => (interval ? `[${shown(interval.low)}, ${shown(interval.high)}]` : "–");
const words = (name) => {
  const bare = name.replace(/_(m|s|mps|m2ps3|deg|hz)$/, "");
  return /_[a-z]$/.test(bare) ? bare : bare.replaceAll("_", " ");
};
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

async function open(query, first) {
  const page = await openPage(browser, query);
  await page.locator(first).first().waitFor();
  await page.waitForFunction(() => !document.querySelector(".loading"));
  return page;
}

const frameOf = (page, name) =>
  page.locator(".chart-frame", { has: page.getByRole("heading", { name, exact: true }) });
const panelOf = (page, name) =>
  page.locator("section.panel", { has: page.getByRole("heading", { name, exact: true }) });
const oneLine = (text) => text.replaceAll(/\s+/g, " ").trim();
const rowsOf = (place) =>
  place
    .locator("tbody tr")
    .evaluateAll((rows) =>
      rows.map((row) =>
        [...row.cells].map((cell) => cell.innerText.replaceAll(/\s+/g, " ").trim()),
      ),
    );
/** Name and value of every line of a list of facts. */
const factsOf = (place) =>
  place
    .locator("dl.facts")
    .evaluate((list) =>
      [...list.querySelectorAll("dt")].map((name) => [
        name.textContent.trim(),
        name.nextElementSibling.textContent.trim(),
      ]),
    );

/** The table twin of a chart, row by row, all of it. */
async function twinOf(page, name) {
  const frame = frameOf(page, name);
  await frame.getByRole("button", { name: "Table" }).click();
  const more = frame.getByRole("button", { name: "Show more" });
  while (await more.count()) await more.click();
  return rowsOf(frame);
}

/** Rows of columns, as a twin prints them. */
const printed = (columns) =>
  Object.values(columns)[0].map((_, row) =>
    Object.values(columns).map((column) =>
      typeof column[row] === "number" ? shown(column[row]) : (column[row] ?? "–"),
    ),
  );

/** Every number of what a method says of itself, with the names on the way to it. */
const leaves = (value, path = []) =>
  typeof value === "object" && value !== null
    ? Object.entries(value).flatMap(([name, inner]) => leaves(inner, [...path, words(name)]))
    : [
        [
          capital(path.join(", ")),
          typeof value === "number" ? shown(value) : value === null ? "–" : String(value),
        ],
      ];

/** The rows of a trace, by the names of its columns. */
async function traceOf(job, file) {
  const csv = await (await fetch(`${BASE}/v1/jobs/${job.id}/artifacts/${file}`)).text();
  const [head, ...lines] = csv
    .trim()
    .split("\n")
    .map((line) => line.split(","));
  return lines.map((line) => Object.fromEntries(head.map((name, index) => [name, line[index]])));
}

function assertSame(found, wanted, what) {
  assert.ok(wanted.length > 0, `${what}: there is something to compare`);
  assert.deepEqual(found, wanted, what);
}

test("the summary of an evaluation", async () => {
  const { job, report } = await evaluated();
  const { tfa, association, metrics, events } = report.result;
  const page = await open(`?view=job&job=${job.id}`, ".verdict-card");
  for (const name of ["correct", "missed", "false"]) {
    const card = oneLine(await page.locator(`.verdict-card.verdict-${name}`).innerText());
    if (name === "correct")
      assert.ok(
        card.endsWith(
          `correct per target ${share(tfa.ratios.correct_per_target)}, of ${count(tfa.counts.targets)}`,
        ),
        card,
      );
    assert.ok(
      card.includes(
        ` ${count(tfa.counts[name])} P = ${share(tfa.probability[name])} of ${count(name === "correct" ? tfa.counts.output_tracks : tfa.counts.targets)} `,
      ),
      card,
    );
  }
  assertSame(
    await factsOf(panelOf(page, "Output tracks")),
    [
      ["Output tracks", count(tfa.counts.output_tracks)],
      ["Matched", count(tfa.counts.matched_tracks)],
      ["Redundant", count(tfa.counts.redundant_tracks)],
      ["False", count(tfa.counts.false_tracks)],
      ["Output tracks per target", shown(tfa.ratios.output_tracks_per_target)],
      ["Correct per target", share(tfa.ratios.correct_per_target)],
      ["Missed, but taken up later", count(tfa.missed_with_matched_track)],
      ["Violations of one detection, one track", count(tfa.counts.violations)],
    ],
    "output tracks",
  );
  assertSame(
    await factsOf(panelOf(page, `Association, ${words(association.method)}`)),
    Object.entries(association.counts).map(([name, value]) => [capital(words(name)), count(value)]),
    "association",
  );
  assertSame(
    await factsOf(panelOf(page, "Metrics")),
    Object.entries(metrics).map(([name, { value, unit }]) => [
      name,
      `${shown(value)} ${unit}`.trim(),
    ]),
    "headlines",
  );
  assertSame(
    await factsOf(panelOf(page, "Events")),
    Object.entries(events.counts).map(([name, value]) => [capital(words(name)), count(value)]),
    "events",
  );
  assertSame(
    await twinOf(page, "Scan by scan"),
    printed((await api(`/v1/jobs/${job.id}/series/scan_counts`)).columns),
    "scan by scan",
  );
  await closePage(page);
});

/** Why a target is not correct, in the words of the page. */
function why({
  verdict,
  start_scan,
  matched_track_id,
  at_scan,
  track_id,
  took_kind,
  took,
  took_truth_id,
  expected,
}) {
  if (verdict === "correct") return "–";
  if (verdict === "missed") {
    if (!start_scan) return "The target was never detected.";
    return `No track began with the target's first detection, at scan ${start_scan}.${matched_track_id ? ` Track ${matched_track_id} took it up later.` : ""}`;
  }
  const wanted = `; expected ${expected ?? "nothing, since the target had ended"}.`;
  if (took_kind === "ended")
    return `Before scan ${at_scan} the string of track ${track_id} had ended${wanted}`;
  const what = {
    epsilon: "no detection (ε)",
    target: `${took} of target ${took_truth_id}`,
    clutter: `${took}, which is clutter`,
  }[took_kind];
  return `At scan ${at_scan} track ${track_id} took ${what}${wanted}`;
}

test("the verdicts, target by target, and the tolerance", async () => {
  const { job, report } = await evaluated();
  const { tfa } = report.result;
  const page = await open(`?view=job&job=${job.id}&tab=verdicts`, ".verdict-row");
  const took = (target) =>
    target.took_kind
      ? ({ ended: "nothing", epsilon: "ε" }[target.took_kind] ?? target.took ?? "–")
      : "–";
  const wanted = tfa.targets.map((target) => [
    target.truth_id,
    target.verdict,
    count(target.at_scan),
    target.expected ?? "–",
    took(target),
    count(target.errors),
    shown(target.log_probability),
    target.track_id ?? target.matched_track_id ?? "–",
    why(target),
  ]);
  const rows = (
    await rowsOf(page.locator(".table-scroll", { has: page.locator(".verdict-row") }))
  ).map((row) => row.filter((_, column) => column !== 5));
  const byName = (a, b) => (a[0] < b[0] ? -1 : 1);
  assertSame(rows.sort(byName), wanted.sort(byName), "verdicts");
  for (const name of ["correct", "missed", "false"])
    assert.equal(
      oneLine(await page.locator(`.set-${name} h2`).innerText()),
      `${name} ${count(tfa.counts[name])}`,
    );
  assertSame(
    await twinOf(page, "Tolerance"),
    tfa.tolerance.map(({ k, correct, probability }) => [
      shown(k),
      shown(correct),
      shown(probability),
    ]),
    "tolerance",
  );
  await closePage(page);
});

/** What TrackEval calls the quantities of CLEAR. */
const CLEAR = {
  ...{
    mota: "MOTA",
    moda: "MODA",
    motp_similarity: "MOTP",
    motp_distance: "MOTP as a distance",
    smota: "sMOTA",
    motal: "MOTAL",
  },
  ...{
    recall: "CLR_Re",
    precision: "CLR_Pr",
    f1: "CLR_F1",
    tp: "CLR_TP",
    fn: "CLR_FN",
    fp: "CLR_FP",
    fp_per_step: "FP_per_frame",
  },
  ...{
    idsw: "IDSW",
    frag: "Frag",
    frag_trackeval: "Frag of TrackEval",
    mt: "MT",
    pt: "PT",
    ml: "ML",
    mt_share: "MTR",
    pt_share: "PTR",
    ml_share: "MLR",
  },
};

test("the metrics, quantity by quantity, over time, and the events", async () => {
  const { job, report } = await evaluated();
  const page = await open(`?view=job&job=${job.id}&tab=metrics`, ".metric-group");
  for (const [name, metric] of Object.entries(report.result.metrics)) {
    const group = page.locator(`.metric-group[aria-label="${name}"]`);
    const headline = typeof metric.value === "number" ? shown(metric.value) : "undefined";
    assert.equal(
      oneLine(await group.locator(".metric-headline").innerText()),
      oneLine(`${headline} ${metric.unit}`),
      name,
    );
    const wanted = Object.entries(metric.quantities).map(([quantity, { value, unit, reason }]) => [
      (name === "clear" && CLEAR[quantity]) || quantity.replaceAll("_", " "),
      typeof value === "number" ? oneLine(`${shown(value)} ${unit}`) : (reason ?? "undefined"),
    ]);
    assertSame(await factsOf(group), wanted, name);
  }
  const { columns } = await api(`/v1/jobs/${job.id}/series/metrics`);
  const frame = page
    .locator(".chart-frame", { has: page.getByRole("combobox", { name: "Metric", exact: true }) })
    .first();
  await frame.getByRole("button", { name: "Table" }).click();
  const compared = new Set();
  const choice = frame.getByRole("combobox", { name: "Metric", exact: true });
  for (const name of await choice.locator("option").allInnerTexts()) {
    await choice.selectOption(name);
    const heads = (await frame.locator("thead th").allInnerTexts())
      .slice(1)
      .map((head) => head.replace(/ \(.*\)$/, ""));
    const wanted = columns.time_s.map((time, row) => [
      shown(time),
      ...heads.map((head) => shown(columns.values[head][row])),
    ]);
    assertSame(await rowsOf(frame), wanted, `${name} over time`);
    for (const head of heads) compared.add(head);
  }
  assert.deepEqual(
    [...compared].sort(),
    Object.keys(columns.values).sort(),
    "every column is in one of the charts",
  );
  await closePage(page);
});

test("the plan view's table, and the facts of a chosen track with its gate", async () => {
  const { job, report } = await evaluated(40);
  const track = report.result.association.tracks.find((line) => line.points > 10).track_id;
  const plan = await api(`/v1/jobs/${job.id}/plan`);
  const gates = await api(`/v1/jobs/${job.id}/series/gates?track=${track}`);
  const time = gates.columns.time_s[3];
  const page = await open(
    `?view=job&job=${job.id}&tab=plan&track=${track}&time=${time}`,
    ".plan canvas",
  );
  await page.getByText("innovation 1σ").waitFor();
  const facts = Object.fromEntries(await factsOf(page.locator(".selection")));
  const { columns } = plan.tracks;
  const row = columns.time_s.findIndex(
    (at, index) => at === time && columns.track_id[index] === track,
  );
  const metres = (...values) => `${values.map((value) => value.toFixed(1)).join(", ")} m`;
  assert.equal(facts.Position, metres(columns.x_m[row], columns.y_m[row]));
  assert.equal(
    facts["1σ east, north"],
    metres(Math.sqrt(columns.p_xx[row]), Math.sqrt(columns.p_yy[row])),
  );
  assert.equal(facts.Detection, columns.detection_id[row] ?? "none (ε)");
  assert.equal(
    facts.Gate,
    `d² ≤ ${shown(gates.threshold)}innovation 1σ ${metres(Math.sqrt(gates.columns.s_xx[3]), Math.sqrt(gates.columns.s_yy[3]))}`,
  );
  const rows = await twinOf(page, "Plan view");
  const layer = (name) =>
    rows.filter((cells) => cells[0] === name).map((cells) => cells.slice(0, 5));
  const until = (name, of, id) =>
    of.columns.time_s.flatMap((at, index) =>
      at <= time
        ? [
            [
              name,
              of.columns[id][index],
              shown(at),
              shown(of.columns.x_m[index]),
              shown(of.columns.y_m[index]),
            ],
          ]
        : [],
    );
  const sorted = (all) => all.map((cells) => cells.join(" ")).sort();
  assertSame(sorted(layer("truth")), sorted(until("truth", plan.truth, "truth_id")), "truth");
  assertSame(
    sorted(layer("detection")),
    sorted(until("detection", plan.detections, "detection_id")),
    "detections",
  );
  assertSame(sorted(layer("track")), sorted(until("track", plan.tracks, "track_id")), "tracks");
  assertSame(
    layer("gate"),
    [["gate", track, shown(time), shown(gates.columns.x_m[3]), shown(gates.columns.y_m[3])]],
    "gate",
  );
  await closePage(page);
});

test("a correlation: figures, every tuple, the search", async () => {
  const { job, report } = await correlated();
  const { result } = report;
  const page = await open(`?view=job&job=${job.id}&tab=correlation`, "table.tuples");
  const figures = Object.fromEntries(
    await page
      .locator(".figure")
      .evaluateAll((all) =>
        all.map((figure) => [
          figure.querySelector("dt").textContent,
          figure.querySelector("b").textContent,
        ]),
      ),
  );
  const { counts, truth } = result;
  const wanted = {
    "Cost J": shown(result.cost),
    "Dual bound": shown(result.dual_bound),
    Gap: `${shown(result.gap * 100)} %`,
    Tuples: count(counts.tuples),
    Alone: count(counts.unassociated),
    "Common times": count(counts.common_times),
    "Tuples right": `${count(truth.tuples_right)} of ${count(truth.tuples)}`,
    Pairs: share(truth.pairwise_precision),
    "False tracks": count(truth.false_tracks),
  };
  assert.deepEqual(figures, wanted);
  const rows = (await rowsOf(frameOf(page, "Tuples"))).map((row) =>
    row.map((cell) => cell.replace(/^below the threshold: ▾ /, "")),
  );
  const line = (tuple) => [
    tuple.system_track_id,
    ...tuple.tracks.map((track) => track ?? "absent"),
    shown(tuple.cost),
    shown(tuple.b),
    shown(tuple.statistic),
    String(tuple.degrees_of_freedom),
    shown(tuple.p_value),
    `${tuple.found}/${result.confirm.of}`,
    tuple.truth_id ?? "none",
    tuple.right ? "right" : "wrong",
  ];
  assertSame(rows, result.tuples.map(line), "tuples");
  assertSame(
    await twinOf(page, "Search"),
    result.search.best.map((best, index) => [
      shown(index + 1),
      shown(best),
      shown(result.search.mean[index]),
    ]),
    "search",
  );
  await closePage(page);
});

test("a campaign: every cell of every table", async () => {
  const { job, report } = await finished("campaign", await campaign());
  const { cells, outcomes } = report.result;
  for (const outcome of outcomes) {
    const page = await open(
      `?view=job&job=${job.id}&outcome=${encodeURIComponent(outcome)}`,
      ".grid-cell",
    );
    const found = (await page.locator(".grid-cell b").allInnerTexts()).map(oneLine);
    assertSame(
      found,
      cells.map((cell) => shown(cell.outcomes[outcome].mean)),
      `grid of ${outcome}`,
    );
    const compared = cells.filter((cell) => cell.differences[outcome]);
    const differences = (await rowsOf(frameOf(page, `Paired differences: ${outcome}`))).map((row) =>
      row.slice(0, 5),
    );
    assertSame(
      differences,
      compared.map((cell) => [
        cell.name,
        cell.compared_with,
        count(cell.differences[outcome].pairs),
        shown(cell.differences[outcome].mean),
        range(cell.differences[outcome].interval),
      ]),
      `differences of ${outcome}`,
    );
    const curves = await twinOf(page, `${outcome} over P_D`);
    const values = ({ mean, interval }) =>
      [shown(mean), shown(interval?.low), shown(interval?.high)].join(" ");
    assertSame(
      curves.map((row) => row.slice(2).join(" ")).sort(),
      cells.map((cell) => values(cell.outcomes[outcome])).sort(),
      `curves of ${outcome}`,
    );
    await closePage(page);
  }
  const page = await open(`?view=job&job=${job.id}`, ".grid-cell");
  const all = await rowsOf(frameOf(page, "All outcomes"));
  assertSame(
    all,
    cells.map((cell) => [
      cell.name,
      count(cell.runs),
      ...outcomes.map((name) =>
        oneLine(
          `${shown(cell.outcomes[name].mean)} ${cell.outcomes[name].interval ? range(cell.outcomes[name].interval) : ""}`,
        ),
      ),
    ]),
    "all outcomes",
  );
  assertSame(
    await rowsOf(frameOf(page, "Time of deciding")),
    report.timing.cells.map((time) => [
      time.cell,
      shown(time.decide_us_per_scan),
      shown(time.ratio),
      count(time.timed_runs),
    ]),
    "times",
  );
  await closePage(page);
});

test("a comparison: every number that differs, every paired difference", async () => {
  const first = await evaluated();
  const body = await preset("liang2009-100");
  Object.assign(body, { name: "compared digit by digit", associator: { method: "jpda" } });
  const second = await finished("evaluate", body);
  const comparison = await api(`/v1/compare?job=${first.job.id}&job=${second.job.id}`);
  const page = await open(
    `?view=compare&jobs=${first.job.id},${second.job.id}&same=1`,
    ".chart-frame tbody tr",
  );
  const numbers = (await rowsOf(frameOf(page, "Numbers"))).map((row) => row.slice(1));
  assertSame(
    numbers,
    comparison.numbers.map(({ values }) => values.map(shown)),
    "numbers",
  );
  const result = [first, second].map(({ report }) => report.result);
  for (const { path, values } of comparison.numbers) {
    const known = result.map((part) =>
      path.split(".").reduce((place, step) => place?.[step], part),
    );
    assert.deepEqual(
      values,
      known.map((value) => (typeof value === "object" ? (value?.value ?? null) : (value ?? null))),
      path,
    );
  }
  const differences = (await rowsOf(frameOf(page, "Paired differences"))).map((row) => [
    row[2],
    row[3],
    row[4],
    row[6],
    row[7],
  ]);
  const wanted = comparison.paired.flatMap(({ over, differences: all }) =>
    all.flatMap((each) =>
      each
        ? [
            [
              `${count(each.pairs)} ${over}`,
              shown(each.mean),
              range(each.interval),
              count(each.smaller),
              count(each.larger),
            ],
          ]
        : [],
    ),
  );
  assertSame(differences, wanted.slice(0, differences.length), "paired differences");
  await closePage(page);
});

test("a clustering: what the method says, memberships and centres", async () => {
  const { job, report } = await clustered();
  const page = await open(`?view=job&job=${job.id}&tab=search`, "table.grid");
  assertSame(
    await factsOf(page.locator(".diagnostics")),
    leaves(report.result.association.diagnostics),
    "diagnostics",
  );
  const trace = await traceOf(job, "association_trace.csv");
  const chosen = await page.getByRole("combobox", { name: "Search" }).inputValue();
  const [, occasion, cluster] = /occasion (\d+), cluster (\d+)/.exec(chosen);
  const own = trace.filter((row) => row.occasion === occasion && row.cluster === cluster);
  const last = Math.max(...own.map((row) => Number(row.iteration)));
  const heads = (await frameOf(page, "Memberships").locator("thead th").allInnerTexts())
    .slice(1)
    .map((name) => (name === "noise" ? "" : name));
  const rows = await rowsOf(frameOf(page, "Memberships"));
  const membership = (detection, track) =>
    own.find(
      (row) =>
        Number(row.iteration) === last &&
        ["u", "membership"].includes(row.quantity) &&
        row.detection === detection &&
        row.track === track,
    );
  const wanted = rows.map(([detection]) => [
    detection,
    ...heads.map((track) =>
      share(membership(detection, track) && Number(membership(detection, track).value)),
    ),
  ]);
  assertSame(rows, wanted, "memberships");
  const centre = (track, iteration) =>
    ["v1", "v2"].flatMap((name) =>
      own
        .filter(
          (row) =>
            Number(row.iteration) === iteration && row.quantity === name && row.track === track,
        )
        .map((row) => Number(row.value)),
    );
  const first = Math.min(...own.map((row) => Number(row.iteration)));
  const centres = (await rowsOf(frameOf(page, "Centres"))).map((row) => row.slice(0, 3));
  assertSame(
    centres,
    centres.map(([track]) => [
      track,
      centre(track, first).map(shown).join(", "),
      centre(track, last).map(shown).join(", "),
    ]),
    "centres",
  );
  await closePage(page);
});

test("a grouping: its quality, what the method says, memberships and the ways of the centres", async () => {
  const { job, report } = await grouped();
  const { grouping } = report.result;
  const summary = await open(`?view=job&job=${job.id}`, ".panel");
  assertSame(
    await factsOf(panelOf(summary, `Grouping, ${words(grouping.method)}`)),
    [
      ["Accuracy", share(grouping.accuracy)],
      ["Precision", share(grouping.precision)],
      ["Recall", share(grouping.recall)],
    ],
    "quality",
  );
  await closePage(summary);
  const page = await open(`?view=job&job=${job.id}&tab=search`, "table.grid");
  assertSame(await factsOf(page.locator(".diagnostics")), leaves(grouping.search), "diagnostics");
  const instant = parseFloat(await page.getByRole("combobox", { name: "Search" }).inputValue());
  const own = (await traceOf(job, "grouping_trace.csv")).filter(
    (row) => Number(row.time_s) === instant,
  );
  const value = (row) => Number(row.value);
  const last = Math.max(...own.map((row) => Number(row.iteration)));
  const memberships = own
    .filter((row) => Number(row.iteration) === last && row.quantity === "membership")
    .map((row) => share(value(row)));
  assertSame(
    (await rowsOf(frameOf(page, "Memberships"))).flatMap((row) => row.slice(1)),
    memberships,
    "memberships",
  );
  const { detection_id, x_m, y_m } = (
    await api(`/v1/jobs/${job.id}/plan?from=${instant}&to=${instant}`)
  ).detections.columns;
  const ways = await twinOf(page, `Ways of the centres, ${instant} s`);
  assertSame(
    ways.filter((row) => row[0] === "detection"),
    detection_id.map((id, row) => ["detection", id, "–", shown(x_m[row]), shown(y_m[row])]),
    "detections among the centres",
  );
  const centre = (name) =>
    own
      .filter((row) => row.quantity === name)
      .map((row) => [row.iteration, row.group, shown(value(row))].join(" "));
  const drawn = (column) =>
    ways.filter((row) => row[0] === "centre").map((row) => [row[2], row[1], row[column]].join(" "));
  assertSame(drawn(3).sort(), centre("centre_x_m").sort(), "centres, east");
  assertSame(drawn(4).sort(), centre("centre_y_m").sort(), "centres, north");
  await closePage(page);
});
