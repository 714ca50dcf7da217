// Distances of a report: grouped by the place in which agents are compared, and in the chosen unit.
import { signal } from "@preact/signals";
import { count, metres, THIN_SPACE } from "../../js/format.js";
import { largest } from "../../js/scale.js";

/** @import { Line, Mark } from "../../js/chart.js" */
/** @import { Place, Setting, Summary } from "../../js/types.js" */

// ---- places: observation, robot and foot grid

/** @param {Omit<Place, "key" | "half_side_m">} setting */
export const placeOf = ({ observation, robot, divisions, grid_side_m }) =>
  [observation, robot, divisions, grid_side_m].join("/");

/** @param {Setting} setting */
const pairOf = (setting) => `${setting.gait} in ${placeOf(setting)}`;

/**
 * The places of an experiment, in its order.
 * @param {Omit<Place, "key">[]} settings
 * @returns {Place[]}
 */
export function placesOf(settings) {
  /** @type {Map<string, Place>} */
  const places = new Map();
  for (const setting of settings) {
    const { observation, robot, divisions, grid_side_m, half_side_m } = setting;
    const key = placeOf(setting);
    if (!places.has(key)) places.set(key, { key, observation, robot, divisions, grid_side_m, half_side_m });
  }
  return [...places.values()];
}

/**
 * Each gait of a place with its learners and references, in the order of the experiment.
 * @param {Setting[]} settings
 * @param {string} place
 */
export function gaitsOf(settings, place) {
  const here = settings.filter((setting) => placeOf(setting) === place);
  return [...new Set(here.map(({ gait }) => gait))].map((gait) => {
    const inGait = here.filter((setting) => setting.gait === gait);
    const references = inGait.filter(({ role }) => role === "reference");
    return {
      gait,
      learners: inGait.filter(({ role }) => role === "learner"),
      references: Object.fromEntries(references.map((setting) => [setting.agent, setting])),
    };
  });
}

/**
 * A function from a setting to greedy for the same gait in the same place; null before it has walked.
 * @param {Setting[]} settings
 * @returns {(setting: Setting) => Setting | null}
 */
export function greedyIn(settings) {
  const references = settings.filter(({ role, agent, total }) => role === "reference" && agent === "greedy" && total);
  const byPlace = new Map(references.map((setting) => [pairOf(setting), setting]));
  return (setting) => byPlace.get(pairOf(setting)) ?? null;
}

// ---- units: metres, half grid sides, or shares of greedy's distance

const MINUS = "\u2212";

/** @type {[string, string][]} */
export const UNITS = [["m", "metres"], ["h", "half grid sides"], ["greedy", "relative to greedy"]];
export const unit = signal("m");

/**
 * The factor from metres to the chosen unit; null where its reference is unknown.
 * @param {{ half_side_m: number, greedy_m: number | null }} reference
 */
export function factorOf({ half_side_m, greedy_m }) {
  if (unit.value === "m") return 1;
  const length = unit.value === "h" ? half_side_m : greedy_m;
  return length ? 1 / length : null;
}

/**
 * A number of the chosen unit with its sign: "0.38 m", "19.1 h", "76 %".
 * @param {number | null | undefined} value
 */
export function shown(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (unit.value === "m") return metres(value);
  const rounded = unit.value === "h" ? value.toFixed(1) : (100 * value).toFixed(0);
  return `${rounded.replace("-", MINUS)}${THIN_SPACE}${unit.value === "h" ? "h" : "%"}`;
}

/**
 * The same without the unit, for the ends of an interval.
 * @param {number | null | undefined} value
 */
export const bare = (value) => shown(value).replace(/[^\d.−–].*$/u, "");

/** @type {(value: number | null | undefined, factor: number | null) => number | null} */
export const inUnit = (value, factor) =>
  value === null || value === undefined || factor === null ? null : value * factor;

/** Labels of an axis. @type {Record<string, string>} */
export const UNIT_NAMES = {
  m: "metres in 50 steps",
  h: "half grid sides in 50 steps",
  greedy: "share of greedy’s distance",
};

/** Titles of an axis: its name and unit. @type {Record<string, string>} */
export const AXIS_TITLES = {
  m: "distance in 50 steps, m",
  h: "distance in 50 steps, half grid sides",
  greedy: "distance as a share of greedy’s",
};

// ---- axes of charts of distance against steps, in the unit that is shown; all of a report are read together

const HEADROOM = 1.06;
const MIN_TOP = 1e-9;

/**
 * @param {Line[]} lines of all charts
 * @param {Summary["config"]} config of the experiment, whose charts are zoomed together
 * @param {string} words what the steps are
 */
export const stepsAxis = (lines, config, words = "steps of practice") => ({
  axis: `report ${JSON.stringify(config)}`, max: largest(lines.flatMap(({ xs }) => xs), 1), unit: words,
  text: (/** @type {number} */ steps) => count(steps, "step"),
});

/** @param {{ lines: Line[], marks: Mark[] }[]} charts with one axis */
export function distanceAxis(charts) {
  const values = charts.flatMap(({ lines, marks }) => [
    ...lines.flatMap(({ ys, low = [], high = [], seeds = [] }) => [...ys, ...low, ...high, ...seeds.flat()]),
    ...marks.map(({ y }) => y),
  ]).filter((value) => typeof value === "number");
  return {
    min: -largest(values.map((value) => -value), 0), max: HEADROOM * largest(values, MIN_TOP),
    unit: UNIT_NAMES[unit.value], title: AXIS_TITLES[unit.value], text: shown,
  };
}
