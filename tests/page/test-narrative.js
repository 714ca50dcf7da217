// What the page says of moments of real runs, against what the API tells of them: each sentence is read, and each of
// its claims computed anew from the timeline, the result and the state of the run. A sentence that none of these rules
// can read fails, too. The moments are those of moments.py.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { gunzipSync } from "node:zlib";
import { metres } from "../../static/js/format.js";
import { narrativeOf } from "../../static/js/narrative/narrative.js";
import { isShownToEnd } from "../../static/js/narrative/moment.js";
import { OPTIONS } from "./options.js";

/** @type {any[]} */
const ENTRIES = JSON.parse(gunzipSync(readFileSync(new URL("moments.json.gz", import.meta.url))).toString());
const TITLES = { "greedy": "Greedy", "q-learning": "Q-learning", "two-step": "Two-step", "random-walk": "Random walk" };
const AGENTS = Object.entries(TITLES).map(([name, title]) => ({ ...OPTIONS.agents[0], name, title }));
/** A moment in thousandths of a second, as pages are told, and in steps. */
const SAME_S = 0.001;
/** Distances of a scene have four decimals. */
const ROUNDED_M = 0.00011;
const EARLY = ["stopped", "interrupted", "failed"];

// ---- facts, from the API's answers alone

/** The ends of a lane's steps: [time s, distance m]. @param {any} lane of a timeline */
function endsOf({ points, thinking, futures }) {
  const ends = [];
  let [at, thought] = [0, 0];
  for (let step = 0; step < futures.length; step += 1) {
    const [from = NaN] = thinking[thought] ?? [];
    // A point for the end of thinking comes first, where the step began with it.
    if (from === points[at][0]) [at, thought] = [at + 1, thought + 1];
    at += 1;
    ends.push(points[at]);
  }
  assert.equal(at, points.length - 1);
  return ends;
}

/** @param {any} lane @param {number} time */
function distanceAt({ points }, time) {
  const next = points.findIndex((/** @type {number[]} */ [t]) => t >= time);
  if (next < 1) return points.at(next)[1];
  const [[t0, d0], [t1, d1]] = [points[next - 1], points[next]];
  return d0 + (d1 - d0) * (time - t0) / (t1 - t0);
}

/** Facts of a race at a moment. @param {any} entry @param {any} moment */
function factsOf({ run, timeline }, { scene, stage }) {
  const { time_s: time } = scene;
  const timeOut = timeline.first_finish_s;
  const isTimedOut = timeOut !== null && time >= timeOut - SAME_S;
  const until = isTimedOut ? timeOut : time;
  const lanes = timeline.lanes.map((/** @type {any} */ lane, /** @type {number} */ number) => {
    const ends = endsOf(lane);
    const madeBy = (/** @type {number} */ at) => ends.filter(([end]) => end <= at + SAME_S).length;
    const clock = run.result?.lanes[number]?.clocks[scene.clock];
    const isOver = time >= lane.total_s - SAME_S;
    // While others are computed, it is known of the picture at the photo finish, and later by the line of the chart.
    const atTimeOut = clock?.finished_distance_m ??
      (time <= timeOut + SAME_S ? scene.lanes[number].distance_m : distanceAt(lane, timeOut));
    return {
      number, title: scene.lanes[number].name, ends, made: madeBy(time), madeUntil: madeBy(until),
      // In the middle of a step it is that of the picture.
      distance: isTimedOut ? atTimeOut : scene.lanes[number].distance_m,
      rank: clock?.rank ?? null, futures: lane.futures,
      thought: lane.thinking.reduce((/** @type {number} */ sum, /** @type {number[]} */ [from, to]) =>
        sum + Math.max(0, Math.min(to, until) - from), 0),
      isHalted: EARLY.includes(run.state) && isOver && lane.steps < run.config.steps && !lane.failure,
      result: run.result?.lanes[number] ?? null,
    };
  });
  return { run, scene, stage, lanes, isTimedOut, until, steps: run.config.steps, isEarly: EARLY.includes(run.state) };
}

/** The lane, or the lanes, of a list of names: of several alike, all. @param {any} facts @param {string} names */
const named = ({ lanes }, names) => {
  const all = names.split(/, | and /);
  const matching = lanes.filter((/** @type {any} */ { title }) => all.includes(title));
  assert.ok(all.every((other) => matching.some((/** @type {any} */ { title }) => title === other)), names);
  return matching;
};

/** Two figures are the same, as far as words tell. @type {(told: number, figure: number, by: number) => void} */
const assertNear = (said, figure, by) => assert.ok(Math.abs(said - figure) <= by, `${said} is not ${figure}`);
/** A number as it is told. @param {string} text */
const numberIn = (text) => Number(text.replace("−", "-").replaceAll("\u202f", ""));
/** @param {string} text as of 3 cm, 4 mm, under 1 mm */
const apartIn = (text) => (text.startsWith("under") ? [0.0005, 0.0006]
  : [numberIn(text.slice(0, -3)) / (text.endsWith("cm") ? 100 : 1000), text.endsWith("cm") ? 0.0051 : 0.0006]);

/** @param {any[]} lanes the farthest first */
const inOrder = (lanes) => lanes.toSorted((a, b) => b.distance - a.distance);

/** What a sentence claims, and how that is. @typedef {[RegExp, (facts: any, told: string[]) => void][]} Claims */

/** @type {Claims} */
const HEADLINES = [
  [/^On the start line$/, ({ lanes, scene }) => {
    assert.ok(scene.time_s <= SAME_S || lanes.every((/** @type {any} */ { made }) => made === 0));
  }],
  [/^Nobody has gained ground$/, ({ lanes }) =>
    assert.ok(lanes.every((/** @type {any} */ { distance }) => distance <= ROUNDED_M))],
  [/^(.+) are level$/, (facts, [names]) => {
    const [first] = inOrder(facts.lanes);
    for (const lane of facts.lanes) {
      const isNamed = named(facts, names).includes(lane);
      assert.ok(isNamed ? first.distance - lane.distance <= 0.01 + ROUNDED_M
        : first.distance - lane.distance >= 0.01 - ROUNDED_M, lane.title);
    }
  }],
  [/^(.+) leads by (.+)$/, (facts, [name, apart]) => {
    const [first, second] = inOrder(facts.lanes);
    assert.ok(!facts.isTimedOut && !facts.lanes.some((/** @type {any} */ { isHalted }) => isHalted));
    assert.equal(first.title, name);
    assertNear(apartIn(apart)[0], first.distance - second.distance, apartIn(apart)[1] + ROUNDED_M);
  }],
  [/^(.+) leads with (.+)$/, (facts, [name, far]) => {
    assert.equal(facts.lanes.length, 1);
    assert.deepEqual([facts.lanes[0].title, far], [name, metres(facts.scene.lanes[0].distance_m)]);
  }],
  [/^(.+) tie$/, (facts, [names]) => {
    const first = facts.lanes.filter((/** @type {any} */ { rank }) => rank === 1);
    assert.ok(facts.isTimedOut && first.length > 1);
    assert.deepEqual(named(facts, names), first);
  }],
  [/^(.+) wins by (.+)$/, (facts, [name, apart]) => {
    const [first, second] = inOrder(facts.lanes);
    assert.ok(facts.isTimedOut);
    assert.deepEqual([first.title, first.rank ?? 1], [name, 1]);
    assertNear(apartIn(apart)[0], first.distance - second.distance, apartIn(apart)[1]);
  }],
  [/^(.+) wins with (.+)$/, (facts, [name, far]) => {
    assert.ok(facts.isTimedOut);
    assert.deepEqual([facts.lanes.length, facts.lanes[0].title], [1, name]);
    assert.equal(far, metres(facts.lanes[0].distance));
  }],
  [/^(Stopped|Interrupted|Failed) at steps? (\d+)(?: to (\d+))? of (\d+)(?:: (.+) had come farthest, (.+))?$/,
    (facts, [word, low, high, total, names, far]) => {
      assert.equal(word.toLowerCase(), facts.run.state);
      assert.ok(!facts.isTimedOut);
      const halted = facts.lanes.filter((/** @type {any} */ { isHalted }) => isHalted);
      const reached = (halted.length ? halted : facts.lanes).map((/** @type {any} */ { made }) => made);
      assert.ok(facts.stage.ended || halted.length > 0);
      assert.deepEqual([low, high ?? low, total].map(Number),
        [Math.min(...reached), Math.max(...reached), facts.steps]);
      assert.equal(Boolean(names), facts.stage.ended, "who came farthest is told once all are there");
      if (!names) return;
      const [first] = inOrder(facts.lanes);
      assert.ok(named(facts, names).every((/** @type {any} */ lane) => first.distance - lane.distance <= ROUNDED_M));
      assert.equal(far, metres(first.distance));
    }],
];

const mean = (/** @type {any} */ { ends, madeUntil }) => ends[madeUntil - 1][1] / madeUntil;
const endAt = (/** @type {any} */ { ends }, /** @type {number} */ step) => (step ? ends[step - 1][1] : 0);

/** Of a reason, whose sentences come one after the other. @type {Claims} */
const REASONS = [
  [/^(.+) has fallen at step (\d+)\. ?/, (facts, [name, step]) => {
    const fallen = named(facts, name)[0];
    assert.equal(fallen.result.fell_at_step + 1, Number(step));
    assert.ok(Number(step) <= fallen.madeUntil, "a fall that is to come");
  }],
  [/^(.+) marches on the spot: (\S+)\scm in its last ten steps\. ?/, (facts, [name, gained]) => {
    const lane = named(facts, name)[0];
    const gain = endAt(lane, lane.madeUntil) - endAt(lane, lane.madeUntil - 10);
    assert.ok(gain < 0.01);
    assertNear(numberIn(gained), 100 * gain, 0.051);
  }],
  [/^Legs?.+ limp from step (\d+): (.+) went (\S+)\smm a step before, (\S+)\smm after\. ?/,
    (facts, [step, name, before, after]) => {
      const [lane, at] = [named(facts, name)[0], Number(step) - 1];
      assert.equal(facts.run.config.disturbances[0].at_step, at);
      assertNear(numberIn(before), 1000 * endAt(lane, at) / at, 0.051);
      const then = (endAt(lane, lane.madeUntil) - endAt(lane, at)) / (lane.madeUntil - at);
      assertNear(numberIn(after), 1000 * then, 0.051);
    }],
  [/^Its steps are longer: (\S+)\smm against (\S+)\smm of ([^.]+)\. ?/, (facts, [longer, shorter, name]) => {
    const [first, second] = [inOrder(facts.lanes)[0], named(facts, name)[0]];
    assertNear(numberIn(longer), 1000 * mean(first), 0.051);
    assertNear(numberIn(shorter), 1000 * mean(second), 0.051);
    assert.ok(mean(first) > mean(second));
  }],
  [/^It simulates (about )?(\S+) moves before each\. ?/, (facts, [about, moves]) => {
    const { futures, madeUntil } = inOrder(facts.lanes)[0];
    const each = futures.slice(0, madeUntil);
    assertNear(numberIn(moves), each.reduce((/** @type {number} */ sum, /** @type {number} */ n) => sum + n, 0)
      / madeUntil, 0.51);
    assert.equal(Boolean(about), new Set(each).size > 1);
  }],
  [/^It thinks less: (\d+) steps made against (\d+) of ([^.]+)\. ?/, (facts, [more, fewer, name]) => {
    const [first, second] = [inOrder(facts.lanes)[0], named(facts, name)[0]];
    assert.deepEqual([Number(more), Number(fewer)], [first.madeUntil, second.madeUntil]);
    assert.ok(Number(more) > Number(fewer) && first.thought < second.thought);
  }],
  [/^Both walk alike; (.+) began (.+) better\. ?/, (facts, [name, apart]) => {
    const [first, second] = inOrder(facts.lanes);
    assert.equal(first.title, name);
    assertNear(apartIn(apart)[0], endAt(first, 10) - endAt(second, 10), apartIn(apart)[1]);
    assert.ok(mean(second) <= 1.1 * mean(first) && mean(first) <= 1.1 * mean(second));
  }],
  [/^It thought (\d+) % of the time: (\d+) of (\d+) steps\. ?/, (facts, [share, made, steps]) => {
    const [first] = inOrder(facts.lanes);
    assert.ok(facts.isTimedOut);
    assert.deepEqual([Number(made), Number(steps)], [first.madeUntil, facts.steps]);
    assertNear(Number(share), 100 * first.thought / Math.min(facts.until, first.ends.at(-1)[0]), 0.51);
  }],
];

/** Read a text sentence by sentence. @param {Claims} rules @param {any} facts @param {string} text */
function check(rules, facts, text) {
  let rest = text;
  while (rest) {
    const rule = rules.find(([pattern]) => pattern.test(rest));
    assert.ok(rule, `nothing tells whether this is so: ${rest}`);
    const [all, ...parts] = /** @type {RegExpExecArray} */ (rule[0].exec(rest));
    rule[1](facts, parts);
    rest = rest.slice(all.length);
  }
}

/** @param {any} facts @param {string} rule */
function checkRule({ run, lanes, isTimedOut, stage, steps }, rule) {
  const isLeft = EARLY.includes(run.state) && !isTimedOut &&
    (stage.ended || lanes.some((/** @type {any} */ { isHalted }) => isHalted));
  const start = isLeft ? "No ranking: the race " : isTimedOut ? "Ranked at time-out" : "The farthest at time-out wins";
  assert.ok(rule.startsWith(start), rule);
  const [, names = null] = /when (.+) had used/.exec(rule) ?? [];
  const first = Math.min(...lanes.map((/** @type {any} */ { ends }) => ends[steps - 1]?.[0] ?? Infinity));
  const users = lanes.filter((/** @type {any} */ { ends }) => (ends[steps - 1]?.[0] ?? Infinity) - first <= SAME_S);
  if (names) assert.deepEqual(named({ lanes }, names), users);
}

/** What is said at a moment. @param {any} entry @param {any} moment @param {object} [changes] */
const saidAt = (entry, { scene, stage }, changes = {}) => narrativeOf({
  run: entry.run, race: entry.run.kind === "race" ? entry.run : null, scene, stage, timeline: entry.timeline,
  clock: scene.clock, clockTitle: "paper clock", agents: AGENTS, tests: entry.tests, conditions: [],
  happened: (entry.run.config.disturbances ?? []).map((/** @type {any} */ { kind, at_step }) =>
    ({ at_step, until_step: null, words: `${kind === "limp" ? "Legs 1, 4 limp" : "Lost"} from step ${at_step + 1}` })),
  recordedStep: entry.run.kind === "training" ? Math.round(scene.computed_s / 0.32) : null,
  goesOnWith: entry.run.can_resume ? entry.run : null, ghosts: null, problem: null, isAway: false, isOwn: false,
  isOfGuest: false, isBuffering: false, canPlay: true, canResume: true, ...changes,
});

const MOMENTS = ENTRIES.flatMap((entry) => entry.moments.map((/** @type {any} */ moment) => ({ entry, moment })));
const OF_RACES = MOMENTS.filter(({ entry }) => entry.run.kind === "race");

test("there are 200 moments of 12 races and more, of each state and way to end", () => {
  const races = ENTRIES.filter(({ run }) => run.kind === "race");
  assert.ok(OF_RACES.length >= 200, `${OF_RACES.length}`);
  assert.ok(new Set(races.map(({ run }) => run.id)).size >= 12);
  assert.deepEqual(new Set(MOMENTS.map(({ entry, moment }) => saidAt(entry, moment).state)),
    new Set(["racing", "timed out", "halting", "left off", "practising", "practised", "broken off"]));
});

test("of no moment of a race is anything said that the API denies", () => {
  const denied = OF_RACES.flatMap(({ entry, moment }) => {
    const facts = factsOf(entry, moment);
    const { headline, reason, rule, rows } = saidAt(entry, moment);
    try {
      assert.deepEqual(moment.scene.lanes.map((/** @type {any} */ { steps_made }) => steps_made),
        facts.lanes.map((/** @type {any} */ { made }) => made), "steps that have ended");
      check(HEADLINES, facts, headline);
      check(REASONS, facts, reason ?? "");
      checkRule(facts, rule ?? "");
      if (/ are level$/.test(headline)) assert.equal(reason, null);
      for (const row of rows ?? []) {
        const { rank, result } = facts.lanes[row.lane];
        if (facts.isTimedOut && result) assert.equal(row.rank, rank);
        if (row.fell_at_step !== null) assert.ok(row.fell_at_step < row.made);
      }
      return [];
    } catch (error) {
      return [`${entry.run.name} at ${moment.scene.time_s} s: ${headline} | ${reason} | ${rule}: ${error}`];
    }
  });
  assert.deepEqual(denied, []);
});

test("a practice says how far it is by tests that the picture has passed, and how it ended", () => {
  for (const { entry, moment } of MOMENTS.filter(({ entry: { run } }) => run.kind === "training")) {
    const { headline, reason, note } = saidAt(entry, moment);
    const { run, tests } = entry;
    const made = Math.floor((moment.scene.time_s + SAME_S) / 0.32);
    const newest = tests.findLast((/** @type {any} */ { step }) => step <= made);
    const isEnd = moment.stage.ended;
    const { done, total } = run.progress;
    const word = { stopped: "Stopped", interrupted: "Interrupted" }[/** @type {string} */ (run.state)];
    if (isEnd && word) assert.equal(headline, `${word} at step ${done} of ${total}`);
    else if (isEnd) assert.equal(headline, `Q-learning walked ${metres(tests.at(-1).distance_m)} in its last test`);
    else if (newest) assert.equal(headline, `Q-learning walks ${metres(newest.distance_m)} so far`);
    else assert.equal(headline, "Q-learning practises");
    const tested = `Tested there, Q-learning walked ${metres(run.result?.distance_m)} in 50 steps.`;
    if (isEnd && run.state === "stopped") assert.equal(reason, tested);
    assert.equal(note !== null, isEnd && Boolean(word));
    if (note && run.state === "interrupted") assert.match(note.words, /after step 43 is lost/);
  }
});

test("what can be done, chips and announcements follow from the run's state and the picture's", () => {
  for (const { entry, moment } of MOMENTS) {
    const { note, chips, play, announcement, state } = saidAt(entry, moment);
    const { run } = entry;
    const { stage, scene } = moment;
    const isEarlyEnd = EARLY.includes(run.state) && stage.ended;
    assert.equal(note?.action?.run ?? null, isEarlyEnd && run.can_resume ? run : null);
    if (note?.action) assert.deepEqual([note.action.label, note.action.does], ["Go on", "resume"]);
    const words = chips.map((chip) => chip.words);
    assert.equal(words[0], scene.label);
    assert.equal(words.some((text) => text.endsWith(" paused")), !stage.ended);
    if (words.includes("Time-out: photo finish")) assert.equal(state, "timed out");
    assert.equal(play.label, stage.ended ? "Play the stage again" : "Play the stage");
    const isOutcome = state === "timed out" || (isEarlyEnd && ["left off", "broken off"].includes(state));
    assert.equal(announcement !== "", isOutcome || run.state === "failed", `${run.name}: ${announcement}`);
  }
});

test("without the server what may have gone on is not claimed, and nothing can be resumed", () => {
  for (const { entry, moment } of MOMENTS) {
    const { reason, note, state } = saidAt(entry, moment, { isAway: true });
    assert.equal(note, null);
    assert.equal(reason === "This is the last that is known.", ["racing", "halting", "practising"].includes(state));
  }
});

test("a run that never began, that waits, or that is not there says so", () => {
  const [{ run, moments: [moment], timeline }] = ENTRIES;
  const none = { progress: { done: 0, total: 48 } };
  const of = (/** @type {object} */ changes, /** @type {object} */ extra = {}) => {
    const entry = { run: { ...run, ...changes }, timeline, tests: [] };
    const { headline, bar, board, note } = saidAt(entry, moment, extra);
    return [headline, bar, board, note?.what ?? null];
  };
  const never = "Stopped before its first step";
  assert.deepEqual(of({ ...none, state: "stopped" }),
    [never, never, `${never}.`, "The race was stopped before its first step."].map((text, n) =>
      (n === 3 && !moment.stage.ended ? null : text)));
  assert.deepEqual(of({ ...none, state: "queued" }, { scene: null }).slice(0, 3),
    ["On the start line", "It waits for its turn.", "The race is about to begin."]);
  const nobody = { run: null, race: null, scene: null };
  assert.equal(of({}, { ...nobody, stage: { ...moment.stage, run_id: null } })[0], "A hexapod learns to walk");
  assert.equal(of({}, nobody)[0], "Loading…");
  assert.equal(of({}, { ...nobody, isAway: true })[0], "Waiting for the server");
  assert.deepEqual(of({}, { ...nobody, problem: "There is no such run." }).slice(0, 2),
    ["No run is shown", "No run is shown."]);
});

test("a run is shown to its end at its time-out, or with its last step", () => {
  for (const { entry: { run }, moment: { scene } } of MOMENTS) {
    const isThere = run.kind === "race" ? scene.time_out_s !== null && scene.time_s >= scene.time_out_s - SAME_S
      : scene.ended;
    assert.equal(isShownToEnd(scene, run.id), isThere);
  }
});
