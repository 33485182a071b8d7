// Every number on the pages of an evaluation is the report's, to the last printed digit: all views,
// all tables, all rows.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  assertSame,
  capital,
  count,
  factsOf,
  oneLine,
  open,
  panelOf,
  printed,
  rowsOf,
  share,
  twinOf,
  words,
} from "./reading.mjs";
import { api, closePage, evaluated, shown, startBrowser } from "./support.mjs";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

test("the summary of an evaluation", async () => {
  const { job, report } = await evaluated();
  const { tfa, association, metrics, events } = report.result;
  const page = await open(browser, `?view=job&job=${job.id}`, ".verdict-card");
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
      ["Missed, but followed from later on", count(tfa.counts.late)],
      ["Missed, but matched by a track", count(tfa.missed_with_matched_track)],
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
  const page = await open(browser, `?view=job&job=${job.id}&tab=verdicts`, ".verdict-row");
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
  const page = await open(browser, `?view=job&job=${job.id}&tab=metrics`, ".metric-group");
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
    browser,
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
