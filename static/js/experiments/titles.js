// Display names in experiments: fields, values of settings, runs.
import { agentOf, presetOf } from "../selectors.js";
import { count } from "../format.js";
import { gaitTitle, observationTitle, robotTitle, simulatorTitle } from "../titles.js";
import { experimentOf } from "./catalogue.js";

/** @import { Run } from "../types.js" */

/** @param {string} name */
export const agentTitle = (name) => agentOf(name).title;

/** @type {Record<string, string>} */
export const FIELD_TITLES = {
  gait: "Gait", observation: "Observation", robot: "Robot", agent: "Agent", steps: "Steps of practice",
  alpha: "α", gamma: "γ", epsilon_start: "ε, first episode", epsilon_end: "ε, last episode",
  steps_per_episode: "Steps per episode", divisions: "Divisions", grid_side_m: "Grid side, m",
};

/** @type {Record<string, (name: string) => string>} */
const TITLES_OF = { gait: gaitTitle, agent: agentTitle, observation: observationTitle, robot: robotTitle };

/**
 * A value of a setting's field in words.
 * @param {string} field
 * @param {any} value
 */
export function valueTitle(field, value) {
  if (value === null || value === undefined) return "–";
  return (TITLES_OF[field] ?? String)(value);
}

/** @param {Run} run */
export const runTitle = (run) => run.name || experimentOf(run.config.experiment)?.title || run.config.experiment;

/**
 * An experiment's seeds and places in one line.
 * @param {Run} run
 */
export const describeRun = ({ config }) => {
  const robots = (config.robots ?? []).map((one) => presetOf(one) ?? one.name ?? "own robot");
  const observations = (config.observations ?? []).map(observationTitle);
  return [
    count(config.seeds, "seed"), `from seed ${config.seed}`, observations.join(" and "), robots.join(" and "),
    simulatorTitle(config.simulator),
  ].filter(Boolean).join(" · ");
};
