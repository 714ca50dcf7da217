// The list of experiments with their progress and links to their reports.
import { ago } from "../../format.js";
import { html } from "../../html.js";
import { isActive } from "../../selectors.js";
import { wantedRun } from "../../experiments/address.js";
import { paceOf } from "../../experiments/pace.js";
import { chosenRun, experimentRuns, hasOlder, loadOlder } from "../../experiments/selection.js";
import { describeRun, runTitle } from "../../experiments/titles.js";
import { ProgressBar } from "../progress-bar.js";

export function ExperimentList() {
  const all = experimentRuns.value;
  if (!all.length) return null;
  return html`
    <section class="panel experiment-list" aria-labelledby="experiment-list">
      <h2 id="experiment-list">Experiments</h2>
      <ul>${all.map((run) => html`<${Row} key=${run.id} run=${run} />`)}</ul>
      ${hasOlder.value && html`<${Older} />`}
    </section>
  `;
}

const Older = () => html`
  <div class="older"><button class="secondary" onClick=${loadOlder}>Show older experiments</button></div>
`;

function Row({ run }) {
  const isChosen = chosenRun.value?.id === run.id;
  const pace = paceOf(run);
  const choose = (event) => {
    event.preventDefault();
    wantedRun.value = run.id;
  };
  return html`
    <li>
      <a class="experiment-row" href=${`#experiments?run=${encodeURIComponent(run.id)}`}
        aria-current=${isChosen ? "true" : undefined} onClick=${choose}>
        <span class="row-title">
          <b>${runTitle(run)}</b> <time class="dim" datetime=${run.created_at}>${ago(run.created_at)}</time>
        </span>
        <span class="dim about">${describeRun(run)}</span>
        <span class="row-state">
          <span class=${`state ${run.state}`}><span class="dot" aria-hidden="true"></span>${run.state}</span>
          <span class="dim num">${run.state === "finished" ? "" : pace.label}</span>
        </span>
        ${isActive(run) && html`<${ProgressBar} label=${runTitle(run)} share=${pace.share} />`}
        ${pace.left && html`<span class="dim num">${pace.left}</span>`}
      </a>
    </li>
  `;
}
