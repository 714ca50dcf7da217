// The page of a demo's visitor: whose runs it may change, and what it says of the allowance.
import assert from "node:assert/strict";
import { test } from "node:test";
import { isGuest, mayChange, mayStart, myRuns } from "../../../static/js/selectors.js";
import { followed, visitorRuns } from "../../../static/features/demo/feature.js";
import { addCodeFor, features } from "../../../static/js/features.js";
import { makeRun } from "../../page/options.js";
import { installOnly } from "../../page/features.js";
import { role } from "../../../static/js/store.js";

await installOnly("demo");
await addCodeFor("visitor");

test("a visitor starts runs and changes their own alone", () => {
  role.value = "visitor";
  visitorRuns.value = ["a", "b"];
  assert.equal(isGuest.value, true);
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

test("a visitor's page follows the run that it has started last, an operator's does not", () => {
  role.value = "operator";
  features.value.forEach(({ started }) => started?.(makeRun({ id: "a" })));
  assert.equal(followed.value, null);
  role.value = "visitor";
  features.value.forEach(({ started }) => started?.(makeRun({ id: "b" })));
  assert.equal(followed.value, "b");
});
