// Experiments over the REST API.
import { call, pathOf, start } from "../../js/api.js";

/** @import { Run, Summary, Trial } from "../../js/types.js" */

/** @param {object} body */
export const startExperiment = (body) => start("experiments", body);
/** @type {(id: string) => Promise<{ trials: Trial[] }>} */
export const getTrials = (id) => call("GET", `${pathOf({ kind: "experiment", id })}/trials`);
/** Run a trial of an experiment here. @type {(id: string, key: string) => Promise<Run>} */
export const startTrial = (id, key) => start(`${pathOf({ kind: "experiment", id })}/trials/run`, { key });
/** @type {(id: string) => Promise<Summary>} */
export const getSummary = (id) => call("GET", `${pathOf({ kind: "experiment", id })}/summary`);
