// The experiments view: the list on one side, the report on the other; the form is a dialog.
import { untracked } from "@preact/signals";
import { useState } from "preact/hooks";
import { follow } from "../follow.js";
import { chosenRun, experimentList, experimentRuns, isMissing, summaryOf } from "../runs.js";
import { configInWords, outcomeOf } from "../words.js";
import { ago } from "../../../js/format.js";
import { addressOf, page } from "../../../js/page-state.js";
import { isActive, isOperator } from "../../../js/selectors.js";
import { agentOf } from "../../../js/settings.js";
import { connection, served } from "../../../js/store.js";
import { html, ProgressBar } from "../../../js/components/elements.js";
import { ExperimentDialog, openForm } from "./dialog.js";
import { StripKey } from "./report-tools.js";
import { Report } from "./report.js";
import { StateOf } from "./state-of.js";
import { paceOf, runTitle } from "../feature.js";

/** @import { Run } from "../../../js/types.js" */

export function Experiments() {
  useState(() => untracked(follow));
  const run = chosenRun.value;
  const isOffline = connection.value === "reconnecting";
  return html`
    <div class=${`experiments ${isOffline ? "cut-off" : ""} ${page.report.value ? "has-report" : ""}`}>
      <${ExperimentList} />
      <div class="answer">
        ${isOffline && html`<${OfflineNote} />`}
        ${run ? html`<${Report} key=${run.id} run=${run} />` : html`<${NoReport} />`}
      </div>
      ${isOperator.value && html`<${ExperimentDialog} />`}
    </div>
  `;
}

function NoReport() {
  if (isMissing.value) return html`<${MissingRun} />`;
  return experimentList.isListed.value && !page.report.value && html`<${Invitation} />`;
}

const MissingRun = () => html`
  <section class="panel invitation" aria-labelledby="missing-title">
    <h2 id="missing-title">This experiment is not here</h2>
    <p role="alert">
      The link names the experiment ${page.report.value}. It was deleted, or it is on another server.
    </p>
    <p><button class="secondary" onClick=${() => (page.report.value = null)}>Show the newest experiment</button></p>
  </section>
`;

const OfflineNote = () => html`
  <p class="cut-off-note" role="status">
    <span class="spinner" aria-hidden="true"></span>Reconnecting. This is the last known state.
  </p>
`;

// ---- the list, with progress and links to reports

function ExperimentList() {
  const all = experimentRuns.value;
  return html`
    <section class="panel experiment-list" aria-labelledby="experiment-list">
      <div class="list-head">
        <h2 id="experiment-list">Experiments</h2>
        ${isOperator.value && html`
          <button class="secondary compact" onClick=${openForm}>New experiment</button>
        `}
      </div>
      <div class="experiment-rows">
        ${all.length > 0
          ? html`<ul>${all.map((run) => html`<${Row} key=${run.id} run=${run} />`)}</ul>`
          : html`<p class="dim">${experimentList.isListed.value ? "None yet." : "Loading the experiments…"}</p>`}
        ${experimentList.hasMore.value && html`<${Older} />`}
      </div>
    </section>
  `;
}

const Older = () => html`
  <div class="older"><button class="secondary" onClick=${experimentList.loadMore}>Show older experiments</button></div>
`;

/** @param {{ run: Run }} props */
function Row({ run }) {
  const isChosen = chosenRun.value?.id === run.id;
  const outcome = outcomeOf(run, summaryOf(run.id));
  /** @param {MouseEvent} event */
  const choose = (event) => {
    event.preventDefault();
    page.report.value = run.id;
  };
  return html`
    <li>
      <a class="experiment-row" href=${addressOf({ view: "experiments", report: run.id })}
        aria-current=${isChosen ? "true" : undefined} onClick=${choose}>
        <b>${runTitle(run)}</b>
        <span class="row-state">
          <${StateOf} run=${run} />
          <time class="dim" datetime=${run.created_at}>${ago(run.created_at)}</time>
        </span>
        ${isActive(run) && html`<${ProgressBar} label=${runTitle(run)} share=${paceOf(run).share} />`}
        <span class="dim about">${outcome || configInWords(run.config)}</span>
      </a>
    </li>
  `;
}

// ---- before the first experiment: what one is for, with a sketch of its dots

/** A sketch, not measured: positions of the seeds and of the published value, in percent. */
const ROWS = [
  [[8, 62, 66, 69, 70, 72, 73, 75, 76, 78, 80, 83], 50],
  [[30, 68, 72, 75, 78, 79, 80, 82, 84, 85, 87, 88], 66],
];
const SCATTER_PX = [0, -7, 6];

const OPERATOR_WORDS =
  "Its report fills here while trials end; it can be paused and resumed.";
const SPECTATOR_WORDS = "No experiment has been run here. The report of the first one will fill here.";

/** @param {{ points: number[], published: number, y: number }} props */
const Sketch = ({ points, published, y }) => html`
  <line class="rule" x1="0" x2="100%" y1=${y} y2=${y} />
  ${points.map((x, n) => html`<circle cx=${`${x}%`} cy=${y + SCATTER_PX[n % 3]} r="4" />`)}
  <svg x=${`${published}%`} y=${y} overflow="visible"><path d="M0-8 7 0 0 8-7 0z" /></svg>
`;

function Invitation() {
  const { color } = agentOf(served().defaults.training.agent);
  return html`
    <section class="panel invitation" aria-labelledby="invitation-title">
      <h2 id="invitation-title">One seed misleads</h2>
      <p>
        The paper shows one run of everything. The same robot with other random numbers may walk, or march on the
        spot. Here everything is run thirty times and each run is a dot, with the published value among them.
      </p>
      <svg class="sketch-dots" width="100%" height="112" aria-hidden="true" style=${{ "--agent": color }}>
        <line class="reach" x1="93%" x2="93%" y1="0" y2="112" />
        ${ROWS.map(([points, published], n) => html`
          <${Sketch} points=${points} published=${published} y=${30 + 52 * n} />
        `)}
      </svg>
      <${StripKey} signs=${["seed", "greedy", "published"]} color=${color} />
      ${isOperator.value && html`
        <p><button class="primary" onClick=${openForm}>Choose an experiment</button></p>
      `}
      <p class="dim">${isOperator.value ? OPERATOR_WORDS : SPECTATOR_WORDS}</p>
    </section>
  `;
}
