// A choice of one out of a few, side by side.
import { html } from "../html.js";

/** `choices`: [value, title]. */
export const Segments = ({ label, choices, value, onValue }) => html`
  <div class="segments" role="group" aria-label=${label}>
    ${choices.map(([one, title]) => html`
      <button key=${one} aria-pressed=${one === value ? "true" : "false"} onClick=${() => onValue(one)}>
        ${title}
      </button>
    `)}
  </div>
`;
