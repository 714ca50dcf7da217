// A tournament's page without a server: ranks, what can be told apart, the axis, entries that are left, the request.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { shortTime } from "../../../static/js/format.js";
import { options } from "../../../static/js/store.js";
import {
  agentGroups, changedSettings, fits, readSteps, requestOf, settingsOfEntry,
} from "../../../static/features/tournaments/draft.js";
import * as list from "../../../static/features/tournaments/list.js";
import {
  axisOf, choicesInWords, entriesInWords, entriesLeft, entryInWords, failuresInWords, intervalInWords, nameOf,
  notSeparable, progressInWords, rankInWords, rulesInWords, shortened, spokenRank, walkInWords,
} from "../../../static/features/tournaments/words.js";
import { OPTIONS } from "../../page/options.js";

/** @import { Draft } from "../../../static/features/tournaments/draft.js" */
/** @import { EnteredAgent, TournamentEntry, TournamentRules, RankedEntry } from "../../../static/js/types.js" */

beforeEach(() => (options.value = OPTIONS));

const RULES = /** @type {TournamentRules} */ (/** @type {unknown} */ ({
  gait: "tripod", robot: { preset: "stiff" }, simulator: "mujoco", divisions: 3, grid_side_m: 0.08,
  tolerance: 0, steps: 500, draws: 20, worlds: ["flat", "limp-pair"], robots: [], gaits: [], tables: false,
  transitions: 40_000,
}));

/** @type {(changes?: object) => RankedEntry} */
const standing = (changes = {}) => ({
  number: 3, iqm_m: 0.5, low_m: 0.45, high_m: 0.55, best_rank: 1, worst_rank: 3, not_separable: [], failures: 0,
  ...changes,
});

/** @type {(changes?: object) => TournamentEntry} */
const entry = (changes = {}) => ({
  number: 7, name: "Keen Ant", is_reference: false, is_own: false, training_id: null, state: "judging", judged: 7,
  of: 20, judgements: null, entered_at: "2026-11-25T10:00:00Z",
  entry: { agent: "learner", observation: "measured", settings: {}, steps: null, robot: null, table: null },
  ...changes,
});

/** @type {(changes?: Partial<Draft>) => Draft} */
const draft = (changes = {}) => ({
  agent: "", texts: {}, steps: "", robot: "", training: "", name: "", ...changes,
});

// ---- ranks

test("a rank is a range where entries cannot be told apart", () => {
  assert.equal(rankInWords(standing()), "1–3");
  assert.equal(rankInWords(standing({ worst_rank: 1 })), "1");
  assert.equal(spokenRank(standing()), "Rank 1 to 3", "a dash is not read out");
});

test("those that cannot be told apart are named, and many of them counted", () => {
  const names = ["Greedy", "Keen Ant", "Shy Hare", "Bold Moth", "Calm Lynx", "An entry whose name has no end at all"];
  const words = (/** @type {number[]} */ numbers) => notSeparable({ not_separable: numbers }, (n) => names[n]);
  assert.equal(words([]), "");
  assert.equal(words([0, 1]), "Greedy and Keen Ant");
  assert.equal(words([0, 1, 2, 3]), "Greedy, Keen Ant, Shy Hare and Bold Moth", "no “1 others”");
  assert.equal(words([0, 1, 2, 3, 4]), "Greedy, Keen Ant, Shy Hare and 2 others");
  assert.equal(words([5]), "An entry whose name has…");
});

test("distances have an interval, and failures are counted", () => {
  assert.equal(intervalInWords(standing({ low_m: -0.02 })), "−0.02 to 0.55");
  assert.equal(failuresInWords(standing({ failures: 2 }), 20), "failed on 2 of 20");
  assert.equal(failuresInWords(standing(), 20), "");
});

test("all entries share an axis with zero on it and some room at its end", () => {
  const { low, high } = axisOf([standing(), standing({ low_m: -0.1, high_m: 0.2 })]);
  assert.equal(low, -0.1);
  assert.ok(high > 0.55 && high < 0.6);
  assert.deepEqual(axisOf([standing({ low_m: 0.3 })]).low, 0);
  assert.ok(axisOf([]).high > 0, "an empty ranking has an axis, too");
});

test("of many standings the best are shown, and those that are kept in any case", () => {
  const all = Array.from({ length: 30 }, (_, number) => standing({ number }));
  const numbers = (/** @type {RankedEntry[]} */ some) => some.map(({ number }) => number);
  assert.deepEqual(numbers(shortened(all, (n) => n >= 28, 5)), [0, 1, 2, 28, 29]);
  assert.deepEqual(numbers(shortened(all, (n) => n >= 20, 5)), numbers(all.slice(20)), "all that are kept");
  assert.equal(shortened(all, () => false, 30).length, 30);
});

// ---- the tournament and its entries in words

test("the rules are two sentences", () => {
  assert.equal(rulesInWords(RULES),
    "Each entry practises at most 500 steps, then walks 50, on 20 secret seeds in flat ground, two limp legs. " +
    "A search simulates at most 40\u202f000 transitions on each.");
  assert.match(walkInWords(RULES), / · foot grid 3 × 3 on 80\u00a0mm$/);
  assert.match(walkInWords({ ...RULES, tolerance: 0.1 }), / · build tolerance 0.1$/);
  assert.match(walkInWords({ ...RULES, reward: "track" }), / · reward along the track$/);
});

test("what else may enter is told where anything else may", () => {
  assert.equal(choicesInWords(RULES), "");
  assert.match(choicesInWords({ ...RULES, robots: ["ant"], tables: true }), /^Creatures .+ and .+\. Tables /);
});

test("an entry is told by what differs from the agent's defaults", () => {
  const title = (/** @type {Partial<EnteredAgent>} */ changes) =>
    entryInWords({ .../** @type {EnteredAgent} */ (entry().entry), ...changes }, RULES);
  assert.equal(title({ settings: { alpha: 0.3, gamma: 0.9 } }), "Learner");
  assert.equal(title({ settings: { alpha: 0.5 }, steps: 300 }), "Learner, α\u00a00.5, 300 steps");
  assert.equal(title({ steps: 500 }), "Learner", "the whole budget is nothing special");
  assert.equal(title({ table: "ab" }), "Learner, a trained table");
});

test("an entry whose name is hidden has its number, a reference the agent's title", () => {
  assert.equal(nameOf(entry()), "Keen Ant");
  assert.equal(nameOf(entry({ name: null })), "Entry 7");
  assert.equal(nameOf(entry({ is_reference: true, name: "greedy", entry: { ...entry().entry, agent: "greedy" } })),
    "Greedy");
});

test("progress is told by draws", () => {
  assert.equal(progressInWords(entry()), "7 of 20 draws");
  assert.equal(progressInWords(entry({ state: "waiting", judged: 0 })), "waits to be judged");
});

test("entries that are left are told with the next one", () => {
  const now = Date.parse("2026-11-25T14:00:00Z");
  const next_at = "2026-11-25T14:20:00Z";
  assert.equal(entriesLeft({ left: 4, next_at: null }, 6, now), "4 of 6 entries left this hour.");
  assert.equal(entriesLeft({ left: 0, next_at }, 6, now),
    `None of 6 entries left this hour; the next at ${shortTime(next_at, now)}.`);
  assert.equal(entriesLeft({ left: 1, next_at: null }, 1, now), "1 of 1 entry left this hour.");
  assert.equal(entriesLeft({ left: null, next_at: null }, 6, now), "", "operators have no limit");
  assert.deepEqual([1, 12].map(entriesInWords), ["1 entry", "12 entries"]);
});

// ---- the form of an entry

test("agents are grouped by what they do, and none is left out", () => {
  const names = agentGroups().flatMap(([, agents]) => agents.map(({ name }) => name));
  assert.deepEqual([...names].sort(), OPTIONS.agents.map(({ name }) => name).sort());
  assert.equal(agentGroups()[0][0], "Learners");
});

test("the request has what was typed, and the steps of a learner", () => {
  assert.deepEqual(requestOf(draft(), RULES, []),
    { body: { agent: "learner", settings: {}, steps: 500 }, mistakes: {} });
  const typed = draft({ texts: { "learner alpha": "0,5", "tracer alpha": "9" }, steps: "300", name: " A " });
  assert.deepEqual(requestOf(typed, RULES, []).body,
    { agent: "learner", settings: { alpha: 0.5 }, steps: 300, name: "A" });
  assert.deepEqual(changedSettings(typed), ["α\u00a00,5"]);
  assert.deepEqual(requestOf(draft({ agent: "greedy" }), RULES, []).body, { agent: "greedy", settings: {} });
});

test("what is not valid holds the request, and is told by its field", () => {
  const { body, mistakes } = requestOf(draft({ texts: { "learner alpha": "2" }, steps: "501" }), RULES, []);
  assert.equal(body, null);
  assert.match(mistakes.alpha, /at most 1/);
  assert.match(mistakes.steps, /from 1 to 500/);
  assert.match(String(readSteps(draft({ steps: "many" }), RULES).mistake), /whole number/);
});

test("a creature of the rules is sent whole", () => {
  const rules = { ...RULES, robots: [{ preset: "ant" }, { preset: "crab" }] };
  assert.deepEqual(requestOf(draft({ robot: "1" }), rules, []).body?.robot, { preset: "crab" });
});

test("settings begin with those that matter most", () => {
  assert.equal(settingsOfEntry(draft())[0][0], "alpha");
});

test("a table enters with nothing that its training says", () => {
  const config = { agent: "tracer", robot: { preset: "stiff" }, gait: RULES.gait, divisions: 3, grid_side_m: 0.08 };
  const run = /** @type {any} */ (
    { id: "t1", kind: "training", state: "finished", config, progress: { done: 400, total: 400 } });
  assert.ok(fits(run, RULES));
  assert.deepEqual(requestOf(draft({ training: "t1", texts: { "learner alpha": "2" } }), RULES, [run]),
    { body: { agent: "tracer", training_id: "t1" }, mistakes: {} });
  assert.ok(!fits({ ...run, progress: { ...run.progress, done: 501 } }, RULES), "beyond the budget");
  assert.ok(!fits({ ...run, state: "stopped" }, RULES));
  assert.ok(!fits({ ...run, config: { ...run.config, divisions: 2 } }, RULES), "on another grid");
  assert.ok(fits({ ...run, config: { ...run.config, robot: { preset: "compliant" } } }, RULES), "of another robot");
  const ant = { ...run, config: { ...run.config, robot: { preset: "ant" }, gait: "tetrapod" } };
  assert.ok(!fits(ant, RULES), "in another gait");
  const rules = { ...RULES, robots: [{ preset: "ant" }], gaits: /** @type {any} */ (["tetrapod"]) };
  assert.ok(fits(ant, rules));
  assert.deepEqual(requestOf(draft({ training: "t1" }), rules, [ant]).body,
    { agent: "tracer", training_id: "t1", robot: { preset: "ant" } });
});

// ---- the form of a tournament

test("a tournament is asked for with numbers, worlds and the page's walk", () => {
  list.showForm();
  const of = { ...list.draft.value, title: " Cup ", worlds: ["flat"], room: "KM4T7Q" };
  assert.deepEqual(list.requestOf(of, { gait: "tripod" }), {
    title: "Cup", room: "KM4T7Q", entries_per_hour: 6,
    rules: { gait: "tripod", steps: 500, draws: 20, transitions: 40000, worlds: ["flat"], robots: [], tables: false },
  });
  for (const draws of ["some", "4", "101", "5.5"]) {
    assert.equal(list.requestOf({ ...of, numbers: { ...of.numbers, draws } }, {}), null);
  }
  assert.equal(list.requestOf({ ...of, worlds: [] }, {}), null);
  assert.deepEqual(list.toggled(["ice"], "flat", ["flat", "ice"]), ["flat", "ice"], "in the order of all");
  assert.deepEqual(list.toggled(["ice"], "ice", ["flat", "ice"]), []);
});

test("a refusal names the fields of the form", () => {
  assert.equal(list.inFormWords("rules.draws must be a whole number from 5 to 100."),
    "Secret seeds must be a whole number from 5 to 100.");
  assert.equal(list.inFormWords("Draws must be at least 5 here."), "Secret seeds must be at least 5 here.");
  assert.equal(list.inFormWords("Unknown world 'x'; it must be one of: flat."),
    "Unknown world 'x'; it must be one of: flat.");
});

test("all walk as the card of the room opens the page", () => {
  list.askForTournament("KM4T7Q", { gait: "wave", divisions: "5", settings: { alpha: 0.5 } });
  assert.equal(list.walk.value.gait, "wave");
  assert.equal(list.walk.value.divisions, 5);
  assert.equal(list.draft.value.room, "KM4T7Q");
});
