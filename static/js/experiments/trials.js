// Counts the trials of an experiment before it is started.
import { learns } from "../selectors.js";

/** @import { ExperimentValues } from "../types.js" */

const PLACE_FIELDS = ["gaits", "observations", "robots", "divisions", "grid_side_m"];
const PRACTICE_FIELDS = ["steps", "alpha", "gamma", "epsilon_start", "epsilon_end", "steps_per_episode"];

/** @type {(values: ExperimentValues, fields: string[]) => number} */
const combinations = (values, fields) =>
  fields.reduce((total, field) => total * /** @type {unknown[]} */ (values[field]).length, 1);

/**
 * Learners have one trial per seed, agents that look ahead one in all; greedy is always tried for comparison.
 * Table 1 has two-step and a race that measures decision times besides.
 * @param {string} experiment
 * @param {ExperimentValues} values
 */
export function countTrials(experiment, values) {
  const places = combinations(values, PLACE_FIELDS);
  if (experiment === "table1") return places * (2 + values.steps.length * values.seeds + 1);
  const learners = values.agents.filter(learns).length;
  const lookingAhead = values.agents.filter((name) => !learns(name) && name !== "greedy").length;
  return places * (1 + lookingAhead + learners * combinations(values, PRACTICE_FIELDS) * values.seeds);
}
