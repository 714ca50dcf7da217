// Display names in experiments: fields, values of settings, runs.
import { agentOf } from "../agents.js";
import { presetOf } from "../selectors.js";
import { count } from "../format.js";
import { shortTitle } from "../settings.js";
import { options } from "../store.js";
import { gaitTitle, observationTitle, robotTitle, simulatorTitle } from "../titles.js";
import { experimentOf } from "./catalogue.js";

/** @import { Run } from "../types.js" */

/** @param {string} name */
export const agentTitle = (name) => agentOf(name).title;

/** @type {Record<string, string>} */
const PLACE_TITLES = { gait: "Gait", observation: "Observation", robot: "Robot", agent: "Agent" };

/**
 * The name of a field of settings; of a setting the short one that it declares.
 * @param {string} field
 */
export function fieldTitle(field) {
  const setting = options.value?.settings[field];
  return PLACE_TITLES[field] ?? (setting ? shortTitle(setting) : field);
}

/**
 * The fields in which settings differ; a setting that an agent does not have is null there.
 * @param {Record<string, any>[]} settings
 * @param {string[]} fields
 */
export const variedFields = (settings, fields) =>
  fields.filter((field) => new Set(settings.map((one) => one[field]).filter((one) => one !== null)).size > 1);

/** @type {Record<string, (name: string) => string>} */
const VALUE_TITLES = { gait: gaitTitle, agent: agentTitle, observation: observationTitle, robot: robotTitle };

/**
 * A value of a setting's field in words.
 * @param {string} field
 * @param {any} value
 */
export function valueTitle(field, value) {
  if (value === null || value === undefined) return "–";
  return (VALUE_TITLES[field] ?? String)(value);
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
