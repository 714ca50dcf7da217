// Disturbances: conditions of a step, their words, and their text.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { beforeEach, test } from "node:test";
import {
  changesSomething, chosenWith, conditionsAt, conditionsInWords, conditionsNow, disturbancesOf, inTime, inWords,
  isSimulated, kindFor, kindNamed, legStates, nothingOf, parseText, parseWorld, pressed, splitWorlds, textOf,
  withField, worldTitle,
} from "../../static/js/disturbances.js";
import { azimuthsOf } from "../../static/js/robots.js";
import { options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

const LIMP = { kind: "limp", at_step: 25, legs: [1, 4] };
const SLOPE = { kind: "slope", at_step: 0, degrees: 8, direction_deg: 0 };

/** @type {(disturbances: any[], step: number) => string[]} */
const wordsAt = (disturbances, step) =>
  conditionsInWords(conditionsAt(disturbances, step)).map((words) => words.replaceAll("\u00a0", " "));

/** The server's test of its worlds reads them too. */
const CASES = JSON.parse(readFileSync(new URL("../cases/conditions.json", import.meta.url), "utf8"));

for (const { happens, step, holds } of CASES) {
  test(`${happens.join(", ")}: what holds in step ${step}`, () => {
    const disturbances = happens.map((/** @type {string} */ text) => parseText(text).value);
    const texts = conditionsAt(disturbances, step).map((condition) =>
      textOf({ ...condition, at_step: 0, until_step: null }));
    assert.deepEqual(texts.sort(), holds.sort());
  });
}

test("what happens holds from its step on, leg by leg, until it ends or is repaired", () => {
  const disturbances = [SLOPE, LIMP, { kind: "repair", at_step: 30, legs: [4] }, { ...SLOPE, at_step: 40, degrees: 0 }];
  assert.deepEqual(wordsAt(disturbances, 24), ["slope 8°"]);
  assert.deepEqual(wordsAt(disturbances, 25), ["slope 8°", "legs 1, 4 limp"]);
  assert.deepEqual(wordsAt(disturbances, 30), ["slope 8°", "leg 1 limp"]);
  assert.deepEqual(wordsAt(disturbances, 40), ["leg 1 limp"]);
  assert.deepEqual(wordsAt([{ ...LIMP, until_step: 27 }], 27), []);
});

test("what happens to a leg replaces what happened to its joints", () => {
  const stuck = { kind: "stuck", at_step: 1, leg: 2, joint: "femur", angle_rad: -0.9 };
  assert.deepEqual(wordsAt([stuck], 1), ["leg 2: femur stuck at −0.9 rad"]);
  assert.deepEqual([...legStates(conditionsAt([stuck], 1))], [[2, "femur stuck"]]);
  assert.deepEqual(wordsAt([stuck, { kind: "repair", at_step: 2, legs: [2] }], 2), []);
});

test("a push holds in no step", () => {
  const push = { kind: "push", at_step: 4, impulse_ns: 2, direction_deg: 90 };
  assert.deepEqual(wordsAt([push], 4), []);
  assert.equal(inTime(push).replaceAll("\u00a0", " "), "push 2 N·s, direction 90° in step 5");
});

test("words are short, with units, and count steps from 1", () => {
  const noise = { kind: "sensor-noise", at_step: 0, sd_m: 0.004 };
  assert.equal(inWords(noise), "sensor noise 4\u00a0mm");
  assert.equal(inTime(noise), "sensor noise 4\u00a0mm");
  assert.equal(inTime({ ...LIMP, until_step: 30 }), "legs\u00a01, 4 limp from step 26 to step 30");
  assert.equal(inWords({ kind: "weak", at_step: 0, legs: [2], torque_share: 0.3 }),
    "leg\u00a02 weak, share of torque 0.3");
  assert.equal(inWords({ kind: "fire", at_step: 0 }), "fire");
});

test("a training that runs has what its config says, and what was done to it", () => {
  const { config } = makeRun({});
  const changes = [{ step: 7, disturbance: { ...LIMP, at_step: 7 } }, { step: 8, settings: { alpha: 0.5 } }];
  const run = makeRun({ config: { ...config, disturbances: [SLOPE] }, changes, progress: { done: 3, total: 500 } });
  assert.deepEqual(disturbancesOf(run).map(({ kind }) => kind), ["slope", "limp"]);
  assert.deepEqual(conditionsInWords(conditionsNow(run)), ["slope 8°", "legs\u00a01, 4 limp"]);
  assert.deepEqual(disturbancesOf(makeRun({})), []);
});

test("pressing a leg lets something happen to it, or repairs it where that has happened", () => {
  const conditions = conditionsAt([LIMP, { kind: "lost", at_step: 0, legs: [6] }], 25);
  const [limp, weak] = [{ kind: "limp" }, { kind: "weak", torque_share: 0.3 }];
  const stuck = { kind: "stuck", joint: "femur", angle_rad: -0.9 };
  assert.deepEqual(pressed(conditions, 2, limp), { kind: "limp", legs: [2] });
  assert.deepEqual(pressed(conditions, 4, limp), { kind: "repair", legs: [4] });
  assert.deepEqual(pressed(conditions, 4, weak), { ...weak, legs: [4] });
  assert.deepEqual(pressed(conditions, 4, stuck), { ...stuck, leg: 4 });
  assert.deepEqual(pressed(conditions, 6, limp), { kind: "repair", legs: [6] });
  assert.deepEqual(pressed(conditions, 2, { kind: "repair" }), { kind: "repair", legs: [2] });
  const isStuck = conditionsAt([{ ...stuck, at_step: 0, leg: 2 }], 0);
  assert.deepEqual(pressed(isStuck, 2, stuck), { kind: "repair", legs: [2] });
  assert.deepEqual(pressed(isStuck, 2, { ...stuck, angle_rad: 0.5 }), { ...stuck, angle_rad: 0.5, leg: 2 });
});

test("a leg without power may have a stuck joint besides; one that is lost has neither", () => {
  const stuck = { kind: "stuck", at_step: 1, leg: 1, joint: "femur", angle_rad: -0.9 };
  const both = [stuck, { kind: "limp", at_step: 2, legs: [1] }];
  assert.deepEqual([...legStates(conditionsAt(both, 2))], [[1, "femur stuck, limp"]]);
  const weak = { kind: "weak", at_step: 3, legs: [1], torque_share: 0.3 };
  assert.deepEqual([...legStates(conditionsAt([...both, weak], 3))], [[1, "femur stuck, weak"]]);
  const lost = { kind: "lost", at_step: 4, legs: [1] };
  assert.deepEqual([...legStates(conditionsAt([...both, weak, lost], 4))], [[1, "lost"]]);
});

test("a strip of the track replaces what happened to the same strip only", () => {
  const patch = { kind: "patch", at_step: 1, from_m: 0.1, to_m: 0.2, friction: 0.3 };
  const other = { ...patch, at_step: 2, to_m: 0.4 };
  const anew = { ...patch, at_step: 3, friction: 0.5 };
  assert.deepEqual(conditionsAt([patch, other, anew], 3).map(({ friction }) => friction), [0.3, 0.5]);
});

test("a text has several worlds, each with a title", () => {
  assert.deepEqual(splitWorlds("flat, limp:legs=1,4+slope:degrees=4 ; limp-pair,"),
    ["flat", "limp:legs=1,4+slope:degrees=4", "limp-pair"]);
  assert.deepEqual(parseWorld("limp-pair").value, [{ kind: "limp", at_step: 0, legs: [1, 4] }]);
  assert.deepEqual(["flat", "limp:legs=1,4+slope:degrees=4", "moon"].map(worldTitle),
    ["Flat ground", "Legs\u00a01, 4 limp, slope 4°", "moon"]);
});

test("declarations tell which simulator knows a kind", () => {
  const isKnown = (/** @type {string} */ kind) => isSimulated(kind, "kinematic");
  assert.deepEqual(["limp", "sensor-noise", "fire"].map(isKnown), [false, true, false]);
});

test("the friction with which a robot was built is nothing that has happened to it", () => {
  const disturbances = [0.1, 1].map((value, at_step) => ({ kind: "friction", at_step, value }));
  const stateOf = (/** @type {any} */ robot) => conditionsInWords(conditionsAt(disturbances, 1, robot));
  assert.deepEqual(stateOf("stiff"), []);
  assert.deepEqual(stateOf({ preset: "stiff", friction: 0.5 }), ["friction 1"]);
  assert.deepEqual([nothingOf("friction", { preset: "stiff", friction: 0.5 }), nothingOf("slope"), nothingOf("weak")],
    [0.5, 0, 1]);
});

test("what ends nothing changes nothing", () => {
  const [repair, flat] = [{ kind: "repair", at_step: 0, legs: [4] }, { ...SLOPE, degrees: 0 }];
  const asBuilt = { kind: "friction", at_step: 0, value: 1 };
  const changed = (/** @type {any[]} */ conditions) =>
    [repair, flat, asBuilt, LIMP].map((disturbance) => changesSomething(disturbance, conditions, "stiff"));
  assert.deepEqual(changed([]), [false, false, false, true]);
  assert.deepEqual(changed([{ ...LIMP, legs: [1] }]), [false, false, false, true]);
  assert.deepEqual(changed([LIMP, SLOPE, { ...asBuilt, value: 0.1 }]), [true, true, true, true]);
});

test("of what is chosen to happen, each takes the place of what it contradicts and of nothing else", () => {
  const stuck = { kind: "stuck", at_step: 0, leg: 2, joint: "femur", angle_rad: -0.9 };
  const [weak, limp] = [{ kind: "weak", torque_share: 0.3 }, { kind: "limp" }]
    .map((disturbance) => ({ ...disturbance, at_step: 0, legs: [2] }));
  const repair = { kind: "repair", at_step: 0, legs: [2] };
  const choose = (/** @type {any[]} */ ones, /** @type {any[]} */ before = []) =>
    ones.reduce((chosen, disturbance) => chosenWith(chosen, disturbance, before, "stiff"), []);
  assert.deepEqual(choose([stuck, weak]), [stuck, weak]);
  assert.deepEqual(choose([stuck, weak, limp]), [stuck, limp]);
  assert.deepEqual(choose([stuck, { ...stuck, joint: "coxa" }, weak]), [stuck, { ...stuck, joint: "coxa" }, weak]);
  assert.deepEqual(choose([stuck, weak, repair]), []);
  assert.deepEqual(choose([stuck, repair], [weak]), [repair]);
  assert.deepEqual(choose([repair, limp], [weak]), [limp]);
  assert.deepEqual(choose([SLOPE, { ...SLOPE, degrees: 0 }, stuck]), [stuck]);
});

test("a text is read as on the command line, and written so", () => {
  assert.deepEqual(parseText("limp:legs=1,4:at=25").value, LIMP);
  assert.deepEqual(parseText("slope:degrees=8:at_step=3:until=9").value,
    { kind: "slope", degrees: 8, at_step: 3, until_step: 9 });
  assert.equal(textOf(LIMP), "limp:legs=1,4:at=25");
  assert.equal(textOf(SLOPE), "slope:degrees=8");
  assert.equal(textOf({ kind: "stuck", leg: 2, joint: "femur", angle_rad: -0.9, at_step: 0 }),
    "stuck:leg=2:joint=femur:angle_rad=-0.9");
});

test("a text that is not valid is explained", () => {
  const mistakeOf = (/** @type {string} */ text) => parseText(text).mistake ?? "";
  assert.match(mistakeOf("fire"), /“fire” is nothing that can happen/);
  assert.match(mistakeOf("limp:arms=1"), /“arms” is none of legs, at and until/);
  assert.match(mistakeOf("limp"), /give legs/);
  assert.match(mistakeOf("limp:legs=1,1"), /legs: Enter each once/);
  assert.match(mistakeOf("limp:legs=13"), /from 1 to 12/);
  assert.match(mistakeOf("limp:legs="), /Enter a whole number/);
  assert.match(mistakeOf("slope:degrees=80"), /Slope, slope: Must be from 0 to 30/);
  assert.match(mistakeOf("slope:degrees=8:degrees=9"), /once/);
  assert.match(mistakeOf("stuck:leg=1:joint=coxa:angle_rad=1.5"), /Stuck joint, angle: Must be from -1.2 to 1.2/);
  assert.equal(mistakeOf("stuck:leg=1:joint=femur:angle_rad=1.5"), "");
});

test("a field of a text is changed in its place", () => {
  assert.equal(withField("limp:legs=1:at=25", "legs", "1,4"), "limp:legs=1,4:at=25");
  assert.equal(withField("limp:legs=1:at_step=25", "at_step", "9"), "limp:legs=1:at=9");
  assert.equal(withField("limp:legs=1:at=25", "at_step", ""), "limp:legs=1");
  assert.equal(withField("limp", "legs", "2"), "limp:legs=2");
});

test("legs are drawn from forward, of any robot", () => {
  const named = { ...OPTIONS.gaits[0], azimuths_deg: [-30, 30, 90, 150, -150, -90] };
  assert.deepEqual(azimuthsOf("stiff", "tripod", { ...OPTIONS, gaits: [named] }), [-30, 30, 90, 150, 210, 270]);
  assert.deepEqual(azimuthsOf({ n_legs: 4 }, { right_leg: 1, left_leg: 2 }, OPTIONS), [-45, 45, 135, 225]);
  const legs = [{ azimuth_deg: 0, radius_m: 0.1 }, { azimuth_deg: 180, radius_m: 0.1 }];
  assert.deepEqual(azimuthsOf({ legs }, { right_leg: 1, left_leg: 2 }, OPTIONS), [-90, 90]);
  // Those of a creature by its name.
  assert.deepEqual(azimuthsOf("dog", { right_leg: 1, left_leg: 2 }, OPTIONS), [-60, 60, 120, -120]);
  assert.equal(azimuthsOf({ preset: "dog" }, "tripod", { ...OPTIONS, gaits: [named] }).length, 4);
});

test("a joint is one of the robot's leg, and turns as far as that", () => {
  const spot = {
    ...OPTIONS.robots[1], name: "spot", joints: [["hip", "femur"], ["hip", "knee", "wrist"]],
    limits_rad: /** @type {[number, number][][]} */ ([[[-1, 1], [-3, 3]], [[-1, 1], [0, 2], [-1, 0]]]),
  };
  options.value = { ...OPTIONS, robots: [...OPTIONS.robots, spot] };
  const { joint, angle_rad } = kindFor("stuck", "spot", 2)?.fields ?? {};
  assert.deepEqual(joint.choices, ["hip", "knee", "wrist"]);
  assert.deepEqual(angle_rad.ranges?.ranges.wrist, [-1, 0]);
  assert.deepEqual(kindFor("stuck", "stiff")?.fields.joint.choices, ["coxa", "femur", "tibia"]);
  assert.equal(kindFor("limp", "spot"), kindNamed("limp"));

  assert.equal(parseText("stuck:leg=2:joint=wrist:angle_rad=-0.5", "spot").value?.joint, "wrist");
  assert.match(parseText("stuck:leg=2:joint=femur:angle_rad=0.5", "spot").mistake ?? "", /hip, or knee/);
  assert.match(parseText("stuck:leg=2:joint=wrist:angle_rad=0.5", "spot").mistake ?? "", /from −?-?1 to 0/);
  assert.equal(parseText("stuck:leg=1:joint=femur:angle_rad=1.4", "spot").value?.angle_rad, 1.4);
});
