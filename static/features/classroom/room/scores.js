// The axes of dots, and the units of questions.
import { decimal, distanceApart } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";

const HEADROOM = 1.06;
const LEAST_M = 0.1;

/** The ends of an axis on which all values lie. @param {number[]} values */
export const axisOf = (values) => ({
  low: Math.min(0, ...values), high: HEADROOM * largest(values, LEAST_M),
});

/** The unit of a question in which a distance may be asked → how many are a metre. @type {Record<string, number>} */
export const PER_METRE = { m: 1, cm: 100 };

/** An error in the unit of the question. @type {(error: number, unit: string | null | undefined) => string} */
export function errorInWords(error, unit) {
  const per = PER_METRE[unit ?? "m"];
  return per ? distanceApart(error / per) : `${decimal(Number(error.toPrecision(3)))}${unit ? ` ${unit}` : ""}`;
}
