// Scores of predictions in words, and the axes of dots.
import { distanceApart, percentage } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";

/** @import { Ask, ResultEntry } from "../../../js/types.js" */

const HEADROOM = 1.06;
const LEAST_M = 0.1;

/** The ends of an axis on which all values lie. @param {number[]} values */
export const axisOf = (values) => ({
  low: Math.min(0, ...values), high: HEADROOM * largest(values, LEAST_M),
});

/** The unit of a question in which a distance may be asked → how many are a metre. @type {Record<string, number>} */
const PER_METRE = { m: 1, cm: 100 };

/** An error in the unit of the question. @type {(error: number, unit: string | null | undefined) => string} */
function errorInWords(error, unit) {
  const per = PER_METRE[unit ?? "m"];
  return per ? distanceApart(error / per) : `${Number(error.toPrecision(3))}${unit ? ` ${unit}` : ""}`;
}

/**
 * What a prediction was worth, against all seeds.
 * @param {ResultEntry} entry with a score
 * @param {Ask} ask
 */
export function scoreInWords({ score, prediction }, ask) {
  const { is_right, share, quantile, error } = /** @type {NonNullable<ResultEntry["score"]>} */ (score);
  if (is_right !== null) {
    const off = error ? ` It is ${errorInWords(error, ask.unit ?? "")} off.` : "";
    return is_right ? "You were right." : `That was not it.${off}`;
  }
  if (share !== null) return `${agentOf(String(prediction)).title} won in ${percentage(share)} of all races.`;
  if (quantile !== null && error !== null) {
    const below = `${percentage(quantile)} of all robots went less far than you said`;
    return `${below}; you were ${errorInWords(error, ask.unit)} from the typical one.`;
  }
  if (error !== null) return `On average you were ${distanceApart(error)} from the typical curve.`;
  return "Your prediction is kept.";
}

/** Answers that were given, as the parts of a class: [answer, number], the choices of the question first. */
/** @type {(ask: Ask, values: unknown[]) => [string, number][]} */
export const tally = (ask, values) =>
  (ask.choices ?? []).map((choice) => [choice, values.filter((value) => value === choice).length]);

/** Predicted numbers in metres, where the question is one of distances; else null. */
/** @type {(ask: Ask | null, values: unknown[]) => number[] | null} */
export function predictedMetres(ask, values) {
  if (ask?.kind !== "number") return null;
  const per = PER_METRE[ask.unit ?? "m"];
  if (!per) return null;
  return values.flatMap((value) => (typeof value === "number" ? [value / per] : []));
}
