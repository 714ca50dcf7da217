// Landings: where the feet stand when a step ends, and what a learner that values them makes of each.
import { stateCells, stateIndex } from "./steps.js";

/** @import { Explanation, StateTable } from "../../js/types.js" */

/** Rows of a table of landings that are shown at once; six legs one by one have 15,625. */
export const MAX_LANDINGS = 500;

/**
 * A landing: the cell of each pair, its value [m], and how often it came.
 * @typedef {{ index: number, cells: number[], value: number, visits: number }} Landing
 */

/**
 * The landings that came, the best first, then the others in the order of their cells, as far as they are shown.
 * @param {StateTable} shown of a learner with landings
 * @returns {Landing[]}
 */
export function rankedLandings(shown) {
  const { values, visits } = shown.landings ?? { values: [], visits: [] };
  return values
    .map((value, index) => ({ index, value, visits: visits[index] }))
    .sort((a, b) => Number(b.visits > 0) - Number(a.visits > 0)
      || (a.visits > 0 ? b.value - a.value : 0) || a.index - b.index)
    .slice(0, MAX_LANDINGS)
    .map((landing) => ({ ...landing, cells: stateCells(landing.index, shown) }));
}

/**
 * The index of the landing of a step.
 * @param {Pick<Explanation, "observation" | "action">} step
 * @param {StateTable} shown
 */
export const landingOf = ({ observation, action: [pair, cell] }, { cell_names }) =>
  stateIndex(observation.map((present, other) => (other === pair ? cell : present)), cell_names.length);

/**
 * Number of the state-action pairs that end in each landing: a table of these stores every landing so often.
 * @param {StateTable} shown
 */
export const pairsOfLanding = ({ pairs, cell_names }) => pairs.length * (cell_names.length - 1);
