// A progress bar.
import { html } from "../html.js";

export const ProgressBar = ({ label, share }) => html`
  <div class="bar" role="progressbar" aria-label=${label} aria-valuemin="0" aria-valuemax="100"
    aria-valuenow=${Math.round(100 * share)}>
    <i style=${{ width: `${100 * share}%` }}></i>
  </div>
`;
