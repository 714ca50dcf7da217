// The presses of a class as a strip: a bar up for each who pressed + for a step, down for each who pressed −.
import { html } from "../../../js/components/elements.js";
import { t } from "../../../js/format.js";
import { countsOf } from "./teaching.js";

/** @import { StepPresses } from "../../../js/types.js" */

const HEIGHT = 40;

/**
 * @param {object} props
 * @param {StepPresses[]} props.presses
 * @param {number} props.first number of the first step that is shown
 * @param {number} props.steps how many are
 * @param {Record<number, number>} [props.own] what was pressed on this page, by step
 */
export function PressStrip({ presses, first, steps, own = {} }) {
  const shown = presses.filter(({ step }) => step >= first && step < first + steps);
  const most = Math.max(1, ...shown.map(({ plus, minus }) => Math.max(plus, minus)));
  const { praised, rebuked } = countsOf(shown);
  const bar = (/** @type {number} */ number) => (number / most) * (HEIGHT / 2 - 2);
  const ownSteps = Object.entries(own).map(([step, value]) => ({ step: Number(step), value }))
    .filter(({ step }) => step >= first && step < first + steps);
  return html`
    <svg class="press-strip" viewBox=${`0 0 ${steps} ${HEIGHT}`} preserveAspectRatio="none" role="img"
      aria-label=${t("Of the class: {praised} {praised|step|steps} praised, {rebuked} rebuked", { praised, rebuked })}>
      <line x1="0" x2=${steps} y1=${HEIGHT / 2} y2=${HEIGHT / 2} />
      ${shown.map(({ step, plus, minus }) => html`
        <g key=${step} transform=${`translate(${step - first + 0.12} ${HEIGHT / 2})`}>
          <rect class="plus" width="0.76" y=${-bar(plus)} height=${bar(plus)} />
          <rect class="minus" width="0.76" height=${bar(minus)} />
        </g>
      `)}
      ${ownSteps.map(({ step, value }) => html`
        <rect key=${`own ${step}`} class="own" x=${step - first + 0.12} width="0.76" height="2"
          y=${value > 0 ? 0 : HEIGHT - 2} />
      `)}
    </svg>
  `;
}
