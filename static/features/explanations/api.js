// Requests of explanations: of a step, of why a lane loses, and of the table after a step.
import { call } from "../../js/api.js";
import { inWords } from "../../js/format.js";

/** @import { Explanation, Loss, StateTable } from "../../js/types.js" */

/**
 * A step of a run, explained.
 * @type {(of: { run_id: string, lane: number, step: number }) => Promise<Explanation>}
 */
export const getExplanation = async ({ run_id, lane, step }) => {
  const query = new URLSearchParams({ step: `${step}`, lane: `${lane}` });
  return inWords(await call("GET", `runs/${encodeURIComponent(run_id)}/explain?${query}`));
};

/** Why a lane loses its race. @type {(of: { run_id: string, lane: number, clock: string }) => Promise<Loss>} */
export const getLoss = async ({ run_id, lane, clock }) => {
  const query = new URLSearchParams({ lane: `${lane}`, clock });
  return inWords(await call("GET", `races/${encodeURIComponent(run_id)}/loss?${query}`));
};

/**
 * The table of a training after so many steps; null is the newest.
 * @type {(of: { training_id: string, step: number | null, first: number }) => Promise<StateTable>}
 */
export const getTable = ({ training_id, step, first }) => {
  const query = new URLSearchParams({ first: `${first}`, ...(step === null ? {} : { step: `${step}` }) });
  return call("GET", `trainings/${encodeURIComponent(training_id)}/table?${query}`);
};
