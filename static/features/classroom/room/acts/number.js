// The reveal of a number: all answers as dots, over the distances of all robots or with the right answer.
import { html } from "../../../../js/components/elements.js";
import { count, metres, whole } from "../../../../js/format.js";
import { PER_METRE } from "../scores.js";
import { BySetting } from "./by-setting.js";
import { Distances, walkedRow } from "./distances.js";
import { DotPlot } from "./plot.js";
import { isRevealOf, predictionsOf } from "./predictions.js";

/** @import { Ask } from "../../../../js/types.js" */
/** @import { Act, Facts } from "./index.js" */

/** A number of a question that is no distance. @param {number} value */
const plain = (value) => (Number.isInteger(value) ? whole(value) : `${Number(value.toPrecision(4))}`);

/** @param {Facts} facts */
function Reveal(facts) {
  const { classroom, results } = facts;
  const { unit } = /** @type {Ask} */ (classroom.shown.ask);
  const right = typeof results?.answer === "number" ? results.answer : null;
  const walked = walkedRow(classroom, results);
  const per = PER_METRE[unit ?? "m"];
  const isDistance = Boolean(per) && (unit || walked !== null);
  const scale = isDistance ? per : 1;
  const format = isDistance ? metres : (/** @type {number} */ value) => [plain(value), unit].filter(Boolean).join(" ");
  const values = predictionsOf(results).map((value) => value / scale);
  const isCompared = isDistance && right === null && walked !== null;
  return html`
    <${DotPlot} format=${format}
      rows=${[
        { title: `${count(values.length, "prediction")}`, kind: "predicted", values },
        ...(isCompared ? [walked] : []),
      ]}
      right=${right === null ? null : { value: right / scale, label: `right: ${format(right / scale)}` }} />
    ${!isCompared && walked && html`<${Distances} ...${facts} />`}
    <${BySetting} ...${facts} />
  `;
}

/** @type {Act} */
export const NUMBER = { name: "number", isOn: isRevealOf("number"), Show: Reveal };
