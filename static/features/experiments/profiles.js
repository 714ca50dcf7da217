// Two settings side by side: which can be chosen, and their performance profiles as lines of a chart.
import { metres } from "../../js/format.js";
import { largest } from "../../js/scale.js";
import { agentOf } from "../../js/settings.js";

/** @import { Line } from "../../js/chart.js" */
/** @import { Setting, Summary } from "../../js/types.js" */

/** Dashes of the second profile [px]: lines differ without colour too. */
const DASHED = [6, 3];
const MARGIN = 1.03;

/** The settings that can be compared: those with a distance. @param {Summary} summary */
export const comparable = ({ settings }) => settings.filter(({ total }) => total !== null);

/**
 * The first two learners; of one learner it and what it is compared with.
 * @param {Setting[]} settings
 * @returns {[string, string]}
 */
export function firstPair(settings) {
  const learners = settings.filter(({ role }) => role === "learner");
  const [a, b] = learners.length > 1 ? learners : [...learners, ...settings.filter((one) => !learners.includes(one))];
  return [a?.key ?? "", b?.key ?? ""];
}

/** The points of a setting. @param {Setting} setting */
const pointsOf = ({ total }) => total?.points_m ?? [];

/**
 * The performance profile of a setting: of its seeds the share that comes at least as far as each distance, in steps.
 * @param {Setting} setting
 * @param {Summary} summary
 * @param {{ name: string, from: number, to: number, isSecond: boolean, color: string }} look
 * @returns {Line}
 */
export function profileLine(setting, summary, { name, from, to, isSecond, color }) {
  const points = [...pointsOf(setting)].sort((a, b) => a - b);
  const n = points.length;
  const limits = setting.is_deterministic ? undefined : summary.share_limits?.find(({ seeds }) => seeds === n);
  const at = [...new Set(points)];
  const reaching = at.map((distance) => points.filter((point) => point >= distance).length);
  // Twice at each step: before it, and after it.
  const xs = [from, ...at.flatMap((distance) => [distance, distance]), to];
  const hits = [n, ...reaching.flatMap((number, step) => [number, reaching[step + 1] ?? 0]), 0];
  return {
    name, color, xs, ys: hits.map((number) => number / n),
    at: (x) => points.filter((point) => point >= x).length / n,
    low: limits && hits.map((number) => limits.low[number]),
    high: limits && hits.map((number) => limits.high[number]),
    dash: isSecond ? DASHED : [],
  };
}

/**
 * The profiles of two settings as a chart.
 * @param {[Setting, Setting]} pair
 * @param {[string, string]} names
 * @param {Summary} summary
 */
export function profileChart(pair, names, summary) {
  const points = pair.flatMap(pointsOf);
  const [from, to] = [-largest(points.map((point) => -point), 0), MARGIN * largest(points, 1e-9)];
  const [first, second] = pair.map(({ agent }) => agentOf(agent).color);
  const lines = pair.map((setting, place) => profileLine(setting, summary, {
    name: names[place], from, to, isSecond: place === 1,
    color: place === 1 && second === first ? "var(--dim)" : [first, second][place],
  }));
  return {
    lines, xs: [...new Set(points)].sort((a, b) => a - b),
    x: { axis: `profile ${pair.map(({ key }) => key).join(" ")}`, min: from, max: to, unit: "distance in 50 steps, m",
      text: metres },
    y: { min: 0, max: 1, unit: "share", title: "share of seeds that come at least so far", text: shareText },
    label: `Performance profiles: of ${names.join(" and of ")} the share of seeds that come at least as far as each ` +
      "distance",
  };
}

/** @type {(share: number) => string} */
const shareText = (share) => share.toFixed(2);
