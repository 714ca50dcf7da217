// What fills the projector, and where its dots and curves lie.
import assert from "node:assert/strict";
import { test } from "node:test";
import { actOf } from "../../../static/features/classroom/room/acts/index.js";
import { meanCurve } from "../../../static/features/classroom/room/acts/mean-curve.js";
import { racedAmong } from "../../../static/features/classroom/room/acts/run.js";
import { besideEachOther, plotAxis, stackedDots } from "../../../static/features/classroom/room/acts/plot-geometry.js";
import { settingDots } from "../../../static/features/classroom/room/acts/setting-dots.js";
import { predictionsOf, winsOf } from "../../../static/features/classroom/room/acts/predictions.js";
import { laneNames } from "../../../static/features/classroom/room/lane-names.js";
import { results as resultsByCard, room } from "../../../static/features/classroom/room/room.js";
import { scene } from "../../../static/js/store.js";
import { teaching } from "../../../static/features/classroom/room/teaching.js";

/** Facts of a card, as far as an act is chosen by them. @param {any} changes @returns {any} */
const facts = ({ shown = {}, spotlight = null, ...changes } = {}) => ({
  classroom: { shown, spotlight }, results: { entries: [], distances_m: [] }, isRevealed: true, isOnItsWay: false,
  ...changes,
});

test("each kind of question is revealed by an act of its own, and none before the reveal", () => {
  for (const kind of ["choice", "number", "point", "curve"]) {
    assert.equal(actOf(facts({ shown: { ask: { kind } } }))?.name, kind);
    assert.equal(actOf(facts({ shown: { ask: { kind } }, isRevealed: false })), null);
  }
});

test("a card that asks nothing is revealed by its distances, if there are any", () => {
  assert.equal(actOf(facts({ shown: { go: "what-if" } })), null);
  assert.equal(actOf(facts({ results: { entries: [], distances_m: [0.2] } }))?.name, "distances");
});

test("a run that the teacher shows goes before all else", () => {
  const lit = { spotlight: "run1", shown: { ask: { kind: "number" } } };
  assert.equal(actOf(facts(lit))?.name, "run");
  assert.equal(actOf(facts({ ...lit, isRevealed: false }))?.name, "run");
});

test("a robot that the class teaches is shown from the start of it on", () => {
  const teaches = { shown: { teach: { seconds: 60 } }, isRevealed: false };
  assert.equal(actOf(facts(teaches)), null);
  for (const state of ["teaching", "frozen", "ended"]) {
    teaching.value = /** @type {any} */ ({ state });
    assert.equal(actOf(facts(teaches))?.name, "teach");
    assert.equal(actOf(facts({ isRevealed: false })), null);
  }
  teaching.value = /** @type {any} */ ({ state: "ready" });
  assert.equal(actOf(facts(teaches)), null);
  teaching.value = null;
});

test("an axis holds all values, from zero or below; over orders of magnitude it has powers of ten", () => {
  const near = plotAxis([0.2, 0.5]);
  assert.equal(near.low, 0);
  assert.ok(near.high > 0.5);
  assert.ok(plotAxis([-0.1, 0.4]).at(-0.1) > 0, "the least value is not on the edge");
  const wide = plotAxis([3, 729, 90_000]);
  assert.deepEqual(wide.marks, [1, 10, 100, 1000, 10_000, 100_000]);
  assert.ok(Math.abs(wide.at(1000) - 0.6) < 1e-9);
  assert.ok(plotAxis([0.3, 0.3]).at(0.3) <= 1, "equal values have an axis, too");
});

test("dots stand on each other, and become smaller until all fit into their place", () => {
  const { radius, dots } = stackedDots([0.5, 0.5, 0], 400, 300, 12);
  assert.equal(radius, 12);
  assert.ok(dots[1].y > dots[0].y && dots[1].x === dots[0].x, "the second lies on the first");
  const many = stackedDots(Array.from({ length: 40 }, () => 0.5), 400, 100, 12);
  assert.ok(many.radius < 12);
  for (const { x, y } of many.dots) {
    assert.ok(x >= many.radius && x <= 400 - many.radius && y + many.radius <= 100, `${x} ${y}`);
  }
});

test("dots at one place are beside each other, and others stay where they are", () => {
  const alike = Array.from({ length: 5 }, () => ({ x: 50, y: 20 }));
  const placed = besideEachOther([...alike, { x: 50, y: 80 }], 4, 100);
  assert.deepEqual(placed[0], { x: 50, y: 20 });
  assert.deepEqual(placed[5], { x: 50, y: 80 });
  const xs = placed.slice(0, 5).map(({ x }) => x).sort((a, b) => a - b);
  assert.ok(xs.every((x, n) => n === 0 || x - xs[n - 1] >= 8));
  assert.ok(besideEachOther(Array.from({ length: 9 }, () => ({ x: 2, y: 0 })), 4, 100).slice(1)
    .every(({ x }) => x >= 4 && x <= 96));
});

test("the typical curve is the interquartile mean at the steps that all have", () => {
  const curves = [0, 0.2, 0.4, 9].map((y) => [[50, y], [100, y + 1]]);
  const [first, second] = meanCurve(curves);
  assert.equal(first[0], 50);
  assert.ok(Math.abs(first[1] - 0.3) < 1e-9 && Math.abs(second[1] - 1.3) < 1e-9, "the least and the greatest left out");
  assert.deepEqual(meanCurve([[[50, 1]], [[100, 1]]]), []);
  assert.deepEqual(meanCurve([]), []);
});

test("distances are told by each setting of which the class has tried several values", () => {
  const entry = (/** @type {any} */ given, /** @type {number | null} */ distance_m) =>
    /** @type {any} */ ({ run: { given, distance_m } });
  const entries = [
    entry({ alpha: 0.1, gait: "tripod", steps: 50 }, 0.3), entry({ alpha: 0.5, gait: "ripple", steps: 50 }, 0.2),
    entry({ alpha: 0.9 }, null), /** @type {any} */ ({ run: null }),
  ];
  assert.deepEqual(settingDots(["alpha", "gait", "steps"], entries), [
    { name: "alpha", points: [[0.1, 0.3], [0.5, 0.2]], values: null },
    { name: "gait", points: [[1, 0.3], [0, 0.2]], values: ["ripple", "tripod"] },
  ]);
});

test("races are counted by who won them, and answers as far as there are any", () => {
  const results = /** @type {any} */ ({ entries: [
    { prediction: "greedy", run: { winners: ["greedy"] } }, { prediction: null, run: null },
    { prediction: 0, run: { winners: ["greedy", "q-learning"] } },
  ] });
  const { by, races } = winsOf(results);
  assert.deepEqual([by.get("greedy"), by.get("q-learning"), races], [2, 1, 2]);
  assert.deepEqual(predictionsOf(results), ["greedy", 0]);
  assert.deepEqual(predictionsOf(null), []);
});

test("robots of the class are called by their pupils, those that are taught by their teachers", () => {
  /** @type {any} */
  const card = {
    race: { run_id: "race", seeds: [4, 2, 9], of: 5 },
    entries: [{ seed: 2, name: "Jolly Swan" }, { seed: 4, name: "Patient Seal" }],
  };
  const named = (/** @type {string | null} */ run_id) => {
    scene.value = /** @type {any} */ ({ run_id, lanes: [] });
    return laneNames.value;
  };
  resultsByCard.value = { 0: card };
  assert.equal(named("race"), "Patient Seal\nJolly Swan\nOne of you");
  assert.equal(named("other"), "");
  assert.equal(named(null), "");
  teaching.value = /** @type {any} */ ({ race_id: "both", taught: { run_id: "taught" } });
  assert.equal(named("both"), "Taught by you\nTaught by the reward");
  assert.equal(named("taught"), "Taught by you");
  room.value = /** @type {any} */ ({ shown: { teach: { rival: "simulated" } } });
  assert.equal(named("both"), "Taught by you\nTaught by a simulated person");
  resultsByCard.value = {};
  [teaching, room, scene].forEach((signal) => (signal.value = null));
});

test("a race of the class says among which robots it has the best", () => {
  const among = (/** @type {number} */ of, /** @type {number} */ finished) =>
    racedAmong(/** @type {any} */ ({ finished, race: { of } }));
  assert.equal(among(5, 5), "of 5 robots");
  assert.equal(among(3, 5), "of the 3 of 5 robots that walk alike");
});
