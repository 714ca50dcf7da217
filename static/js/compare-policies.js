// The tables of two trainings, and the states in which their best moves differ.
import { effect, signal } from "@preact/signals";
import { getTable } from "./api.js";
import { isSame } from "./robots.js";
import { columnOf } from "./steps.js";
import { messageOf } from "./titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { FootCells, Move, Run, StateTable } from "./types.js" */

/** More rows are not asked for, as a large table has many answers. */
export const MOST_STATES = 5000;
const AGAIN_MS = 1000;
const TOO_EARLY = 429;

/** A table as far as it is compared: rows from the first state on. @typedef {FootCells & Rows} WholeTable */
/**
 * @typedef {object} Rows
 * @property {number} states number of all
 * @property {(number | null)[][]} values
 * @property {(number | null)[][]} visits
 * @property {Move[]} best
 */
/** @typedef {{ table: WholeTable | null, problem: string | null }} Answer */

/** Run id and steps done → its table, or why there is none. @type {Signal<Map<string, Answer>>} */
const answers = signal(new Map());
/** Requests under way. @type {Set<string>} */
const asked = new Set();

/** @param {Run} run */
const keyOf = ({ id, progress }) => `${id} ${progress.done}`;

/** The table of a training, or why there is none; null while it loads. @param {Run} run */
export const tableOf = (run) => answers.value.get(keyOf(run)) ?? null;

/** Load the tables of trainings whenever they change. @param {() => Run[]} trainings */
export const followTables = (trainings) =>
  effect(() => {
    for (const run of trainings()) {
      const key = keyOf(run);
      if (!answers.value.has(key) && !asked.has(key)) load(run.id, key);
    }
  });

/** @param {string} id @param {string} key */
async function load(id, key) {
  asked.add(key);
  const answer = await wholeTable(id).then(
    (table) => ({ table, problem: null }),
    (/** @type {RequestError} */ error) => ({ table: null, problem: messageOf(error) }),
  );
  asked.delete(key);
  answers.value = new Map(answers.value).set(key, answer);
}

/** Ask again for what could not be had. */
export const askAgain = () => {
  answers.value = new Map([...answers.value].filter(([, { table }]) => table !== null));
};

/** @param {string} id @returns {Promise<WholeTable>} */
async function wholeTable(id) {
  /** @type {StateTable[]} */
  const parts = [];
  let first = 0;
  do {
    const part = await patiently(() => getTable({ training_id: id, step: null, first }));
    parts.push(part);
    first += part.values.length;
  } while (first < Math.min(parts[0].states, MOST_STATES));
  const { pairs, cells_m, cell_names, states } = parts[0];
  return {
    pairs, cells_m, cell_names, states,
    values: parts.flatMap(({ values }) => values), visits: parts.flatMap(({ visits }) => visits),
    best: parts.flatMap(({ best }) => best),
  };
}

/**
 * Ask, and again while the server needs longer.
 * @template Answered
 * @param {() => Promise<Answered>} ask
 * @returns {Promise<Answered>}
 */
async function patiently(ask) {
  try {
    return await ask();
  } catch (error) {
    if (/** @type {RequestError} */ (error).status !== TOO_EARLY) throw error;
  }
  await new Promise((resolve) => {
    setTimeout(resolve, AGAIN_MS);
  });
  return patiently(ask);
}

/**
 * A learner's best move in a state: its value [m], and how often the learner has tried any move there.
 * @typedef {{ move: Move, value: number | null, visits: number }} Best
 */
/** @typedef {{ index: number, bests: [Best, Best] }} DifferentState */

/**
 * The states in which two learners that know them would move otherwise, the most visited first.
 * @param {WholeTable} one
 * @param {WholeTable} other
 */
export function differencesOf(one, other) {
  /** @type {DifferentState[]} */
  const different = [];
  const compared = Math.min(one.values.length, other.values.length);
  const known = { both: 0, one: 0, other: 0 };
  for (let index = 0; index < compared; index += 1) {
    const bests = /** @type {[Best, Best]} */ ([bestIn(one, index), bestIn(other, index)]);
    const [inOne, inOther] = bests.map(({ visits }) => visits > 0);
    if (inOne && inOther) known.both += 1;
    else if (inOne) known.one += 1;
    else if (inOther) known.other += 1;
    if (inOne && inOther && !isSame(bests[0].move, bests[1].move)) different.push({ index, bests });
  }
  const least = (/** @type {DifferentState} */ { bests }) => Math.min(...bests.map(({ visits }) => visits));
  return { different: different.sort((a, b) => least(b) - least(a) || a.index - b.index), compared, known };
}

/** @type {(table: WholeTable, index: number) => Best} */
function bestIn(table, index) {
  const move = table.best[index];
  const visits = table.visits[index].reduce((/** @type {number} */ sum, one) => sum + (one ?? 0), 0);
  return { move, value: table.values[index][columnOf(move, table)] ?? null, visits };
}

/** Whether two tables have the same states and moves. @type {(one: WholeTable, other: WholeTable) => boolean} */
export const haveSameStates = (one, other) => isSame([one.pairs, one.cells_m], [other.pairs, other.cells_m]);
