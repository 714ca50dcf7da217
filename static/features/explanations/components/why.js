// One step explained: the move, what it was worth, why it was made, and the update of the values.
import { useEffect } from "preact/hooks";
import { sentence, whole } from "../../../js/format.js";
import { moveTold } from "../../../js/headline.js";
import { agentOf } from "../../../js/settings.js";
import { explanation, fineMillimetres, isFollowing, moment, moveInWords } from "../steps.js";
import { isAtLeast } from "../../../js/workspace.js";
import { html } from "../../../js/components/elements.js";
import { ActionValues } from "./action-values.js";
import { ExplainedStep } from "./explanation.js";
import { WhyLost } from "./loss.js";
import { Navigator, Trouble, useMoment, Waiting } from "./navigator.js";

/** @import { Moment } from "../steps.js" */
/** @import { Explanation } from "../../../js/types.js" */

export function Why() {
  useMoment();
  const at = moment.value;
  const step = toldAbout(at);
  useEffect(() => {
    moveTold.value = step ? wordsOf(step) : at && { title: `Step ${whole(at.step)}`, reason: "", color: "transparent" };
  }, [step, at?.step]);
  useEffect(() => () => (moveTold.value = null), []);
  if (!at) return html`<p class="dim">Once a run is on the stage, each of its steps is explained here.</p>`;
  const { error, again } = explanation.value;
  return html`
    <section class="why-tab" aria-label="Explanation" aria-busy=${step && step.step !== at.step ? "true" : "false"}>
      <${Navigator} at=${at} />
      <${WhyLost} />
      <${Trouble} error=${error} again=${again} />
      ${at.step === 0 && html`<p class="dim">It stands on the start line. Its first step comes next.</p>`}
      ${isFollowing.value && isAtLeast("study") && html`<${ActionValues} />`}
      ${step && html`<${ExplainedStep} told=${step} isFull=${isAtLeast("study")} />`}
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

/** @param {Explanation} step */
const wordsOf = (step) => ({
  title: sentence(moveInWords(step.action, step)), reason: reasonOf(step), color: agentOf(step.agent).color,
});

/** What the step brought, and what the move is worth since. @param {Explanation} told */
function reasonOf({ reward_m, update }) {
  const went = `The step brought ${fineMillimetres(reward_m)}`;
  const direct = update?.direct;
  if (!direct) return `${went}.`;
  const [before, after] = [direct.before, direct.after].map(fineMillimetres);
  if (before === after) return `${went}: the value of the move stays ${after}.`;
  const verb = direct.after > direct.before ? "rises" : "falls";
  return `${went}: the value of the move ${verb} from ${before} to ${after}.`;
}
