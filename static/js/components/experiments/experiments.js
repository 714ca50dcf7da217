// The experiments view: form and list on one side, the report on the other.
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
  const isOffline = connection.value === "reconnecting";
  return html`
    <div class=${`experiments ${isOffline ? "cut-off" : ""}`}>
      <div class="ask">
        ${isOperator.value && html`<${ExperimentForm} isFirst=${!run} />`}
        <${ExperimentList} />
      </div>
      <div class="answer">
        ${isOffline && html`<${OfflineNote} />`}
        ${run ? html`<${Report} key=${run.id} run=${run} />` : isListed.value && html`<${Invitation} />`}
      </div>
    </div>
  `;
}

const OfflineNote = () => html`
  <p class="cut-off-note" role="status">
    <span class="spinner" aria-hidden="true"></span>Reconnecting. This is the last known state.
  </p>
`;
