// One step of a run and its table: which step is looked at, its explanation, and how the table is drawn and read.
import { computed, signal } from "@preact/signals";
import { keepAnswer } from "../../js/api.js";
import { getExplanation, getTable } from "./api.js";
import { decimal, inMillimetres, t, THIN_SPACE } from "../../js/format.js";
import { isPlaying, shownRun } from "../../js/on-stage.js";
import { connection, runs, scene } from "../../js/store.js";
import { cellName } from "../../js/training.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Reply } from "../../js/api.js" */
/** @import { Explanation, FootCells, Move, StateTable } from "../../js/types.js" */

/**
 * A step to look at: counted from 1; 0 is before the first.
 * @typedef {{ run_id: string, lane: number, step: number }} Moment
 */
/** While the stage plays, answers are asked for at most so often [ms]. */
const EVERY_MS = 500;

// ---- the step that is looked at: that of the stage, or one that was chosen

/** The step that was chosen here; null follows the stage. @type {Signal<Moment | null>} */
export const chosenMoment = signal(null);
/** The lane that was chosen; null is the first that has learned something. @type {Signal<number | null>} */
export const chosenLane = signal(null);

/** The moment on stage; null where no run with steps is on it. @type {Signal<Moment | null>} */
export const stageMoment = computed(() => {
  const { run_id = null, kind = "idle", lanes = [], action_values = null } = scene.value ?? {};
  if (run_id === null || kind === "idle" || shownRun.value?.id !== run_id || !lanes.length) return null;
  const lane = Math.min(chosenLane.value ?? action_values?.lane ?? 0, lanes.length - 1);
  return { run_id, lane, step: lanes[lane].step };
});

/** The moment that is looked at. @type {Signal<Moment | null>} */
export const moment = computed(() => {
  const shown = stageMoment.value;
  const chosen = chosenMoment.value;
  return chosen && chosen.run_id === shown?.run_id ? { ...chosen, lane: shown.lane } : shown;
});

/** Number of steps of the run there are to look at. */
export const lastStep = computed(() => {
  const run = shownRun.value;
  const at = moment.value;
  if (!run || !at) return 0;
  return run.kind === "race" ? scene.value?.lanes[at.lane]?.steps ?? 0 : run.progress.done;
});

export const isFollowing = computed(() => chosenMoment.value === null);

/** Look at a step, whatever the stage shows. @param {number} step */
export function chooseStep(step) {
  const at = moment.value;
  if (at) chosenMoment.value = { ...at, step: Math.min(Math.max(Math.round(step), 1), Math.max(lastStep.value, 1)) };
}

export const followStage = () => (chosenMoment.value = null);

// ---- the answers

/** @type {Signal<Reply<Explanation>>} */
export const explanation = signal({ answer: null, error: null, again: false });
/** @type {Signal<Reply<StateTable>>} */
export const table = signal({ answer: null, error: null, again: false });
/** Index of the first state of the part of a large table that is shown. */
export const firstState = signal(0);

/**
 * The table of a moment: as the learner had it when it chose the step. A lane has that of its training at its end;
 * a training that has not begun has none.
 * @type {Signal<{ training_id: string, step: number | null } | null>}
 */
export const tableMoment = computed(() => {
  const run = shownRun.value;
  const at = moment.value;
  if (!run || !at) return null;
  if (run.kind === "training") {
    return run.progress.done ? { training_id: run.id, step: Math.max(at.step - 1, 0) } : null;
  }
  const training_id = run.config.lanes?.[at.lane]?.training_id;
  return training_id ? { training_id, step: null } : null;
});

const pauseOfStage = () => (isPlaying.value && isFollowing.value ? EVERY_MS : 0);

/** Keep the explanation and the table of the moment, until the function that is returned is called. */
export function followMoment() {
  const isLive = () => connection.value === "live";
  const stops = [
    keepAnswer(
      () => (isLive() && moment.value && moment.value.step > 0 ? JSON.stringify(moment.value) : ""),
      (key) => getExplanation(JSON.parse(key)),
      explanation,
      pauseOfStage,
    ),
    keepAnswer(
      () => (isLive() && tableMoment.value
        ? JSON.stringify({ ...tableMoment.value, first: firstState.value, state: stateWhereNewest() })
        : ""),
      (key) => getTable(JSON.parse(key)),
      table,
      pauseOfStage,
    ),
  ];
  return () => stops.forEach((stop) => stop());
}

/** The newest table of a training is another one once that has ended. */
const stateWhereNewest = () =>
  (tableMoment.value?.step === null ? runs.value.get(tableMoment.value.training_id)?.state : null);

// ---- states and moves

/**
 * The index of a state: the number whose digits are its cells.
 * @param {number[]} cells the cell of each pair
 * @param {number} base number of cells of the foot grid
 */
export const stateIndex = (cells, base) => cells.reduce((index, cell) => index * base + cell, 0);

/**
 * The cell of each pair in a state.
 * @param {number} index
 * @param {FootCells} grid
 */
export function stateCells(index, { pairs, cell_names }) {
  const base = cell_names.length;
  return pairs.map((_, pair) => Math.floor(index / base ** (pairs.length - 1 - pair)) % base);
}

/** @param {number[]} legs */
export const legsInWords = (legs) => t("legs {legs}", { legs: legs.join("+") });

/**
 * Where the feet are: "legs 1+4 home, legs 2+5 front left".
 * @param {number[]} cells
 * @param {FootCells} grid
 */
export const stateInWords = (cells, grid) =>
  cells.map((cell, pair) => `${legsInWords(grid.pairs[pair])} ${cellName(grid, cell, " mm")}`).join(", ");

/** The cell of the foot grid in its middle. */
const HOME = 0;

/**
 * A move: "legs 1+4 to front left".
 * @param {Move} move
 * @param {FootCells} grid
 */
export function moveInWords([pair, cell], grid) {
  const legs = grid.pairs[pair].join("+");
  return cell === HOME ? t("legs {legs} to home", { legs })
    : t("legs {legs} to {cell}", { legs, cell: cellName(grid, cell, " mm") });
}

/** The column of a move in a table. @type {(move: Move, grid: FootCells) => number} */
export const columnOf = ([pair, cell], { cell_names }) => pair * cell_names.length + cell;

/** The move of a column of a table. @type {(column: number, grid: FootCells) => Move} */
export const moveOf = (column, { cell_names }) =>
  [Math.floor(column / cell_names.length), column % cell_names.length];

// ---- the table

/** Kind of a cell of the table. @typedef {"stays" | "untried" | "tried"} CellKind */

/**
 * @param {StateTable} shown
 * @param {number} row
 * @param {number} column
 * @returns {CellKind}
 */
export function cellKind({ values, visits }, row, column) {
  if (values[row][column] === null) return "stays";
  return visits[row][column] ? "tried" : "untried";
}

/**
 * The lowest and the highest value of what was tried; zeros where nothing was.
 * @param {StateTable} shown
 */
export function valueRange(shown) {
  let [low, high] = [Infinity, -Infinity];
  shown.values.forEach((row, at) =>
    row.forEach((value, column) => {
      if (value === null || cellKind(shown, at, column) !== "tried") return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }),
  );
  return low > high ? { low: 0, high: 0 } : { low, high };
}

/**
 * The values that colours begin and end with: of the foot grid in the picture wherever it is of the lane that is looked
 * at, so that a value has one colour in all views; else those of what is shown.
 * @param {{ low: number, high: number }} shown
 */
export function colourScale(shown) {
  const drawn = scene.value?.action_values;
  return drawn && drawn.lane === moment.value?.lane ? { low: drawn.low, high: drawn.high } : shown;
}

/** Number of the moves that were tried, of those there are. @param {StateTable} shown */
export function triedMoves(shown) {
  let [tried, all] = [0, 0];
  shown.values.forEach((row, at) =>
    row.forEach((_, column) => {
      const kind = cellKind(shown, at, column);
      all += Number(kind !== "stays");
      tried += Number(kind === "tried");
    }),
  );
  return { tried, all };
}

/**
 * A cell of the table in words: state, move, value, visits, best move.
 * @param {StateTable} shown
 * @param {number} row
 * @param {number} column
 */
export function cellInWords(shown, row, column) {
  const cells = stateCells(shown.first + row, shown);
  const move = moveOf(column, shown);
  const best = moveInWords(shown.best[row], shown);
  const kind = cellKind(shown, row, column);
  const value = shown.values[row][column] ?? 0;
  const visits = shown.visits[row][column] ?? 0;
  const isBest = columnOf(shown.best[row], shown) === column;
  const worth = {
    stays: t("no move: they stand there"),
    untried: value === 0 ? t("never tried") : t("never tried; taken for {value}", { value: inMillimetres(value) }),
    tried: visits === 1 ? t("{value}, tried once", { value: inMillimetres(value) })
      : t("{value}, tried {visits} times", { value: inMillimetres(value), visits }),
  }[kind];
  const isKnown = shown.visits[row].some(Boolean);
  const remark = isKnown ? t("best here: {move}", { move: best }) : t("nothing tried here");
  const about = isBest && kind === "tried" ? t("the best move here") : remark;
  return { state: stateInWords(cells, shown), move: moveInWords(move, shown), worth, about };
}

// ---- rules with numbers

const SUPERSCRIPTS = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";

/**
 * A number of a rule with six significant digits: "0.0123457", "−2.5".
 * @param {number} value
 */
export function ruleNumber(value) {
  const text = Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(6)));
  const [mantissa, exponent] = text.split("e");
  const raised = exponent?.replace(/[-\d]/g, (sign) => SUPERSCRIPTS["-0123456789".indexOf(sign)]);
  return decimal(mantissa).replace("-", "−") + (raised ? ` · 10${raised}` : "");
}

/** A value of the table, to the digit at which another one differs. @type {(value: number, other: number) => string} */
export function comparedNumber(value, other) {
  for (let digits = 5; digits <= 17; digits += 1) {
    const [first, second] = [value, other].map((number) => number.toPrecision(digits));
    if (first !== second || digits === 17) return `${decimal(first).replace("-", "−")}${THIN_SPACE}m`;
  }
  return String(value);
}
