// The typical one of many learning curves, as the server scores drawn ones against it.

/** Share of the curves that an interquartile mean drops at each end. */
const TRIMMED = 0.25;

/** The interquartile mean at each step that all curves have. @param {number[][][]} curves of [step, distance in m] */
export function meanCurve(curves) {
  if (curves.length === 0) return [];
  const byStep = curves.map((curve) => new Map(curve.map(([step, y]) => [step, y])));
  const steps = [...byStep[0].keys()].filter((step) => byStep.every((curve) => curve.has(step)));
  return steps.sort((a, b) => a - b).map((step) => [step, trimmedMean(byStep.map((curve) => curve.get(step) ?? 0))]);
}

/** @param {number[]} values */
function trimmedMean(values) {
  const cut = Math.floor(TRIMMED * values.length);
  const middle = [...values].sort((a, b) => a - b).slice(cut, values.length - cut);
  return middle.reduce((total, value) => total + value, 0) / middle.length;
}
