// Groups a summary's settings by the place in which agents are compared: observation, robot and foot grid.

/** @import { Place, Setting } from "../types.js" */

/** @param {Omit<Place, "key" | "half_side_m">} setting */
export const placeOf = ({ observation, robot, divisions, grid_side_m }) =>
  [observation, robot, divisions, grid_side_m].join("/");

/** @param {Setting} setting */
const pairOf = (setting) => `${setting.gait} in ${placeOf(setting)}`;

/**
 * The places of an experiment, in its order.
 * @param {Omit<Place, "key">[]} settings
 * @returns {Place[]}
 */
export function placesOf(settings) {
  /** @type {Map<string, Place>} */
  const found = new Map();
  for (const setting of settings) {
    const { observation, robot, divisions, grid_side_m, half_side_m } = setting;
    const key = placeOf(setting);
    if (!found.has(key)) found.set(key, { key, observation, robot, divisions, grid_side_m, half_side_m });
  }
  return [...found.values()];
}

/**
 * Each gait of a place with its learners and references, in the order of the experiment.
 * @param {Setting[]} settings
 * @param {string} place
 */
export function gaitsOf(settings, place) {
  const here = settings.filter((setting) => placeOf(setting) === place);
  return [...new Set(here.map(({ gait }) => gait))].map((gait) => {
    const own = here.filter((setting) => setting.gait === gait);
    const references = own.filter(({ role }) => role === "reference");
    return {
      gait,
      learners: own.filter(({ role }) => role === "learner"),
      references: Object.fromEntries(references.map((one) => [one.agent, one])),
    };
  });
}

/**
 * A function from a setting to greedy's total distance for the same gait in the same place [m].
 * @param {Setting[]} settings
 * @returns {(setting: Setting) => number | null}
 */
export function greedyTotals(settings) {
  /** @type {Map<string, number>} */
  const found = new Map();
  for (const setting of settings) {
    const isGreedy = setting.role === "reference" && setting.agent === "greedy";
    if (isGreedy && setting.total) found.set(pairOf(setting), setting.total.mean_m);
  }
  return (setting) => found.get(pairOf(setting)) ?? null;
}
