// Every number on the pages of the other kinds of job is the report's, to the last printed digit: all
// tables, all rows.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  assertSame,
  count,
  factsOf,
  leaves,
  oneLine,
  open,
  panelOf,
  range,
  rowsOf,
  share,
  traceOf,
  twinOf,
  words,
} from "./reading.mjs";
import {
  api,
  campaign,
  closePage,
  clustered,
  correlated,
  evaluated,
  finished,
  frameOf,
  grouped,
  preset,
  shown,
  startBrowser,
} from "./support.mjs";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

test("a correlation: figures, every tuple, the search", async () => {
  const { job, report } = await correlated();
  const { result } = report;
  const page = await open(browser, `?view=job&job=${job.id}&tab=correlation`, "table.tuples");
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
      browser,
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
  const page = await open(browser, `?view=job&job=${job.id}`, ".grid-cell");
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
    browser,
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
  const page = await open(browser, `?view=job&job=${job.id}&tab=search`, "table.grid");
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
  const summary = await open(browser, `?view=job&job=${job.id}`, ".panel");
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
  const page = await open(browser, `?view=job&job=${job.id}&tab=search`, "table.grid");
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
