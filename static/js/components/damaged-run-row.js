// A run that the server cannot read: what is known of it, why, and a way to be rid of it.
import { useState } from "preact/hooks";
import { pending, remove } from "../actions.js";
import { ago } from "../format.js";
import { html } from "../html.js";
import { isOperator } from "../selectors.js";
import { Problem } from "./problem.js";

export function DamagedRunRow({ run }) {
  const [isSure, setSure] = useState(false);
  return html`
    <li class="run">
      <p class="state failed"><span class="dot" aria-hidden="true"></span>damaged</p>
      <div class="what">
        <p><b>${run.name || `A ${run.kind ?? "run"} that cannot be read`}</b> <span class="dim">${run.id}</span></p>
        <p class="bad">${run.damaged}</p>
      </div>
      <p class="came num"></p>
      <p class="when dim">${run.created_at && html`<time datetime=${run.created_at}>${ago(run.created_at)}</time>`}</p>
      <div class="run-deeds">
        ${isOperator.value && html`
          <button class="secondary compact bad" disabled=${pending.value[run.id]} onClick=${() => (isSure ? remove(run) : setSure(true))}>
            ${isSure ? "Delete for good?" : "Delete"}
          </button>
        `}
      </div>
      <${Problem} at=${run.id} />
    </li>
  `;
}
