// One step explained: the move, what it was worth, why it was made, and the update of the values.
import { useEffect } from "preact/hooks";
import { sentence, t } from "../../../js/format.js";
import { moveTold } from "../../../js/headline.js";
import { agentOf } from "../../../js/settings.js";
import { explanation, isFollowing, moment, moveInWords } from "../steps.js";
import { isAtLeast } from "../../../js/workspace.js";
import { html } from "../../../js/components/elements.js";
import { ActionValues, valuesOf } from "./action-values.js";
import { ExplainedStep, Reasons } from "./explanation.js";
import { WhyLost } from "./loss.js";
import { Navigator, Trouble, useMoment, Waiting } from "./navigator.js";

/** @import { Moment } from "../steps.js" */
/** @import { Explanation } from "../../../js/types.js" */

export function Why() {
  useMoment();
  const at = moment.value;
  const step = toldAbout(at);
  useEffect(() => {
    moveTold.value = step ? wordsOf(step)
      : at && { title: t("Step {step}", { step: at.step }), reason: "", color: "transparent" };
  }, [step, at?.step]);
  useEffect(() => () => (moveTold.value = null), []);
  if (!at) return html`<p class="dim">Once a run is on the stage, each of its steps is explained here.</p>`;
  const { error, again } = explanation.value;
  const hasGrid = isFollowing.value && isAtLeast("study") && valuesOf(at.lane) !== null;
  return html`
    <section class="why-tab" aria-label="Explanation" aria-busy=${step && step.step !== at.step ? "true" : "false"}>
      <${Navigator} at=${at} />
      <${WhyLost} />
      <${Trouble} error=${error} again=${again} />
      ${at.step === 0 && html`<p class="dim">It stands on the start line. Its first step comes next.</p>`}
      ${step && html`<${Reasons} told=${step} />`}
      ${hasGrid && html`<${ActionValues} lane=${at.lane} />`}
      ${step && html`<${ExplainedStep} told=${step} isFull=${isAtLeast("study")} isRanked=${!hasGrid} />`}
      ${!step && !error && at.step > 0 && html`<${Waiting} />`}
    </section>
  `;
}

/**
 * The explanation that can be shown of a moment's lane: of its step, or while that is on its way of the one before.
 * @param {Moment | null} at
 * @returns {Explanation | null}
 */
function toldAbout(at) {
  const { answer, error, again } = explanation.value;
  if (!at || !answer || (error && !again)) return null;
  return answer.run_id === at.run_id && (answer.lane ?? 0) === at.lane ? answer : null;
}

/** What it brought is told in the head, or on a phone above. @param {Explanation} step */
const wordsOf = (step) => ({
  title: sentence(moveInWords(step.action, step)), reason: step.what, color: agentOf(step.agent).color,
});
