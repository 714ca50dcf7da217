// A run that the server cannot read: what is known of it, the reason, and its deletion.
import { useState } from "preact/hooks";
import { deleteRun, pending } from "../actions.js";
import { ago } from "../format.js";
import { html } from "../html.js";
import { isOperator } from "../selectors.js";
import { Problem } from "./problem.js";

export const DamagedRunRow = ({ run }) => html`
  <li class="run">
    <p class="state failed"><span class="dot" aria-hidden="true"></span>damaged</p>
    <div class="what">
      <p><b>${run.name || `A ${run.kind ?? "run"} that cannot be read`}</b> <span class="dim">${run.id}</span></p>
      <p class="bad">${run.damaged}</p>
    </div>
    <p class="outcome num"></p>
    <p class="when dim">${run.created_at && html`<time datetime=${run.created_at}>${ago(run.created_at)}</time>`}</p>
    <div class="run-actions">${isOperator.value && html`<${DeleteButton} run=${run} />`}</div>
    <${Problem} at=${run.id} />
  </li>
`;

function DeleteButton({ run }) {
  const [isSure, setSure] = useState(false);
  const onClick = () => (isSure ? deleteRun(run) : setSure(true));
  return html`
    <button class="secondary compact bad" disabled=${pending.value[run.id]} onClick=${onClick}>
      ${isSure ? "Delete for good?" : "Delete"}
    </button>
  `;
}
