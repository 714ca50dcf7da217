// Reads the action values of one state: the best move, and the names of places on the foot grid.

/** @import { Knowledge } from "./types.js" */

/** Grids with more cells are named by distances, in millimetres. */
const MOST_NAMED_CELLS = 5;

/**
 * The move of the highest value; pair and cell are -1 where there is none.
 * @param {Pick<Knowledge, "values_m">} known
 */
export function bestMove({ values_m }) {
  let best = { pair: -1, cell: -1, value: -Infinity };
  values_m.forEach((row, pair) =>
    row.forEach((value, cell) => {
      if (value !== null && value > best.value) best = { pair, cell, value };
    }),
  );
  return best;
}

/**
 * The name of a cell: "front left", or on finer grids "20 left, 10 front".
 * @param {Pick<Knowledge, "cell_names" | "cells_m">} known
 * @param {number} cell
 * @param {string} unit after each number
 */
export function placeName({ cell_names, cells_m }, cell, unit = "") {
  if (cell === 0 || cell_names.length <= MOST_NAMED_CELLS) return cell_names[cell];
  const [x, y] = cells_m[cell].map((metres) => Math.round(1000 * metres));
  const parts = [
    x && `${Math.abs(x)}${unit} ${x < 0 ? "left" : "right"}`,
    y && `${Math.abs(y)}${unit} ${y > 0 ? "front" : "back"}`,
  ];
  return parts.filter(Boolean).join(", ");
}
