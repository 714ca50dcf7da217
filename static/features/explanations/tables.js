// The tables of all learners of a race, to be looked at side by side.
import { computed, signal } from "@preact/signals";
import { keepAnswer, needsLonger } from "../../js/api.js";
import { getTable } from "./api.js";
import { shownRun } from "../../js/on-stage.js";
import { cellKind, triedMoves, valueRange } from "./steps.js";
import { connection, runs } from "../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Reply, RequestError } from "../../js/api.js" */
/** @import { StateTable } from "../../js/types.js" */

/** A lane with the training whose table it races with. @typedef {{ agent: string, training_id: string }} TrainedLane */
/** @typedef {TrainedLane & { table: StateTable }} LaneTable */

/** Larger tables are not drawn as maps. */
export const MAX_STATES = 1000;

/** The lanes of the race on stage that race with what a practice has taught. */
export const trainedLanes = computed(() => {
  const run = shownRun.value;
  if (run?.kind !== "race") return [];
  return (run.config.lanes ?? []).flatMap(({ agent, training_id }) => (training_id ? [{ agent, training_id }] : []));
});

/** @type {Signal<Reply<LaneTable[]>>} */
export const laneTables = signal({ answer: null, error: null, again: false });

/** Keep the tables of these lanes, until the function that is returned is called. */
export const followLaneTables = () => keepAnswer(
  () => {
    const lanes = trainedLanes.value;
    const isTrained = lanes.every(({ training_id }) => (runs.value.get(training_id)?.progress.done ?? 1) > 0);
    return connection.value === "live" && lanes.length > 1 && isTrained ? JSON.stringify(lanes) : "";
  },
  async (key) => {
    /** @type {TrainedLane[]} */
    const lanes = JSON.parse(key);
    const requests = lanes.map(({ training_id }) => getTable({ training_id, step: null, first: 0 }));
    const replies = await Promise.allSettled(requests);
    return lanes.flatMap((lane, number) => {
      const reply = replies[number];
      if (reply.status === "fulfilled") {
        return reply.value.states > MAX_STATES ? [] : [{ ...lane, table: reply.value }];
      }
      // A learner without a table is left out.
      if (!isWithoutTable(reply.reason)) throw reply.reason;
      return [];
    });
  },
  laneTables,
  () => 0,
);

/** @param {RequestError} error */
const isWithoutTable = (error) => error.status === 409 && !needsLonger(error);

/** A value of a map: null where it is none, or was never tried. @typedef {number | null} Mapped */
/**
 * A table as a map: its values row by row, of landings one in a row.
 * @typedef {object} TableMap
 * @property {Mapped[][]} rows
 * @property {boolean[][]} legal whether there is such a move
 * @property {number} low the lowest value of what was tried
 * @property {number} high
 * @property {number} tried number of the values that were tried, of those there are
 * @property {number} all
 * @property {string} kind of the values: moves or landings
 */

/** @param {StateTable} table @returns {TableMap} */
export function mapOf(table) {
  if (table.landings) {
    const { values, visits } = table.landings;
    const rows = values.map((value, at) => [visits[at] > 0 ? value : null]);
    const tried = rows.flat().filter((value) => value !== null);
    const [low, high] = tried.length ? [Math.min(...tried), Math.max(...tried)] : [0, 0];
    return { rows, legal: rows.map(() => [true]), low, high, tried: tried.length, all: rows.length, kind: "landings" };
  }
  const rows = table.values.map((row, at) =>
    row.map((value, column) => (cellKind(table, at, column) === "tried" ? value : null)));
  const legal = table.values.map((row, at) => row.map((_, column) => cellKind(table, at, column) !== "stays"));
  return { rows, legal, ...valueRange(table), ...triedMoves(table), kind: "moves" };
}
