// An error, beside the control that caused it.
import { dismissProblem, problems } from "../actions.js";
import { html } from "../html.js";

export function Problem({ at }) {
  const error = problems.value[at];
  return html`
    <div role="alert">
      ${error && html`
        <p class="problem">
          <span>${error.message}</span>
          <button class="quiet square small" aria-label="Dismiss" onClick=${() => dismissProblem(at)}>✕</button>
        </p>
      `}
    </div>
  `;
}
