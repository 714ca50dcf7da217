// The way from trainings to the experiment that repeats them.
import { html } from "../../../js/components/elements.js";
import { isOperator } from "../../../js/selectors.js";
import { repeatAddress } from "../repeat.js";

/** @import { AnyRun } from "../../../js/runs.js" */

/** @param {{ runs: AnyRun[] }} props */
export function RepeatLink({ runs }) {
  const address = isOperator.value ? repeatAddress(runs) : null;
  return address && html`
    <a class="secondary button" href=${address} title="As an experiment: how much of it is chance">Repeat, 12 seeds</a>
  `;
}
