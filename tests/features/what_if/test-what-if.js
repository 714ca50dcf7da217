// The request of a what-if: the form's practice, without what its ideal robots do not depend on.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { openForm, setField, setFields, trainingBody } from "../../../static/js/form.js";
import { page } from "../../../static/js/page-state.js";
import { options } from "../../../static/js/store.js";
import { installOnly } from "../../page/features.js";
import { OPTIONS } from "../../page/options.js";

await installOnly("what_if");
const { whatIfBody } = await import("../../../static/features/what_if/what-if.js");

beforeEach(() => {
  options.value = OPTIONS;
  page.form.value = new URLSearchParams();
  openForm();
});

test("a what-if does not depend on seed, pace, name, simulator, build tolerance, reward and world", () => {
  const before = whatIfBody();
  setFields({ seed: 9, pace: 8, name: "x", simulator: "kinematic", tolerance: 0.03, reward: "track", race_steps: 7 });
  setFields({ world: "limp-pair", disturb: ["limp:legs=2"] });
  assert.deepEqual(whatIfBody(), before);
  setField("alpha", 0.9);
  assert.notDeepEqual(whatIfBody(), before);
});

test("a what-if has the settings of the form's practice", () => {
  setFields({ steps: 300, divisions: 3, alpha: 0.7 });
  const { agent, steps, divisions, gait, robot, settings } = trainingBody();
  const body = whatIfBody();
  assert.deepEqual(
    [body.agent, body.steps, body.divisions, body.gait, body.robot, body.settings],
    [agent, steps, divisions, gait, robot, settings],
  );
});
