// The paper's experiments, many times over: ask for one, watch its report fill, take it away.
import { html } from "../../html.js";
import { isOperator } from "../../selectors.js";
import { connection } from "../../store.js";
import { chosenRun, isListed } from "../../experiments/selection.js";
import { ExperimentForm } from "./experiment-form.js";
import { ExperimentList } from "./experiment-list.js";
import { Invitation } from "./invitation.js";
import { Report } from "./report.js";

export function Experiments() {
  const run = chosenRun.value;
  return html`
    <div class=${`experiments ${connection.value === "reconnecting" ? "cut-off" : ""}`}>
      <div class="ask">
        ${isOperator.value && html`<${ExperimentForm} isFirst=${!run} />`}
        <${ExperimentList} />
      </div>
      <div class="answer">
        ${connection.value === "reconnecting" && html`<p class="cut-off-note" role="status"><span class="spinner" aria-hidden="true"></span>Reconnecting. This is what was known.</p>`}
        ${run ? html`<${Report} key=${run.id} run=${run} />` : isListed.value && html`<${Invitation} />`}
      </div>
    </div>
  `;
}
