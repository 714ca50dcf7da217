// The page of a demo's visitor: whose runs it may change, and what it says of the allowance.
import assert from "node:assert/strict";
import { test } from "node:test";
import { isVisitor, mayChange, mayStart, myRuns, visitorRuns } from "../../static/js/selectors.js";
import { role } from "../../static/js/store.js";

test("a visitor starts runs and changes their own alone", () => {
  role.value = "visitor";
  visitorRuns.value = ["a", "b"];
  assert.equal(isVisitor.value, true);
  assert.equal(mayStart.value, true);
  assert.equal(mayChange({ id: "a" }), true);
  assert.equal(mayChange({ id: "c" }), false);
  assert.deepEqual(myRuns.value, ["b", "a"]);
});

test("a spectator does neither, an operator both", () => {
  visitorRuns.value = [];
  role.value = "spectator";
  assert.equal(mayStart.value, false);
  assert.equal(mayChange({ id: "a" }), false);
  role.value = "operator";
  assert.equal(mayStart.value, true);
  assert.equal(mayChange({ id: "c" }), true);
});
