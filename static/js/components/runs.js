// The list of all runs with its filters.
import { useState } from "preact/hooks";
import { copySettings, deleteRun, isShown, pending, resumeRun, showOnStage } from "../actions.js";
import { downloads } from "../api.js";
import { changesInWords, rateChanges } from "../changes.js";
import { paceOf } from "../experiments/runs.js";
import { happeningsOf, inTime, joinedBySteps } from "../disturbances.js";
import { ago, count, listed, metres, sentence, whole } from "../format.js";
import { formRobot, isSame } from "../robots.js";
import { hasTable, isActive, isOperator } from "../selectors.js";
import { agentOf, laneTitle, ratesInWords } from "../settings.js";
import { clearFilters, filters, isFiltered, runList, shownRuns } from "../runs.js";
import { served } from "../store.js";
import { describeRun, gaitTitle, observationTitle, robotTitle, runTitle, simulatorTitle } from "../titles.js";
import { html, Problem, Segments } from "./elements.js";

const KINDS = [["", "All"], ["training", "Trainings"], ["race", "Races"], ["experiment", "Experiments"]];
const STATES = ["running", "paused", "queued", "finished", "stopped", "failed", "interrupted"];

const setFilter = (name, value) => (filters.value = { ...filters.value, [name]: value });

export function Runs() {
  const { kind, state, search } = filters.value;
  const shown = shownRuns.value;
  return html`
    <section class="panel runs" aria-labelledby="runs-title" aria-busy=${runList.isLoading.value ? "true" : "false"}>
      <div class="runs-head">
        <h2 id="runs-title">Runs</h2>
        <${Segments} label="Kind" choices=${KINDS} value=${kind} onValue=${(value) => setFilter("kind", value)} />
        <label class="choice">
          <span class="sr-only">State</span>
          <select onChange=${({ target }) => setFilter("state", target.value)}>
            <option value="" selected=${state === ""}>any state</option>
            ${STATES.map((one) => html`<option value=${one} selected=${one === state}>${one}</option>`)}
          </select>
        </label>
        <input class="search" type="search" aria-label="Search names and ids" placeholder="Name or id"
          maxlength=${served().limits.name[1]} value=${search}
          onInput=${({ target }) => setFilter("search", target.value)} />
      </div>
      ${shown.length === 0
        ? html`<${NoRuns} />`
        : html`<ul>${shown.map((run) => html`<${rowOf(run)} key=${run.id} run=${run} />`)}</ul>`}
      <${Older} />
    </section>
  `;
}

function rowOf(run) {
  if ("damaged" in run) return DamagedRunRow;
  return run.kind === "experiment" ? ExperimentRunRow : RunRow;
}

function NoRuns() {
  if (runList.error.value) return null;
  if (!runList.isListed.value) {
    return html`<p class="no-runs" role="status"><span class="spinner" aria-hidden="true"></span> Loading…</p>`;
  }
  if (!isFiltered.value) return html`<div class="no-runs"><${FirstVisit} /></div>`;
  return html`
    <div class="no-runs">
      <p role="status">No run matches these filters.</p>
      <button class="secondary" onClick=${clearFilters}>Show all runs</button>
    </div>
  `;
}

const FirstVisit = () => html`
  <p><b>No runs yet.</b></p>
  <p>
    Every training, race and experiment is kept here, with its curve, its table, its recording or its
    report. <a href="#">Start the first one</a>.
  </p>
`;

function Older() {
  const { error, hasOlder, isLoading, loadMore } = runList;
  if (!hasOlder.value && !error.value) return null;
  return html`
    <div class="older">
      <p role="alert">${error}</p>
      <button class="secondary" aria-disabled=${isLoading.value ? "true" : undefined} onClick=${loadMore}>
        ${error.value ? "Try again" : "Show older runs"}
      </button>
    </div>
  `;
}

// ---- a training or race

function RunRow({ run }) {
  const title = run.name || sentence(run.kind);
  return html`
    <li class="run">
      <${StateOf} run=${run} />
      <div class="what">
        <p><b>${title}</b> ${!title.includes(gaitOf(run)) && html`<span class="dim">${gaitOf(run)}</span>`}</p>
        <p class="dim">${summaryOf(run)}</p>
        ${run.error && html`<p class="bad">${run.error}</p>`}
      </div>
      <p class="outcome num"><${Outcome} run=${run} /></p>
      <p class="when dim"><time datetime=${run.created_at}>${ago(run.created_at)}</time></p>
      <${Actions} run=${run} />
      <${Problem} at=${run.id} />
    </li>
  `;
}

const StateOf = ({ run: { state, queue_position } }) => html`
  <p class=${`state ${state}`}>
    <span class="dot" aria-hidden="true"></span>${state}${queue_position
      ? html` <span class="dim">no. ${queue_position}</span>`
      : ""}
  </p>
`;

const gaitOf = ({ config: { gait } }) => gaitTitle(gait);

function summaryOf(run) {
  const { config } = run;
  const { robot, simulator, agent } = served().defaults.training;
  // What is as by default is not named.
  const learner = [undefined, agent].includes(config.agent) ? "" : agentOf(config.agent).title;
  const place = [
    isSame(formRobot(config.robot), robot) ? "" : robotTitle(config.robot),
    config.simulator === simulator ? "" : simulatorTitle(config.simulator),
  ];
  const own = run.kind === "race" ? ofRace(config) : ofTraining(run);
  return [learner, ...own, ...place, ...joinedBySteps(happeningsOf(run)).map(inTime)].filter(Boolean).join(" · ");
}

const ofRace = ({ lanes, steps }) => [listed(lanes.map(laneTitle)), count(steps, "step")];

function ofTraining(run) {
  const { config, progress, state } = run;
  const total = count(config.steps, "step");
  return [
    state === "finished" ? total : `${whole(progress.done)} of ${total}`,
    config.continue_from ? "continues an earlier one" : `seed ${config.seed}`,
    ...ratesInWords(config.agent, config), ...changesInWords(config.agent, rateChanges(run)),
    observationTitle(config.observation),
  ];
}

function Outcome({ run: { kind, result } }) {
  if (!result) return null;
  if (kind === "training") {
    const greedy = metres(result.greedy_distance_m);
    const best = typeof result.best_known_m === "number" ? `, best known ${metres(result.best_known_m)}` : "";
    return html`<b>${metres(result.distance_m)}</b> <span class="dim">of greedy’s ${greedy}${best}</span>`;
  }
  const lanes = result.lanes.map((lane) => ({ ...lane, ...lane.clocks.paper }));
  const first = lanes.find(({ rank }) => rank === 1);
  if (!first) return null;
  const { title, color } = agentOf(first.agent);
  const distance = metres(first.finished_distance_m);
  return html`
    <span class="swatch" style=${{ "--agent": color }}></span><b>${title}</b> <span class="dim">${distance}</span>
  `;
}

function Actions({ run }) {
  const isPending = pending.value[run.id];
  const canResume = run.can_resume && run.state !== "paused";
  return html`
    <div class="run-actions">
      ${isOperator.value && canResume && html`
        <button class="secondary compact" disabled=${isPending} onClick=${() => resumeRun(run)}>Resume</button>
      `}
      ${isOperator.value && html`
        <button class="secondary compact" disabled=${isPending || run.state === "queued"}
          onClick=${() => showOnStage(run)}>
          ${isShown(run) ? "On stage" : "Show"}
        </button>
      `}
      <${Menu} run=${run} />
    </div>
  `;
}

function Menu({ run }) {
  const [isSure, setSure] = useState(false);
  return html`
    <details class="menu">
      <summary class="quiet square" aria-label=${`More for this ${run.kind}`}>⋯</summary>
      <div class="menu-body">
        <${Downloads} run=${run} />
        ${isOperator.value && html`<a href="#" onClick=${() => copySettings(run)}>Use its settings</a>`}
        ${isOperator.value && !isActive(run) && html`
          <button class="bad" onClick=${() => (isSure ? deleteRun(run) : setSure(true))}>
            ${isSure ? "Delete for good?" : "Delete"}
          </button>
        `}
      </div>
    </details>
  `;
}

function Downloads({ run }) {
  const hasFiles = run.kind === "race" ? run.state === "finished" : hasTable(run);
  if (!hasFiles) return html`<p class="dim">Nothing to download.</p>`;
  return downloads(run).map(([label, href]) => html`<a href=${href} download>${label}</a>`);
}

// ---- an experiment, with a link to its report

const ExperimentRunRow = ({ run }) => html`
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

// ---- a run that the server cannot read: what is known of it, the reason, and its deletion

const DamagedRunRow = ({ run }) => html`
  <li class="run">
    <p class="state failed"><span class="dot" aria-hidden="true"></span>damaged</p>
    <div class="what">
      <p><b>${run.name || `A ${run.kind ?? "run"} that cannot be read`}</b> <span class="dim">${run.id}</span></p>
      <p class="bad">${run.damaged}</p>
    </div>
    <p class="outcome num"></p>
    <p class="when dim">${run.created_at && html`<time datetime=${run.created_at}>${ago(run.created_at)}</time>`}</p>
    <div class="run-actions">${isOperator.value && html`<${DeleteButton} run=${run} />`}</div>
    <${Problem} at=${run.id} />
  </li>
`;

function DeleteButton({ run }) {
  const [isSure, setSure] = useState(false);
  const onClick = () => (isSure ? deleteRun(run) : setSure(true));
  return html`
    <button class="secondary compact bad" disabled=${pending.value[run.id]} onClick=${onClick}>
      ${isSure ? "Delete for good?" : "Delete"}
    </button>
  `;
}
