// A few choices side by side, of which one holds.
import { html } from "../html.js";

/** `choices`: [value, title, explanation?]. */
export const Segments = ({ label, choices, value, onValue }) => html`
  <div class="segments" role="group" aria-label=${label}>
    ${choices.map(([one, title, explained]) => html`
      <button key=${one} aria-pressed=${one === value ? "true" : "false"} title=${explained} onClick=${() => onValue(one)}>${title}</button>
    `)}
  </div>
`;
