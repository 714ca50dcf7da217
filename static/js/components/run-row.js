// A training or race in the list of runs.
import { useState } from "preact/hooks";
import { copySettings, deleteRun, isShown, pending, resumeRun, showOnStage } from "../actions.js";
import { agentOf, ratesInWords } from "../agents.js";
import { downloads } from "../api.js";
import { ago, count, listed, metres, sentence, whole } from "../format.js";
import { html } from "../html.js";
import { hasTable, isActive, isOperator, presetOf } from "../selectors.js";
import { served } from "../store.js";
import { gaitTitle, observationTitle, robotTitle, simulatorTitle } from "../titles.js";
import { Problem } from "./problem.js";

export function RunRow({ run }) {
  const title = run.name || sentence(run.kind);
  return html`
    <li class="run">
      <${StateOf} run=${run} />
      <div class="what">
        <p><b>${title}</b> ${!title.includes(run.config.gait) && html`<span class="dim">${gaitOf(run)}</span>`}</p>
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

const gaitOf = ({ config: { gait } }) => (typeof gait === "string" ? gaitTitle(gait) : "own gait");

function summaryOf(run) {
  const { config } = run;
  const { robot, simulator, agent } = served().defaults.training;
  const name = presetOf(config.robot);
  // What is as by default is not named.
  const learner = [undefined, agent].includes(config.agent) ? "" : agentOf(config.agent).title;
  const place = [
    name === robot ? "" : robotTitle(name ?? config.robot.name ?? "own robot"),
    config.simulator === simulator ? "" : simulatorTitle(config.simulator),
  ];
  const own = run.kind === "race" ? ofRace(config) : ofTraining(run);
  return [learner, ...own, ...place].filter(Boolean).join(" · ");
}

const ofRace = ({ lanes, steps }) => [listed(lanes.map(({ agent }) => agentOf(agent).title)), count(steps, "step")];

function ofTraining({ config, progress, state }) {
  const total = count(config.steps, "step");
  return [
    state === "finished" ? total : `${whole(progress.done)} of ${total}`,
    config.continue_from ? "continues an earlier one" : `seed ${config.seed}`,
    ...ratesInWords(config.agent, config), observationTitle(config.observation),
  ];
}

function Outcome({ run: { kind, result } }) {
  if (!result) return null;
  if (kind === "training") {
    const greedy = metres(result.greedy_distance_m);
    return html`<b>${metres(result.distance_m)}</b> <span class="dim">of greedy’s ${greedy}</span>`;
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
