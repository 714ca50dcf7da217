// An experiment in the list of all runs, with a link to its report.
import { ago } from "../../format.js";
import { html } from "../../html.js";
import { paceOf } from "../../experiments/pace.js";
import { describeRun, runTitle } from "../../experiments/titles.js";

export const ExperimentRunRow = ({ run }) => html`
  <li class="run">
    <p class=${`state ${run.state}`}><span class="dot" aria-hidden="true"></span>${run.state}</p>
    <div class="what">
      <p><b>${runTitle(run)}</b></p>
      <p class="dim">${describeRun(run)}</p>
      ${run.error && html`<p class="bad">${run.error}</p>`}
    </div>
    <p class="outcome num dim">${paceOf(run).label}</p>
    <p class="when dim"><time datetime=${run.created_at}>${ago(run.created_at)}</time></p>
    <div class="run-actions">
      <a class="to-report" href=${`#experiments?run=${encodeURIComponent(run.id)}`}>Report</a>
    </div>
  </li>
`;
