// How far the robots of a class walked, each a dot: all that is revealed of a card that asks nothing.
import { html } from "../../../../js/components/elements.js";
import { count, fixed, metres } from "../../../../js/format.js";
import { BySetting } from "./by-setting.js";
import { DotPlot } from "./plot.js";

/** @import { CardResults, Classroom } from "../../../../js/types.js" */
/** @import { Act, Facts } from "./index.js" */
/** @import { DotRow } from "./plot.js" */

/** What the dots are. @param {Classroom} classroom @param {number} number */
const dotsInWords = ({ shown }, number) =>
  (shown.go === "what-if" ? `${count(number, "setting")} of thirty robots each` : count(number, "robot"));

/** The row of distances; null without one. */
/** @type {(classroom: Classroom, results: CardResults | null) => DotRow | null} */
export function walkedRow(classroom, results) {
  const { distances_m = [], interval = null } = results ?? {};
  if (distances_m.length === 0) return null;
  const range = interval && interval.low_m !== null
    ? ` (95\u00a0%: ${fixed(interval.low_m, 2)} to ${metres(interval.high_m)})` : "";
  return {
    title: `${dotsInWords(classroom, distances_m.length)}, typically ${metres(interval?.iqm_m)}${range}`,
    kind: "walked",
    values: distances_m,
    typical: interval && { iqm: interval.iqm_m, low: interval.low_m, high: interval.high_m },
  };
}

/** @param {Facts} props */
export function Distances({ classroom, results }) {
  const row = walkedRow(classroom, results);
  return row && html`<${DotPlot} rows=${[row]} format=${metres} />`;
}

/** @type {Act} */
export const DISTANCES = {
  name: "distances",
  isOn: ({ isRevealed, results }) => isRevealed && (results?.distances_m ?? []).length > 0,
  Show: (facts) => html`<${Distances} ...${facts} /><${BySetting} ...${facts} />`,
};
