// Counts the trials of an experiment before it is started.
import { learns, settingsOf } from "../agents.js";

/** @import { ExperimentValues } from "../types.js" */

const PLACE_FIELDS = ["gaits", "observations", "robots", "divisions", "grid_side_m"];
const PRACTICE_FIELDS = ["steps", "steps_per_episode"];

/**
 * Fields without a value, where each agent has its own default, count once.
 * @type {(values: ExperimentValues, fields: string[]) => number}
 */
const combinations = (values, fields) =>
  fields.reduce((total, field) => total * Math.max(1, /** @type {unknown[]} */ (values[field] ?? []).length), 1);

/**
 * Learners have one trial per seed, agents that look ahead one in all; greedy is always tried for comparison.
 * Table 1 has two-step and a race that measures decision times besides.
 * @param {string} experiment
 * @param {ExperimentValues} values
 */
export function countTrials(experiment, values) {
  const places = combinations(values, PLACE_FIELDS);
  if (experiment === "table1") return places * (2 + values.steps.length * values.seeds + 1);
  const perPlace = [...new Set(["greedy", ...values.agents])].map((agent) => {
    const own = combinations(values, Object.keys(settingsOf([agent])));
    return learns(agent) ? own * combinations(values, PRACTICE_FIELDS) * values.seeds : own;
  });
  return places * perPlace.reduce((total, one) => total + one, 0);
}
