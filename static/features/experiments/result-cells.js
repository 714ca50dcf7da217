// Cells of result tables: a value in words with its interval, and for distances a strip with every seed and the paper's
// value.
import { bare, factorOf, inUnit, shown } from "./distances.js";
import { count, percentage, whole } from "../../js/format.js";
import { largest } from "../../js/scale.js";
import { agentOf } from "../../js/settings.js";

/** @import { Interval, PooledView, ScoredCurve, Setting, Until } from "../../js/types.js" */

/** @typedef {"finished" | "total"} Distance at time-out, and after 50 steps of its own */
/**
 * Every seed of a setting on an axis that begins at 0.
 * @typedef {object} Strip
 * @property {string} label the same in words
 * @property {number[]} points one per seed
 * @property {number} high where the axis ends
 * @property {{ iqm: number, low: number | null, high: number | null }} typical
 * @property {{ value: number, kind: string }[]} marks
 * @property {string} color
 * @property {(value: number) => string} axis a number of the axis in words
 * @property {{ setting: Setting, points_m: number[] }} [source] of the points, where a seed can be chosen
 */
/**
 * @typedef {object} Cell
 * @property {string} [text]
 * @property {string} [note] its interval, or what else is said of it
 * @property {string} [printed] the paper's value
 * @property {boolean} [isBold] as what is looked for first
 * @property {string} [badge] a word behind the text
 * @property {Strip} [strip]
 */

/** @type {Cell} */
export const NONE = {};
/** @type {Cell} */
export const WAITING = { note: "waiting for its first seed" };

/** @param {number | null | undefined} low @param {number | null | undefined} high */
const range = (low, high) => (low === null || low === undefined ? "" : `${bare(low)} – ${bare(high)}`);

// ---- distances of settings

/**
 * Factors from metres to the unit that is shown: for this run's distances, and for the paper's.
 * @param {Setting} setting
 * @param {Setting | null} greedy in the same place
 */
const factorsOf = (setting, greedy) => ({
  ours: factorOf({ ...setting, greedy_m: greedy?.total?.mean_m ?? null }),
  paper: factorOf({ ...setting, greedy_m: greedy?.published?.total_m ?? null }),
});

/**
 * The distances of a setting in the unit that is shown, with what they are compared with.
 * @param {Setting} setting
 * @param {Distance} distance
 * @param {Setting | null} greedy in the same place
 */
function measured(setting, distance, greedy) {
  const { ours, paper } = factorsOf(setting, greedy);
  const metres = setting[distance];
  /** @param {number | null | undefined} value */
  const converted = (value) => inUnit(value, ours);
  return {
    points: ours === null ? [] : (metres?.points_m ?? []).map((point) => point * ours),
    typical: metres && ours !== null
      ? { iqm: metres.iqm_m * ours, low: converted(metres.low_m), high: converted(metres.high_m) } : null,
    greedy: converted(greedy?.[distance]?.mean_m),
    // It is a distance after 50 steps, and has none at time-out.
    best: distance === "total" ? converted(setting.best_known_m) : null,
    printed: inUnit(setting.published?.[`${distance}_m`], paper),
  };
}

/**
 * The end of the axis of strips, so that they can be compared.
 * @param {{ setting: Setting, greedy: Setting | null }[]} rows
 */
export const endOfStrips = (rows) => 1.03 * largest(rows.flatMap(({ setting, greedy }) => {
  const { points, ...levels } = measured(setting, "total", greedy);
  return [...points, levels.greedy ?? 0, levels.best ?? 0, levels.printed ?? 0];
}), 1e-9);

/**
 * Every seed of a setting as a strip, with the interquartile mean and the paper's value.
 * @param {{ setting: Setting, distance: Distance, greedy: Setting | null, high: number, color?: string }} cell
 * @returns {Cell}
 */
export function stripCell({ setting, distance, greedy, high, color = agentOf(setting.agent).color }) {
  const { points, typical, ...levels } = measured(setting, distance, greedy);
  if (!typical) return WAITING;
  const interval = range(typical.low, typical.high);
  const marks = [
    { value: levels.greedy, kind: "greedy" }, { value: levels.best, kind: "best-known" },
    { value: levels.printed, kind: "published" },
  ].flatMap(({ value, kind }) => (value === null ? [] : [{ value, kind }]));
  const lowest = -largest(points.map((point) => -point), -Infinity);
  const label = [
    `${count(points.length, "seed")} from ${shown(lowest)} to ${shown(largest(points, -Infinity))}`,
    `typically ${shown(typical.iqm)}${interval && `, 95 % interval ${interval}`}`,
    levels.greedy !== null && `greedy ${shown(levels.greedy)}`,
    levels.best !== null && `best known ${shown(levels.best)}`,
    levels.printed !== null && `the paper ${shown(levels.printed)}`,
  ].filter(Boolean).join("; ");
  const points_m = setting.total?.points_m ?? [];
  return {
    text: shown(typical.iqm), isBold: true, note: interval, printed: printedWords(setting, distance, levels.printed),
    strip: {
      label, points, high, typical, marks, color, axis: shown,
      ...(distance === "total" ? { source: { setting, points_m } } : {}),
    },
  };
}

/**
 * A distance that is the same with every seed: agents that look ahead throw no dice.
 * @param {{ setting: Setting | null, distance: Distance, greedy: Setting | null }} cell
 * @returns {Cell}
 */
export function fixedCell({ setting, distance, greedy }) {
  if (!setting) return NONE;
  const { ours } = factorsOf(setting, greedy);
  const { printed } = measured(setting, distance, greedy);
  return {
    text: shown(inUnit(setting[distance]?.mean_m, ours)), isBold: true,
    printed: printedWords(setting, distance, printed),
  };
}

/**
 * The best known distance, which there is after 50 steps only.
 * @param {{ setting: Setting, distance: Distance, greedy: Setting | null }} cell
 * @returns {Cell}
 */
export const bestKnownCell = ({ setting, distance, greedy }) =>
  ({ text: shown(measured(setting, distance, greedy).best), isBold: true });

/** Whether a printed value is outside the central 95 % of the seeds. @param {number} quantile */
const isOutside = (quantile) => quantile < 0.025 || quantile > 0.975;

/**
 * The paper's value with its rank among the seeds; empty without one.
 * @param {Setting} setting
 * @param {Distance} distance
 * @param {number | null} value in the unit that is shown
 */
function printedWords({ role, published }, distance, value) {
  if (!published) return "";
  if (value === null) return published[`${distance}_m`] === null ? "paper: unfinished" : "";
  const quantile = role === "learner" ? published[`${distance}_quantile`] : null;
  const rank = quantile === null ? "" : `, above ${percentage(quantile)} of seeds${isOutside(quantile) ? " †" : ""}`;
  return `paper ${shown(value)}${rank}`;
}

// ---- distances, shares and steps with intervals

/**
 * A distance with its interval; `place` is where it was walked.
 * @param {{ iqm: number | null | undefined, low?: number | null, high?: number | null } | null} interval [m]
 * @param {{ half_side_m: number, greedy_m: number | null }} place
 * @returns {Cell}
 */
export function distanceCell(interval, place) {
  const factor = factorOf(place);
  const [iqm, low, high] = [interval?.iqm, interval?.low, interval?.high].map((value) => inUnit(value, factor));
  return iqm === null ? NONE : { text: shown(iqm), note: range(low, high) };
}

/**
 * The value of a curve at one of its evaluations, as an interval [m].
 * @param {ScoredCurve | null} curve
 * @param {number} evaluation
 */
export const atEvaluation = (curve, evaluation) =>
  curve && { iqm: curve.iqm_m[evaluation], low: curve.low_m[evaluation], high: curve.high_m[evaluation] };

/** @param {number} share */
const digitsOf = (share) => percentage(share).replace(/[^\d\u2212]/g, "");

/**
 * A share with its interval.
 * @param {Interval | PooledView["walkers"] | undefined} share
 * @returns {Cell}
 */
export function shareCell(share) {
  if (!share) return NONE;
  const { low, high } = share;
  const note = low === null || high === null ? "" : `${digitsOf(low)} – ${digitsOf(high)}`;
  return { text: percentage("iqm" in share ? share.iqm : share.share), note };
}

/** Steps until a share of a reference is reached. @param {Until | null} until @returns {Cell} */
export const untilCell = (until) => (until ? {
  text: until.median_steps === null ? "not reached" : whole(until.median_steps),
  note: `reached by ${percentage(until.reached)}`,
} : NONE);
