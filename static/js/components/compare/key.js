// Number, colour and title of a compared run in charts and tables.
import { html } from "../elements.js";

/** @import { Compared } from "../../compare.js" */

/** Its line in the charts: colour and dashes. @param {{ one: Compared }} props */
export const Key = ({ one: { color, dash, letter } }) => html`
  <span class="run-key" style=${{ "--agent": color }}>
    <svg width="28" height="8" aria-hidden="true">
      <path d="M0 4H28" stroke-dasharray=${dash.length ? dash.join(" ") : undefined} />
    </svg>
    <b>${letter}</b>
  </span>
`;
