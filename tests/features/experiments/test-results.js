// The result of an experiment as tables and charts: rows, columns and cells by its axes, agents and measure.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { unit } from "../../../static/features/experiments/distances.js";
import { pooledTable, timedTable, versusTable } from "../../../static/features/experiments/result-tables.js";
import { overviewOf, resultOf } from "../../../static/features/experiments/results.js";
import { options } from "../../../static/js/settings.js";
import { OPTIONS } from "../../page/options.js";

/** @import { Table } from "../../../static/features/experiments/result-tables.js" */
/** @import { Result } from "../../../static/features/experiments/results.js" */
/** @import { Summary } from "../../../static/js/types.js" */

const PLACE = {
  gait: "wave", observation: "measured", robot: "stiff", world: "flat", divisions: 2, grid_side_m: 0.04,
  half_side_m: 0.02, blocks: 0,
};
/** @param {number[]} points_m @param {number} iqm_m */
const distances = (points_m, iqm_m) =>
  ({ points_m, mean_m: iqm_m, median_m: iqm_m, iqm_m, low_m: iqm_m - 0.01, high_m: iqm_m + 0.01 });
const interval = (/** @type {number} */ iqm) => ({ iqm, low: iqm - 0.1, high: iqm + 0.1 });
const shareOf = (/** @type {number} */ share) => ({ share, low: 0, high: 1 });

const LEARNER = {
  ...PLACE, key: "wave/learner/500", role: "learner", agent: "learner", steps: 500, n: 3, best_known_m: 0.6,
  total: distances([0.3, 0.4, 0.5], 0.4), finished: distances([0.2, 0.3, 0.4], 0.3), walkers: shareOf(1),
  published: { total_m: 0.25, finished_m: 0.35, total_quantile: 0, finished_quantile: 0.5 },
};
const GREEDY = {
  ...PLACE, key: "wave/greedy", role: "reference", agent: "greedy", steps: 0, n: 1, best_known_m: 0.6,
  total: distances([0.5], 0.5), finished: distances([0.4], 0.4), walkers: null,
  published: { total_m: 0.5, finished_m: 0.375, total_quantile: null, finished_quantile: null },
};
const TWO_STEP = {
  ...GREEDY, key: "wave/two-step", agent: "two-step", total: distances([0.1], 0.1),
  published: { total_m: null, finished_m: 0.04, total_quantile: null, finished_quantile: null },
};

/** @param {object} changes */
const summaryOf = (changes) => /** @type {Summary} */ (/** @type {unknown} */ ({
  experiment: "table1", config: { steps: [500], seeds: 3, robots: ["stiff"], worlds: [] }, parameters: ["steps"],
  settings: [LEARNER, GREEDY, TWO_STEP], pooled: [], curves: [], versus: [], timed: [], worlds: [], ...changes,
}));
/** @param {Summary} summary */
const result = (summary) => /** @type {Result} */ (resultOf(summary));
/** @param {Summary} summary */
const firstContent = (summary, order = "grid") => result(summary).contentOf(result(summary).cases[0], { order });
/** Rows as [name, text of each cell]. @param {Table} table */
const textsOf = ({ groups }) => groups.flatMap(({ rows }) =>
  rows.map(({ title, cells }) => [title, ...cells.map(({ text = "–" }) => text)]));
/** @param {Table} table */
const titlesOf = ({ columns }) => columns.map(({ title }) => title);
const M = "\u00a0m";

beforeEach(() => {
  options.value = OPTIONS;
  unit.value = "m";
});

test("a published table has the paper's layout, with its names, values and their ranks", () => {
  const summary = summaryOf({});
  assert.equal(result(summary).title, "Table 1, with every seed");
  const [table] = firstContent(summary).tables;
  assert.deepEqual(titlesOf(table), ["Learner, 500 steps", "Greedy", "two-step", "Best known"]);
  const [{ title, note }] = table.groups;
  assert.deepEqual([title, note], ["The wave", "(The-Wave)"]);
  assert.deepEqual(textsOf(table), [
    ["At time-out", `0.30${M}`, `0.40${M}`, `0.40${M}`, "–"],
    ["Total", `0.40${M}`, `0.50${M}`, `0.10${M}`, `0.60${M}`],
  ]);
  const [finished, total] = table.groups[0].rows.map(({ cells }) => cells);
  assert.deepEqual(finished.map(({ printed }) => printed),
    [`paper 0.35${M}, above 50 % of seeds`, `paper 0.38${M}`, `paper 0.04${M}`, undefined]);
  assert.deepEqual(total.map(({ printed }) => printed),
    [`paper 0.25${M}, above 0 % of seeds †`, `paper 0.50${M}`, "paper: unfinished", undefined]);
  assert.equal(total[0].note, "0.39 – 0.41");
});

test("a strip has every seed, greedy, the best known walk and the paper's value; seeds are chosen in totals", () => {
  const [{ groups: [{ rows }] }] = firstContent(summaryOf({})).tables;
  const [finished, total] = rows.map(({ cells }) => cells[0].strip);
  assert.deepEqual(total?.points, [0.3, 0.4, 0.5]);
  assert.deepEqual(total?.marks, [
    { value: 0.5, kind: "greedy" }, { value: 0.6, kind: "best-known" }, { value: 0.25, kind: "published" },
  ]);
  assert.equal(total?.high, 1.03 * 0.6);
  assert.deepEqual(total?.source, { setting: LEARNER, points_m: [0.3, 0.4, 0.5] });
  assert.deepEqual(finished?.marks.map(({ kind }) => kind), ["greedy", "published"]);
  assert.equal(finished?.source, undefined);
  assert.equal(total?.label, `3 seeds from 0.30${M} to 0.50${M}; typically 0.40${M}, 95 % interval 0.39 – 0.41; ` +
    `greedy 0.50${M}; best known 0.60${M}; the paper 0.25${M}`);
});

test("all of a table has the unit that is chosen, the paper's values by its own greedy", () => {
  unit.value = "greedy";
  const [{ groups: [{ rows: [, { cells }] }] }] = firstContent(summaryOf({})).tables;
  assert.deepEqual(cells.map(({ text }) => text), ["80\u202f%", "100\u202f%", "20\u202f%", "120\u202f%"]);
  assert.equal(cells[0].printed, "paper 50\u202f%, above 0 % of seeds †");
  unit.value = "h";
  const [{ groups: [{ rows: [, row] }] }] = firstContent(summaryOf({})).tables;
  assert.equal(row.cells[0].text, "20.0\u202fh");
});

test("a table waits for its first seed", () => {
  const waiting = { ...LEARNER, total: null, finished: null };
  const [{ groups: [{ rows }] }] = firstContent(summaryOf({ settings: [waiting, GREEDY] })).tables;
  assert.deepEqual(rows[0].cells[0], { note: "waiting for its first seed" });
});

test("a switch chooses among the places of the settings", () => {
  const weak = [LEARNER, GREEDY].map((setting) => ({ ...setting, robot: "weak" }));
  const { cases } = result(summaryOf({ settings: [LEARNER, GREEDY, ...weak] }));
  assert.deepEqual(cases.map(({ world, place }) => [world, place?.robot]), [[null, "stiff"], [null, "weak"]]);
});

test("a sweep has a row for each setting, named by what differs, in the grid's order or the farthest first", () => {
  const far = { ...LEARNER, key: "far", steps: 1000, total: distances([0.5], 0.5), best_known_m: null };
  const summary = summaryOf({ experiment: "sweep", settings: [GREEDY, LEARNER, far] });
  const [table] = firstContent(summary).tables;
  assert.deepEqual(table.heads, ["Practice"]);
  assert.deepEqual(titlesOf(table),
    ["Total distance in 50 steps, a dot for each seed", "Share that walks", "Best known"]);
  assert.deepEqual(textsOf(table).map(([, ...texts]) => texts),
    [[`0.40${M}`, "100 %", `0.60${M}`], [`0.50${M}`, "100 %", "–"]]);
  const [best] = firstContent(summary, "best").tables;
  assert.deepEqual(best.groups[0].rows.map(({ key }) => key), ["far", LEARNER.key]);
  assert.deepEqual(result(summary).orders, ["grid", "best"]);
});

test("gaits together are shares of greedy's distance, without columns that have nothing", () => {
  const pooled = [500, 1000].map((steps) => ({
    ...LEARNER, steps, blocks: 1, gaits: ["wave", "tripod"], n: 60, relative: interval(0.8), of_best_known: null,
    reaches_greedy: shareOf(0.1), beats_greedy: { share: 0.3, verdict: "no" },
  }));
  const table = /** @type {Table} */ (pooledTable(summaryOf({ pooled })));
  assert.equal(table.title, "All gaits together");
  assert.deepEqual(titlesOf(table).slice(1), ["Share that walks", "Reach greedy", "Beats it at time-out", "Seeds"]);
  assert.deepEqual(textsOf(table)[0],
    ["500 steps, feet measured", "80 %", "100 %", "10 %", "30 %", "60"]);
  const [strip] = table.groups[0].rows[0].cells;
  assert.deepEqual([strip.note, strip.strip?.points], ["70 – 90", [0.6, 0.8, 1]]);
  assert.equal(table.groups[0].rows[0].cells[3].note, "less often than not");
  assert.equal(pooledTable(summaryOf({ pooled: [{ ...pooled[0], gaits: ["wave"] }] })), null);
});

test("pairs of learners and races under the real clock are tables as well", () => {
  const chance = { probability: 0.7, low: 0.6, high: 0.8, verdict: "yes" };
  const pair = { ...PLACE, steps: 500, a: "learner", b: "tracer", ...chance };
  assert.deepEqual(textsOf(versusTable(summaryOf({ versus: [pair] }))),
    [["The wave", "Learner", "Tracer", "70 %", "better"]]);
  const lanes = [
    { agent: "learner", decision_s: 0.5, finished_distance_m: 0.3, rank: 2 },
    { agent: "greedy", decision_s: 1, finished_distance_m: 0.4, rank: 1 },
  ];
  const table = timedTable(summaryOf({ timed: [{ ...PLACE, lanes }] }));
  assert.deepEqual(titlesOf(table), ["Learner", "Greedy"]);
  assert.deepEqual(table.groups[0].rows[0].cells.map(({ badge, note }) => [badge, note]),
    [["", "10 ms a decision"], ["first", "20 ms a decision"]]);
});

// ---- curves

const CURVE = { steps: [100, 200], iqm_m: [0.2, 0.4], low_m: [0.1, 0.3], high_m: [0.3, 0.5] };

test("practice in blocks is a chart for each gait, with every seed and as many steps in one go", () => {
  const blocks = {
    ...PLACE, ...CURVE, key: "b", agent: "learner", blocks: 2, greedy_m: 0.5, best_known_m: 0.6, walkers: [0, 0.5],
    points_m: [[0.1, 0.3], [0.3, 0.5]],
  };
  const summary = summaryOf({ experiment: "figure4", curves: [blocks, { ...blocks, key: "o", blocks: 1 }] });
  const { charts: [chart], tables } = firstContent(summary);
  assert.deepEqual(tables, []);
  assert.deepEqual(chart.lines.map(({ name, dots, dash, seeds }) => [name, dots, dash?.length, seeds?.length]),
    [["Learner", true, 0, 2], ["Learner, in one go", false, 2, 0]]);
  assert.deepEqual(chart.marks.map(({ kind, y }) => [kind, y]), [["greedy", 0.5], ["best-known", 0.6]]);
  assert.equal(chart.note, `0.40${M}, 50 % walk · 0.40${M} in one go · 2 seeds`);
  assert.match(result(summary).about(result(summary).cases[0]), /^Metres .* Dotted: as many steps in one go/);
});

const IN_WORLD = {
  ...PLACE, key: "w", role: "learner", agent: "learner", steps: 100, plans_with: null, n: 3, greedy_m: 0.5,
  greedy_nominal_m: 0.1, best_known_m: 0.6, distance: interval(0.4), of_greedy: interval(0.8),
  of_best_known: interval(0.7), curve: CURVE, mean_m: interval(0.3), earned: null,
  until_greedy: { of: 0.9, median_steps: 200, reached: 0.5 }, until_best_known: null,
};
const SEARCH = {
  ...IN_WORLD, key: "s", role: "reference", agent: "greedy", plans_with: "nominal", distance: interval(0.5),
  curve: null, mean_m: null, until_greedy: null,
};

test("agents in a world have curves, references and one table, the farthest first under the best known walk", () => {
  const summary = summaryOf({ experiment: "league", worlds: [IN_WORLD, SEARCH] });
  const { charts: [chart], tables } = firstContent(summary);
  assert.deepEqual([chart.lines.length, chart.note], [1, "3 seeds"]);
  assert.deepEqual(chart.marks.map(({ kind }) => kind), ["greedy", "nominal", "best-known"]);
  assert.equal(tables.length, 1);
  assert.deepEqual(titlesOf(tables[0]),
    ["Distance", "Of greedy", "Of best known", "Mean", "Steps to 90 % of greedy", "Seeds"]);
  assert.deepEqual(textsOf(tables[0]), [
    ["Best known", `0.60${M}`, "120 %", "–", "–", "–", "–"],
    ["Greedy, nominal model", `0.50${M}`, "80 %", "70 %", "–", "–", "3"],
    ["Learner", `0.40${M}`, "80 %", "70 %", `0.30${M}`, "200", "3"],
  ]);
});

test("a recovery has every evaluation, and what each window of the practice earned", () => {
  const steps = [0, 1, 50, 100];
  const curve = { steps, iqm_m: [0.1, 0.2, 0.3, 0.4], low_m: steps.map(() => null), high_m: steps.map(() => null) };
  const summary = summaryOf({ experiment: "recovery", worlds: [{ ...IN_WORLD, curve, earned: curve }, SEARCH] });
  const [distance, practice] = firstContent(summary).tables;
  assert.deepEqual(titlesOf(distance),
    ["Right after", "After 1", "After 50", "After 100", "Of greedy", "Of best known", "Seeds"]);
  assert.deepEqual(titlesOf(practice),
    ["Mean", "Earned in 1 – 50", "Earned in 51 – 100", "Earned in 101 – 150", "Steps to 90 % of greedy"]);
  assert.deepEqual(textsOf(practice).map(([name, , ...earned]) => [name, ...earned.slice(0, 3)]),
    [["Learner", `0.10${M}`, `0.30${M}`, `0.40${M}`]]);
});

test("worlds are beside one another, the farthest bold, by greedy where no best walk is known", () => {
  const flat = [IN_WORLD, { ...SEARCH, of_best_known: interval(0.6) }];
  const ice = flat.map((entry) =>
    ({ ...entry, world: "ice", best_known_m: null, of_best_known: null, of_greedy: interval(0.5) }));
  const summary = summaryOf({ experiment: "league", worlds: [...flat, ...ice] });
  assert.equal(result(summary).cases.length, 2);
  const table = /** @type {Table} */ (overviewOf(summary, result(summary).cases[0].place));
  assert.deepEqual(titlesOf(table).map((title) => title.includes("of greedy")), [false, true]);
  assert.deepEqual(textsOf(table).map(([, ...texts]) => texts), [["70 %", "50 %"], ["60 %", "50 %"]]);
  const bold = table.groups[0].rows.map(({ cells }) => cells.map(({ isBold }) => isBold));
  assert.deepEqual(bold, [[true, true], [false, true]]);
  assert.equal(overviewOf(summaryOf({ experiment: "league", worlds: [IN_WORLD] }), null), null);
});

test("an experiment without trials has no result, nor has one of an unknown kind", () => {
  for (const experiment of ["figure4", "league", "recovery"]) assert.equal(resultOf(summaryOf({ experiment })), null);
  assert.equal(resultOf(summaryOf({ experiment: "other" })), null);
});
