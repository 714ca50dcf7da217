// What went wrong, beside the control that it is about.
import { dismissProblem, problems } from "../actions.js";
import { labelOf, messageOf } from "../titles.js";
import { html } from "./elements.js";

/** An error, beside the control that caused it. @param {{ at: string }} props */
export function Problem({ at }) {
  const error = problems.value[at];
  return html`
    <div role="alert">
      ${error && html`
        <p class="problem">
          <span>${messageOf(error)}</span>
          <button class="quiet square small" aria-label="Dismiss" onClick=${() => dismissProblem(at)}>✕</button>
        </p>
      `}
    </div>
  `;
}

/**
 * Why the button above is held: each field that is not valid, to go to, and what it must be.
 * @param {object} props
 * @param {string} props.id
 * @param {Record<string, string>} props.mistakes
 * @param {(field: string) => unknown} props.onField
 * @param {(field: string) => string} [props.nameOf]
 */
export const Held = ({ id, mistakes, onField, nameOf = labelOf }) => html`
  <ul class="held" id=${id}>
    ${Object.entries(mistakes).map(([field, mistake]) => html`
      <li key=${field}>
        <button class="link" onClick=${() => onField(field)}>${nameOf(field)}</button>: ${mistake}
      </li>
    `)}
  </ul>
`;
