// Charts of distance against practice, one for each gait: the interquartile mean of each agent with its interval, and
// the walks of references.
import { distanceAxis, factorOf, inUnit, shown, stepsAxis } from "./distances.js";
import { count, percentage, whole } from "../../js/format.js";
import { agentOf } from "../../js/settings.js";
import { agentTitle, gaitTitle, planningModelTitle } from "../../js/titles.js";

/** @import { Line, Mark } from "../../js/chart.js" */
/** @import { CurveOfSetting, ScoredCurve, Summary, WorldView } from "../../js/types.js" */

/** @typedef {{ name: string, kind: string, value: number }} Level a reference's walk in the unit that is shown */
/**
 * @typedef {object} CurveChart
 * @property {string} title of its gait
 * @property {string} note what came of it
 * @property {string} label what it shows, in a sentence
 * @property {Line[]} lines
 * @property {Mark[]} marks
 * @property {number[]} xs
 * @property {ReturnType<typeof stepsAxis>} x
 * @property {ReturnType<typeof distanceAxis>} y
 */
/**
 * A learning curve with where it was walked, and what it is compared with.
 * @typedef {Pick<WorldView, "agent" | "gait" | "n" | "half_side_m" | "greedy_m" | "best_known_m">
 *   & Pick<ScoredCurve, "steps" | "iqm_m" | "low_m" | "high_m">
 *   & { name: string, greedy_nominal_m: number | null, seeds_m: number[][], walkers: (number | null)[],
 *     isInOneGo: boolean }} LearningCurve
 */

/** Dashes of a practice in one go [px]. */
const DOTTED = [2, 3];
const NOMINAL = "nominal";

/** @type {["greedy_m" | "greedy_nominal_m" | "best_known_m", string, () => string][]} */
const REFERENCES = [
  ["greedy_m", "greedy", () => "Greedy"],
  ["greedy_nominal_m", "nominal", () => `Greedy, ${planningModelTitle(NOMINAL)}`],
  ["best_known_m", "best-known", () => "Best known"],
];

/**
 * The walks of references that are known, in the unit that is shown.
 * @param {Pick<WorldView, "half_side_m" | "greedy_m" | "best_known_m"> & { greedy_nominal_m?: number | null }} entry
 * @returns {Level[]}
 */
export const levelsOf = (entry) => REFERENCES.flatMap(([field, kind, name]) => {
  const value = inUnit(entry[field], factorOf(entry));
  return value === null ? [] : [{ kind, name: name(), value }];
});

/**
 * The name of an entry: of one agent several, if the experiment practises for several numbers of steps.
 * @param {WorldView} entry
 * @param {Summary} summary
 */
export const nameOf = ({ agent, plans_with, steps, role }, { config }) => [
  agentTitle(agent), plans_with && planningModelTitle(plans_with),
  role === "learner" && config.steps.length > 1 && count(steps, "step"),
].filter(Boolean).join(", ");

/** A practice in blocks, or in one go beside it. @param {CurveOfSetting} curve @returns {LearningCurve} */
export const blocksCurve = (curve) => {
  const isInOneGo = curve.blocks === 1;
  return {
    ...curve, best_known_m: curve.best_known_m ?? null, greedy_nominal_m: null, isInOneGo,
    name: `${agentTitle(curve.agent)}${isInOneGo ? ", in one go" : ""}`,
    n: curve.points_m[0]?.length ?? 0,
    // Those of the blocks are enough to see how far seeds lie apart.
    seeds_m: isInOneGo ? [] : curve.points_m,
  };
};

/**
 * The practice of a learner in a world; none of an agent that looks ahead.
 * @param {WorldView} entry
 * @param {Summary} summary
 * @returns {LearningCurve[]}
 */
export const worldCurve = (entry, summary) => (entry.curve
  ? [{ ...entry, ...entry.curve, name: nameOf(entry, summary), seeds_m: [], walkers: [], isInOneGo: false }] : []);

/** @param {LearningCurve} curve @returns {Line} */
function lineOf(curve) {
  const factor = factorOf(curve);
  /** @param {(number | null)[]} values */
  const converted = (values) => values.map((value) => inUnit(value, factor));
  return {
    name: curve.name, color: agentOf(curve.agent).color, xs: curve.steps,
    ys: converted(curve.iqm_m), low: converted(curve.low_m), high: converted(curve.high_m),
    seeds: curve.seeds_m.map(converted), dots: !curve.isInOneGo, dash: curve.isInOneGo ? DOTTED : [],
  };
}

/**
 * The lines of references. A single one is captioned; of several a key stands over the charts.
 * @param {Level[]} levels
 * @returns {Mark[]}
 */
const marksOf = (levels) => levels.map(({ name, kind, value }) => ({
  name, kind, y: value, ink: "--ink", text: levels.length > 1 ? "" : name.toLowerCase(),
}));

/**
 * A chart for each gait, all with the same axes.
 * @param {LearningCurve[]} curves
 * @param {Summary["config"]} config
 * @param {string} steps what the steps are
 * @returns {CurveChart[]}
 */
export function curveCharts(curves, config, steps) {
  const gaits = [...new Set(curves.map(({ gait }) => gait))];
  const charts = gaits.map((gait) => {
    const inGait = curves.filter((curve) => curve.gait === gait);
    const [lines, levels] = [inGait.map(lineOf), levelsOf(inGait[0])];
    const ends = lines.map(({ name, xs, ys }) => `${name} ${shown(ys.at(-1))} after ${count(xs.at(-1) ?? 0, "step")}`);
    const walks = levels.map(({ name, value }) => `; ${name.toLowerCase()} ${shown(value)}`);
    const title = gaitTitle(gait);
    return {
      title, note: noteOf(inGait, lines), label: `${title}: ${ends.join(", ")}${walks.join("")}`,
      lines, marks: marksOf(levels), xs: [...new Set(lines.flatMap(({ xs }) => xs))].sort((a, b) => a - b),
    };
  });
  const axes = { x: stepsAxis(charts.flatMap(({ lines }) => lines), config, steps), y: distanceAxis(charts) };
  return charts.map((chart) => ({ ...chart, ...axes }));
}

/**
 * How far the curves come, and how many seeds walk in the end, where that was measured; the number of seeds.
 * @param {LearningCurve[]} curves
 * @param {Line[]} lines
 */
function noteOf(curves, lines) {
  const ends = curves.map(({ walkers, isInOneGo }, n) => {
    const share = curves.filter((curve) => !curve.isInOneGo).length === 1 ? walkers.at(-1) ?? null : null;
    if (isInOneGo) return `${shown(lines[n].ys.at(-1))} in one go`;
    return `${shown(lines[n].ys.at(-1))}${share === null ? "" : `, ${percentage(share)} walk`}`;
  });
  const numbers = curves.map(({ n }) => n);
  const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
  const seeds = least === most ? count(most, "seed") : `${whole(least)} to ${count(most, "seed")}`;
  return [...(curves.some(({ walkers }) => walkers.length) ? ends : []), seeds].join(" · ");
}
