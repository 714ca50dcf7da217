// One run of the list.
import { useState } from "preact/hooks";
import { goOn, isShown, pending, remove, showOnStage, useSettingsOf } from "../actions.js";
import { downloads } from "../api.js";
import { ago, count, listed, metres, whole } from "../format.js";
import { html } from "../html.js";
import { agentOf, hasTable, isActive, isOperator } from "../selectors.js";
import { options } from "../store.js";
import { Problem } from "./problem.js";

export function RunRow({ run }) {
  const title = run.name || `${run.kind === "race" ? "Race" : "Training"}`;
  return html`
    <li class="run">
      <p class=${`state ${run.state}`}><span class="dot" aria-hidden="true"></span>${run.state}${run.queue_position ? html` <span class="dim">no. ${run.queue_position}</span>` : ""}</p>
      <div class="what">
        <p><b>${title}</b> ${!title.includes(run.config.gait) && html`<span class="dim">${gaitOf(run)}</span>`}</p>
        <p class="dim">${about(run)}</p>
        ${run.error && html`<p class="bad">${run.error}</p>`}
      </div>
      <p class="came num">${outcome(run)}</p>
      <p class="when dim"><time datetime=${run.created_at}>${ago(run.created_at)}</time></p>
      <${Deeds} run=${run} />
      <${Problem} at=${run.id} />
    </li>
  `;
}

const gaitOf = ({ config: { gait } }) =>
  options.value?.gaits?.find(({ name }) => name === gait)?.title ?? (typeof gait === "string" ? gait : "own gait");

function about(run) {
  const { config, progress, state } = run;
  const robot = config.robot?.preset ?? config.robot;
  const where = [robot === "stiff" ? "" : robot, config.simulator === "mujoco" ? "" : config.simulator].filter(Boolean);
  if (run.kind === "race") {
    return [listed(config.lanes.map(({ agent }) => agentOf(agent).title)), count(config.steps, "step"), ...where].join(" · ");
  }
  const steps = state === "finished" ? count(config.steps, "step") : `${whole(progress.done)} of ${count(config.steps, "step")}`;
  const from = config.continue_from ? "goes on from an earlier one" : `seed ${config.seed}`;
  return [steps, from, `α ${config.alpha}`, `γ ${config.gamma}`, config.observation, ...where].join(" · ");
}

function outcome({ kind, result }) {
  if (!result) return "";
  if (kind === "training") return html`<b>${metres(result.distance_m)}</b> <span class="dim">of greedy’s ${metres(result.greedy_distance_m)}</span>`;
  const lanes = result.lanes.map((lane) => ({ ...lane, ...lane.clocks.paper }));
  const first = lanes.find(({ rank }) => rank === 1);
  if (!first) return "";
  const { title, color } = agentOf(first.agent);
  return html`<span class="swatch" style=${{ "--agent": color }}></span><b>${title}</b> <span class="dim">${metres(first.finished_distance_m)}</span>`;
}

function Deeds({ run }) {
  const [isSure, setSure] = useState(false);
  const mayTake = run.kind === "race" ? run.state === "finished" : hasTable(run);
  return html`
    <div class="run-deeds">
      ${isOperator.value && run.can_resume && run.state !== "paused" && html`
        <button class="secondary compact" disabled=${pending.value[run.id]} onClick=${() => goOn(run)}>Go on</button>
      `}
      ${isOperator.value && html`
        <button class="secondary compact" disabled=${pending.value[run.id] || run.state === "queued"} onClick=${() => showOnStage(run)}>
          ${isShown(run) ? "On stage" : "Show"}
        </button>
      `}
      <details class="menu">
        <summary class="quiet square" aria-label=${`More for this ${run.kind}`}>⋯</summary>
        <div class="menu-body">
          ${mayTake ? downloads(run).map(([label, href]) => html`<a href=${href} download>${label}</a>`) : html`<p class="dim">Nothing to take away.</p>`}
          ${isOperator.value && html`<a href="#" onClick=${() => useSettingsOf(run)}>Use its settings</a>`}
          ${isOperator.value && !isActive(run) && html`
            <button class="bad" onClick=${() => (isSure ? remove(run) : setSure(true))}>
              ${isSure ? "Delete for good?" : "Delete"}
            </button>
          `}
        </div>
      </details>
    </div>
  `;
}
