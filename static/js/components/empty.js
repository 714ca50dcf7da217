// A panel that waits for its first number.
import { html } from "../html.js";

export const Empty = ({ words }) => html`
  <div class="empty">
    <svg viewBox="0 0 320 120" preserveAspectRatio="none" aria-hidden="true">
      <path class="rule" d="M0 118H320M0 78H320M0 38H320" /><path class="sketch" d="M0 116C60 104 80 66 140 56S230 34 320 30" />
    </svg>
    <p>${words}</p>
  </div>
`;
