// The answers of a class to the question of a card, as the acts that reveal them need them.

/** @import { Ask, CardResults } from "../../../../js/types.js" */
/** @import { Facts } from "./index.js" */

/** Whether a card that asks a question of a kind is revealed. */
/** @type {(kind: Ask["kind"]) => (facts: Facts) => boolean} */
export const isRevealOf = (kind) => ({ classroom, isRevealed }) => isRevealed && classroom.shown.ask?.kind === kind;

/** All answers that the projector may show. @param {CardResults | null} results @returns {any[]} */
export const predictionsOf = (results) =>
  (results?.entries ?? []).map(({ prediction }) => prediction).filter((value) => value !== null);

/**
 * Races by the agent that won them; one that several won counts for each. `races`: how many there are.
 * @param {CardResults | null} results
 */
export function winsOf(results) {
  const won = (results?.entries ?? []).flatMap(({ run }) => (run?.winners.length ? [run.winners] : []));
  const by = new Map();
  for (const agent of won.flat()) by.set(agent, (by.get(agent) ?? 0) + 1);
  return { by, races: won.length };
}
