// The way from trainings to the experiment that repeats them with several seeds.
import assert from "node:assert/strict";
import { test } from "node:test";
import { repeatAddress } from "../../../static/features/experiments/repeat.js";
import { applyEvent, options } from "../../../static/js/store.js";
import { installOnly } from "../../page/features.js";
import { makeRun, makeStage, OPTIONS } from "../../page/options.js";

await installOnly("experiments");
options.value = OPTIONS;
const { config } = makeRun({});
/** @type {(changes?: object) => ReturnType<typeof makeRun>} */
const trained = (changes = {}) => makeRun({ config: { ...config, ...changes } });

/** @param {ReturnType<typeof makeRun>[]} runs */
const know = (...runs) => applyEvent("snapshot", { runs, stage: makeStage(), scene: null, role: "operator" });

test("trainings are repeated with several seeds by the form of an experiment, where it can have their settings", () => {
  const settings = (/** @type {number} */ alpha) => ({ settings: { ...config.settings, alpha } });
  const [first, second] = [trained({ steps: 80, ...settings(0.3) }), trained({ steps: 80, ...settings(0.5) })];
  know(first, second);
  const address = "#experiments?experiment=sweep&seeds=12&gaits=tripod&steps=80";
  assert.equal(repeatAddress([first, second]), `${address}&alpha=0.3;0.5`);
  assert.equal(repeatAddress([first]), address);
  const limping = trained({ disturbances: OPTIONS.worlds[1].disturbances });
  const otherRuns = [
    limping, trained({ gait: { right_leg: 1 } }), trained({ continue_from: first.id }), trained({ tolerance: 0.1 }),
    trained({ reward: "track" }),
    makeRun({ kind: "race", name: "Final", config: { lanes: [] } }),
  ];
  for (const other of otherRuns) assert.equal(repeatAddress([first, other]), null);
  assert.equal(repeatAddress([first, trained({ simulator: "kinematic" })]), null);
});
