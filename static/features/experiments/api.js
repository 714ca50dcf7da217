// Experiments over the REST API.
import { call, pathOf, request, start } from "../../js/api.js";

/** @import { Run, SettingComparison, Summary, Trial } from "../../js/types.js" */

/** @param {object} body */
export const startExperiment = (body) => start("experiments", body);
/** @type {(id: string) => Promise<{ trials: Trial[] }>} */
export const getTrials = (id) => call("GET", `${pathOf({ kind: "experiment", id })}/trials`);
/** Run a trial of an experiment here. @type {(id: string, key: string) => Promise<Run>} */
export const startTrial = (id, key) => start(`${pathOf({ kind: "experiment", id })}/trials/run`, { key });
/** @type {(id: string) => Promise<Summary>} */
export const getSummary = (id) => call("GET", `${pathOf({ kind: "experiment", id })}/summary`);
/** @type {(id: string, a: string, b: string) => Promise<SettingComparison>} */
export const getComparison = (id, a, b) =>
  call("GET", `${pathOf({ kind: "experiment", id })}/comparison?${new URLSearchParams({ a, b })}`);
/** A figure for a paper with all its files. @type {(id: string, query: URLSearchParams) => Promise<Blob>} */
export const getFigure = async (id, query) =>
  (await request("GET", `${pathOf({ kind: "experiment", id })}/figure?${query}`)).blob();
