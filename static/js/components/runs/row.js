// A run in the list: what it is, what came of it, what users say of it, and what can be done with it.
import { useState } from "preact/hooks";
import { attempt, copySettings, deleteRun, isShown, pending, resumeRun, runAgain, showOnStage } from "../../actions.js";
import { changesInWords, rateChanges } from "../../changes.js";
import { disturbancesOf, inTime, joinedBySteps } from "../../disturbances.js";
import { paceOf } from "../../experiments/runs.js";
import { archiveAddress, downloads, notInstalled, rendered, saveExport } from "../../files.js";
import { ago, count, listed, metres, sentence, whole } from "../../format.js";
import { formRobot, isSame } from "../../robots.js";
import { isSelected, setSelected } from "../../run-selection.js";
import { addressOf } from "../../page-state.js";
import { isActive, isOperator } from "../../selectors.js";
import { agentOf, laneTitle, ratesInWords } from "../../settings.js";
import { served } from "../../store.js";
import { describeRun, gaitTitle, observationTitle, robotTitle, runTitle, simulatorTitle } from "../../titles.js";
import { html, Problem } from "../elements.js";
import { ReplayLink } from "../replay-link.js";
import { edit, Name, Notes, Tags } from "./annotations.js";
import { showCode } from "./code.js";

/** @import { AnyRun } from "../../runs.js" */
/** @import { DamagedRun, ExportOption, Run } from "../../types.js" */

/** @param {{ run: AnyRun }} props */
export const RunRow = ({ run }) => html`<${"damaged" in run ? DamagedRow : Row} run=${run} />`;

/** @param {{ run: Run }} props */
function Row({ run }) {
  const title = titleOf(run);
  const gait = run.kind === "experiment" ? "" : gaitTitle(run.config.gait);
  return html`
    <li class="run">
      <${Box} run=${run} title=${title} />
      <${StateOf} run=${run} />
      <div class="what">
        <${Name} run=${run} title=${title} aside=${title.includes(gait) ? "" : gait} />
        <p class="dim">${run.kind === "experiment" ? describeRun(run) : summaryOf(run)}</p>
        <${Tags} run=${run} />
        <${Notes} run=${run} />
        ${run.error && html`<p class="bad">${run.error}</p>`}
      </div>
      <p class="outcome num"><${Outcome} run=${run} /></p>
      <p class="when dim"><time datetime=${run.created_at}>${ago(run.created_at)}</time></p>
      <${Actions} run=${run} />
      <${Problem} at=${run.id} />
    </li>
  `;
}

/** @param {Run} run */
const titleOf = (run) => (run.kind === "experiment" ? runTitle(run) : run.name || sentence(run.kind));

/**
 * Selects the run; a click with Shift selects all from the one before to it.
 * @param {{ run: AnyRun, title: string }} props
 */
function Box({ run, title }) {
  /** @param {MouseEvent & { target: HTMLInputElement }} event */
  const onClick = ({ target, shiftKey }) => setSelected(run.id, target.checked, shiftKey);
  return html`
    <label class="run-box">
      <input type="checkbox" value=${run.id} checked=${isSelected(run.id)} onClick=${onClick}
        aria-label=${`Select ${title}`} />
    </label>
  `;
}

/** @param {{ run: Run }} props */
const StateOf = ({ run: { state, queue_position } }) => html`
  <p class=${`state ${state}`}>
    <span class="dot" aria-hidden="true"></span>${state}${queue_position
      ? html` <span class="dim">no. ${queue_position}</span>`
      : ""}
  </p>
`;

/** @param {Run} run */
function summaryOf(run) {
  const { config } = run;
  const { robot, simulator } = served().defaults.training;
  const learner = config.agent && !run.name.includes(agentOf(config.agent).title) ? agentOf(config.agent).title : "";
  // Defaults are not named.
  const place = [
    isSame(formRobot(config.robot), robot) ? "" : robotTitle(config.robot),
    config.simulator === simulator ? "" : simulatorTitle(config.simulator),
  ];
  const own = run.kind === "race" ? ofRace(config) : ofTraining(run);
  return [learner, ...own, ...place, ...joinedBySteps(disturbancesOf(run)).map(inTime)].filter(Boolean).join(" · ");
}

/** @param {Run["config"]} one */
const ofRace = ({ lanes, steps }) => [listed(lanes.map(laneTitle)), count(steps, "step")];

/** @param {Run} run */
function ofTraining(run) {
  const { config, progress, state } = run;
  const total = count(config.steps, "step");
  return [
    state === "finished" ? total : `${whole(progress.done)} of ${total}`,
    config.continue_from ? "continues an earlier one" : `seed ${config.seed}`,
    ...ratesInWords(config.agent, config.settings), ...changesInWords(config.agent, rateChanges(run)),
    observationTitle(config.observation),
  ];
}

/** @param {{ run: Run }} props */
function Outcome({ run }) {
  const { kind, result } = run;
  if (kind === "experiment") return html`<span class="dim">${paceOf(run).label}</span>`;
  if (!result) return null;
  if (kind === "training") {
    const greedy = metres(result.greedy_distance_m);
    const best = typeof result.best_known_m === "number" ? `, best known ${metres(result.best_known_m)}` : "";
    return html`<b>${metres(result.distance_m)}</b> <span class="dim">of greedy’s ${greedy}${best}</span>`;
  }
  const lanes = result.lanes.map((lane) => ({ ...lane, ...lane.clocks.paper }));
  const first = lanes.find(({ rank }) => rank === 1);
  // Earlier versions ranked a race that was stopped before its time-out.
  if (!first || lanes.every(({ steps }) => steps < run.config.steps)) return null;
  const { title, color } = agentOf(first.agent);
  const distance = metres(first.finished_distance_m);
  return html`
    <span class="swatch" style=${{ "--agent": color }}></span><b>${title}</b> <span class="dim">${distance}</span>
  `;
}

// ---- what can be done with it

/** @param {{ run: Run }} props */
function Actions({ run }) {
  const isPending = pending.value[run.id];
  const canResume = run.can_resume && run.state !== "paused";
  return html`
    <div class="run-actions">
      ${isOperator.value && canResume && html`
        <button class="secondary compact" disabled=${isPending} onClick=${() => resumeRun(run)}>Resume</button>
      `}
      ${run.kind === "experiment"
        ? html`<a class="to-report" href=${addressOf({ view: "experiments", report: run.id })}>Report</a>`
        : html`
          ${run.progress.done > 0 && html`<${ReplayLink} id=${run.id}>Replay<//>`}
          ${isOperator.value && html`
            <button class="secondary compact" disabled=${isPending || run.state === "queued"}
              onClick=${() => showOnStage(run)} title="Show it on the stage, to everybody">
              ${isShown(run) ? "On stage" : "Show"}
            </button>
          `}
        `}
      <${Menu} run=${run} />
    </div>
  `;
}

/** @param {{ run: Run }} props */
function Menu({ run }) {
  const [isSure, setSure] = useState(false);
  return html`
    <details class="menu">
      <summary class="quiet square" aria-label=${`More for this ${run.kind}`}>⋯</summary>
      <div class="menu-body">
        <${Downloads} run=${run} />
        ${isOperator.value && run.kind !== "experiment" && !isActive(run) && run.progress.done > 0 && html`
          ${rendered().map((file) => html`<${RenderButton} key=${file.title} run=${run} file=${file} />`)}
          ${notInstalled().map(([install, titles]) => html`
            <p class="dim">${listed(titles)}: not installed on the server; <code>${install}</code> adds it.</p>
          `)}
        `}
        ${isOperator.value && run.kind !== "experiment" && html`
          <a href="#" onClick=${() => copySettings(run)}>Use its settings</a>
        `}
        <button onClick=${() => showCode(run)}>As code</button>
        ${isOperator.value && html`
          <button onClick=${() => runAgain(run)}>Run again</button>
          <button onClick=${() => edit(run, "name")}>Rename</button>
          <button onClick=${() => edit(run, "tags")}>${run.tags?.length ? "Change its tags" : "Add tags"}</button>
          <button onClick=${() => edit(run, "notes")}>${run.notes ? "Change its notes" : "Add notes"}</button>
        `}
        ${isOperator.value && !isActive(run) && html`
          <button class="bad" onClick=${() => (isSure ? deleteRun(run) : setSure(true))}>
            ${isSure ? "Delete for good?" : "Delete"}
          </button>
        `}
      </div>
    </details>
  `;
}

/** Have a file computed; the menu says so until it is there, or why there is none stands in the row. */
/** @param {{ run: Run, file: ExportOption }} props */
function RenderButton({ run, file }) {
  const [isRendering, setRendering] = useState(false);
  const onClick = async () => {
    setRendering(true);
    await attempt(run.id, () => saveExport(run, file));
    setRendering(false);
  };
  return html`
    <button disabled=${pending.value[run.id]} onClick=${onClick} aria-live="polite">
      ${isRendering ? `${file.title}: being rendered…` : file.title}
    </button>
  `;
}

/** @param {{ run: Run }} props */
function Downloads({ run }) {
  const hasEnded = !isActive(run);
  const hasBegun = run.progress.done > 0 || run.result;
  const files = [
    ...(run.kind === "experiment" || (hasEnded && hasBegun) ? downloads(run) : []),
    ...(hasEnded ? [["Archive (zip)", archiveAddress(run)]] : []),
  ];
  if (files.length === 0) return html`<p class="dim">Nothing to download.</p>`;
  return files.map(([label, href]) => html`<a href=${href} download>${label}</a>`);
}

// ---- a run that the server cannot read: what is known of it, the reason, and its deletion

/** @param {{ run: DamagedRun }} props */
function DamagedRow({ run }) {
  const title = run.name || `A ${run.kind ?? "run"} that cannot be read`;
  return html`
    <li class="run">
      <${Box} run=${run} title=${title} />
      <p class="state failed"><span class="dot" aria-hidden="true"></span>damaged</p>
      <div class="what">
        <p><b role="heading" aria-level="3">${title}</b> <span class="dim">${run.id}</span></p>
        <p class="bad">${run.damaged}</p>
      </div>
      <p class="outcome num"></p>
      <p class="when dim">${run.created_at && html`<time datetime=${run.created_at}>${ago(run.created_at)}</time>`}</p>
      <div class="run-actions">${isOperator.value && html`<${DeleteButton} run=${run} />`}</div>
      <${Problem} at=${run.id} />
    </li>
  `;
}

/** @param {{ run: AnyRun }} props */
function DeleteButton({ run }) {
  const [isSure, setSure] = useState(false);
  const onClick = () => (isSure ? deleteRun(run) : setSure(true));
  return html`
    <button class="secondary compact bad" disabled=${pending.value[run.id]} onClick=${onClick}>
      ${isSure ? "Delete for good?" : "Delete"}
    </button>
  `;
}
