// What is told of a robot before it walks.
import assert from "node:assert/strict";
import { test } from "node:test";
import { form, openForm } from "../../static/js/form.js";
import { page } from "../../static/js/page-state.js";
import { inWords, moveLeg, objections, offeredFor } from "../../static/js/preview.js";
import { options } from "../../static/js/store.js";
import { OPTIONS } from "./options.js";

/** @type {any} */
const STANDS = {
  groups: [{ legs: [1, 3, 5], margin_m: 0.0614 }, { legs: [2, 4, 6], margin_m: 0.0614 }],
  margin_m: 0.0614, tips: false, states: 25, actions: 8, values: 200, table_fits: true, law_m: 0.667,
  out_of_reach: null,
};

test("a robot is told by its states, how it stands and how fast it is by the law", () => {
  assert.equal(inWords(STANDS), "25 states, 8 moves · stands by 61 mm · 0.67\u00a0m in 50 steps by the law");
  assert.match(inWords({ ...STANDS, tips: true, margin_m: -0.012 }), /tips by 12 mm/);
});

test("what speaks against a robot is said at once: reach, tipping, tables that do not fit", () => {
  assert.deepEqual(objections(STANDS), []);
  const [reach, tip, table] = objections({
    ...STANDS, tips: true, table_fits: false, values: 2_000_000, out_of_reach: "Leg 2 does not reach.",
    groups: [{ legs: [1, 2], margin_m: -0.01 }, { legs: [3, 4], margin_m: -0.02 }, { legs: [5, 6], margin_m: 0.01 }],
  });
  assert.equal(reach, "Leg 2 does not reach.");
  assert.match(tip, /^It tips while legs 1\+2 and 3\+4 swing/);
  assert.match(table, /^A table of 2.000.000 values is too large/);
});

test("the recommended learner is offered where a body tips; else the usual one is left", () => {
  const preview = { ...STANDS, recommended_agent: "tracer" };
  assert.equal(offeredFor(preview), null);
  assert.equal(offeredFor({ ...preview, tips: true }), "tracer");
});

test("a leg moves to the next group, and after the last one begins its own", () => {
  options.value = OPTIONS;
  page.form.value = new URLSearchParams();
  openForm();
  const gait = { right_leg: 1, left_leg: 2 };
  /** @type {(groups: number[][], leg: number) => unknown} */
  const moved = (groups, leg) => {
    moveLeg({ ...STANDS, gait, groups: groups.map((legs) => ({ legs })) }, leg);
    return /** @type {any} */ (form.value.gait).groups;
  };
  assert.deepEqual(moved([[1, 3], [2, 4]], 1), [[3], [1, 2, 4]]);
  assert.deepEqual(moved([[3], [1, 2, 4]], 1), [[3], [2, 4], [1]]);
  assert.deepEqual(moved([[3], [2, 4], [1]], 1), [[1, 3], [2, 4]]);
  assert.deepEqual(moved([[1, 3], [2, 4]], 4), [[1, 3], [2], [4]]);
});
