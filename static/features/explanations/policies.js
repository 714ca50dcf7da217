// The tables of two trainings, and the states in which their best moves differ.
import { effect, signal } from "@preact/signals";
import { isLasting, patiently } from "../../js/api.js";
import { getTable } from "./api.js";
import { isSame } from "../../js/robots.js";
import { columnOf } from "./steps.js";
import { connection } from "../../js/store.js";
import { messageOf } from "../../js/titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../js/api.js" */
/** @import { FootCells, Move, Run, StateTable } from "../../js/types.js" */

/** More rows are not asked for, as a large table has many answers. */
export const MAX_STATES = 5000;
/** The table of a training that runs is asked for again after so long at the earliest. */
const EVERY_MS = 3000;

/** A table as far as it is compared: rows from the first state on. @typedef {FootCells & Rows} WholeTable */
/**
 * @typedef {object} Rows
 * @property {number} states number of all
 * @property {(number | null)[][]} values
 * @property {(number | null)[][]} visits
 * @property {Move[]} best
 */
/**
 * The newest whole table of a training, or why there is none. `done` is the number of steps that were done when it was
 * asked for; null where it is to be asked for again.
 * @typedef {{ table: WholeTable | null, problem: string | null, done: number | null }} Answer
 */

/** By run id, of the trainings that are compared. @type {Signal<Map<string, Answer>>} */
const answers = signal(new Map());

/** The table of a training, or why there is none; null while the first one loads. @param {Run} run */
export const tableOf = ({ id }) => answers.value.get(id) ?? null;

/**
 * Load the table of each training, and again when it has changed, until the function that is returned is called. Of a
 * training one table at a time is loaded; the one before stays until it is whole.
 * @param {() => Run[]} trainings
 */
export function followTables(trainings) {
  /** Those whose table is loaded, or was a short time ago. @type {Set<string>} */
  const busy = new Set();
  let isOver = false;
  const isWanted = (/** @type {string} */ id) => !isOver && trainings().some((run) => run.id === id);

  /** @type {(id: string, done: number) => Promise<void>} */
  async function load(id, done) {
    busy.add(id);
    const answer = await wholeTable(id, () => isWanted(id)).then(
      (table) => ({ table, problem: null, done }),
      (/** @type {RequestError} */ error) => afterError(error, id, done),
    );
    if (isWanted(id) && (answer.table ?? answer.problem)) {
      const remaining = [...answers.value].filter(([other]) => isWanted(other));
      answers.value = new Map([...remaining, [id, answer]]);
    }
    setTimeout(() => {
      busy.delete(id);
      look();
    }, EVERY_MS);
  }

  function look() {
    if (isOver || connection.value !== "live") return;
    for (const { id, progress } of trainings()) {
      const answer = answers.value.get(id);
      const isRefused = answer?.problem && answer.done !== null;
      if (!busy.has(id) && !isRefused && answer?.done !== progress.done) load(id, progress.done);
    }
  }

  const stop = effect(look);
  return () => {
    isOver = true;
    stop();
  };
}

/** @type {(error: RequestError, id: string, done: number) => Answer} */
function afterError(error, id, done) {
  if (isLasting(error)) return { table: null, problem: messageOf(error), done };
  const table = answers.value.get(id)?.table ?? null;
  return { table, problem: table ? null : messageOf(error), done: null };
}

/** Ask again for what could not be had. */
export const askAgain = () => {
  answers.value = new Map([...answers.value].filter(([, { table }]) => table !== null));
};

/** @type {(id: string, isWanted: () => boolean) => Promise<WholeTable | null>} */
async function wholeTable(id, isWanted) {
  /** @type {StateTable[]} */
  const parts = [];
  let first = 0;
  do {
    // All parts are of the same moment, however far the training gets meanwhile.
    const step = parts[0]?.step ?? null;
    const rows = await patiently(() => getTable({ training_id: id, step, first }), isWanted);
    if (!rows) return null;
    parts.push(rows);
    first += rows.values.length;
  } while (first < Math.min(parts[0].states, MAX_STATES));
  const { pairs, cells_m, cell_names, states } = parts[0];
  return {
    pairs, cells_m, cell_names, states,
    values: parts.flatMap(({ values }) => values), visits: parts.flatMap(({ visits }) => visits),
    best: parts.flatMap(({ best }) => best),
  };
}

/**
 * A learner's best move in a state: its value [m], and how often the learner has tried any move there.
 * @typedef {{ move: Move, value: number | null, visits: number }} Best
 */
/** @typedef {{ index: number, bests: [Best, Best] }} DifferentState */

/**
 * The states in which two learners that know them would move otherwise, the most visited first.
 * @param {WholeTable} first
 * @param {WholeTable} other
 */
export function differencesOf(first, other) {
  /** @type {DifferentState[]} */
  const different = [];
  const compared = Math.min(first.values.length, other.values.length);
  const counts = { both: 0, one: 0, other: 0 };
  for (let index = 0; index < compared; index += 1) {
    const bests = /** @type {[Best, Best]} */ ([bestIn(first, index), bestIn(other, index)]);
    const [inOne, inOther] = bests.map(({ visits }) => visits > 0);
    if (inOne && inOther) counts.both += 1;
    else if (inOne) counts.one += 1;
    else if (inOther) counts.other += 1;
    if (inOne && inOther && !isSame(bests[0].move, bests[1].move)) different.push({ index, bests });
  }
  const least = (/** @type {DifferentState} */ { bests }) => Math.min(...bests.map(({ visits }) => visits));
  return { different: different.sort((a, b) => least(b) - least(a) || a.index - b.index), compared, known: counts };
}

/** @type {(table: WholeTable, index: number) => Best} */
function bestIn(table, index) {
  const move = table.best[index];
  const visits = table.visits[index].reduce((/** @type {number} */ sum, count) => sum + (count ?? 0), 0);
  return { move, value: table.values[index][columnOf(move, table)] ?? null, visits };
}

/** Whether two tables have the same states and moves. @type {(one: WholeTable, other: WholeTable) => boolean} */
export const haveSameStates = (first, other) => isSame([first.pairs, first.cells_m], [other.pairs, other.cells_m]);
