// The choice of the learner, and which one the body suggests.
import { chooseLearner, form, isReadOnly, learnerIsChosen } from "../form.js";
import { preview } from "../preview.js";
import { agentOf, isAllowed, isClosed, learners } from "../settings.js";
import { isAtLeast } from "../workspace.js";
import { html } from "./elements.js";
import { SelectField } from "./fields.js";

export const Learner = () => html`
  <${SelectField} field="agent" label="Learner" onValue=${chooseLearner} words=${agentOf(form.value.agent).description}
    choices=${learners.value.map(({ name, title }) => [name, title])} />
  <${Recommended} />
`;

/** The learner that is recommended for the body, and why. Those who try are told of bodies that tip. */
function Recommended() {
  const { answer } = preview.value;
  if (!answer || isReadOnly.value || isClosed("agent") || !isAllowed("agent", answer.recommended_agent)) return null;
  if (!answer.tips && !isAtLeast("study")) return null;
  const { recommended_agent, recommended_because } = answer;
  const isTaken = form.value.agent === recommended_agent;
  const { title } = agentOf(recommended_agent);
  return html`
    <p class=${answer.tips ? "notice" : "dim"} role="status">
      <b>${isTaken && !learnerIsChosen.value ? `${title} is offered` : `${title} is recommended`} for this body.</b>
      ${" "}${recommended_because}
      ${!isTaken && html`${" "}
        <button type="button" class="link" onClick=${() => chooseLearner(recommended_agent)}>Take it</button>
      `}
    </p>
  `;
}
