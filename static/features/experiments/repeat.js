// The same again with several seeds, as an experiment.
import { addressOf } from "../../js/page-state.js";
import { customRobotInWords, presetOf } from "../../js/robots.js";
import { isTraining } from "../../js/run-details.js";
import { fieldsOf } from "../../js/run-settings.js";
import { agentOf } from "../../js/settings.js";
import { experimentOf } from "./form.js";

/** @import { AnyRun } from "../../js/runs.js" */
/** @import { Run } from "../../js/types.js" */

const SEEDS = "12";

/** @type {(values: unknown[]) => string[]} */
const each = (values) => [...new Set(values.map(String))];

/**
 * The address of an experiment's form that has the settings of trainings; null where none is the same: of other
 * robots and gaits than the named ones, of what happens to the robot, and of practice that was continued or changed.
 * @param {AnyRun[]} all
 */
export function repeatAddress(all) {
  const trainings = all.filter(isTraining);
  if (trainings.length === 0 || trainings.length < all.length || !trainings.every(isRepeatable)) return null;
  const configs = trainings.map(({ config }) => config);
  const [simulator, ...simulators] = each(configs.map((config) => config.simulator));
  if (simulators.length) return null;
  const { defaults } = experimentOf("sweep");
  const pairs = configs.flatMap(({ agent, settings }) =>
    Object.entries(settings).filter(([name, value]) => value !== agentOf(agent).settings[name]?.default));
  const fields = {
    seeds: [SEEDS], simulator: [simulator],
    agents: each(configs.map(({ agent }) => agent)),
    gaits: each(configs.map(({ gait }) => gait)),
    robots: each(configs.map(({ robot }) => presetOf(robot))),
    observations: each(configs.map(({ observation }) => observation)),
    steps: each(configs.map(({ steps }) => steps)),
    steps_per_episode: each(configs.map(({ steps_per_episode }) => steps_per_episode)),
    divisions: each(configs.map(({ divisions }) => divisions)),
    grid_side_m: each(configs.map(({ grid_side_m }) => grid_side_m)),
    // Where one training has another value than by default, the others have theirs.
    ...Object.fromEntries(pairs.map(([name]) => [name, each(configs.flatMap(({ settings }) => settings[name] ?? []))])),
  };
  const set = Object.entries(fields).filter(([name, values]) => String(values) !== String(defaults[name] ?? ""));
  const experiment = new URLSearchParams([["experiment", "sweep"],
    ...set.map(([name, values]) => [name, values.join(LISTS_BY_COMMA.includes(name) ? "," : ";")])]);
  return addressOf({ view: "experiments", experiment });
}

const LISTS_BY_COMMA = ["agents", "gaits", "robots", "observations"];

/** @param {Run} run */
function isRepeatable(run) {
  const { world, tolerance, reward, before, changes } = fieldsOf(run);
  const { gait, robot } = run.config;
  const hasNames = typeof gait === "string" && customRobotInWords(robot) === null;
  return hasNames && [world, tolerance, reward, before, changes].every(({ key }) => key === "");
}
