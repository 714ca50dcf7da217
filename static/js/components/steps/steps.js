// One step at a time: the step that the stage shows, or one that is chosen here, explained, and the whole table.
import { useEffect } from "preact/hooks";
import { setStage } from "../../actions.js";
import { whole } from "../../format.js";
import { chooseState, chosenState, followChosenState, giveUpState } from "../../posture.js";
import { canPlay, shownRun } from "../../on-stage.js";
import { ownStage, scene } from "../../store.js";
import {
  chosenLane, chooseStep, explanation, firstState, followMoment, followStage, isFollowing, lastStep, moment, stateIndex,
  table, tableMoment,
} from "../../steps.js";
import { messageOf } from "../../titles.js";
import { html, Icon, Segments } from "../elements.js";
import { ExplainedStep } from "./explanation.js";
import { Heatmap } from "./heatmap.js";

/** @import { Moment } from "../../steps.js" */
/** @import { StateTable } from "../../types.js" */

export function Steps() {
  useEffect(followMoment, []);
  useEffect(followChosenState, []);
  const at = moment.value;
  if (!at) return html`<p class="dim">Once a run is on stage, each of its steps is explained here.</p>`;
  return html`
    <${Navigator} at=${at} />
    <div class=${tableMoment.value ? "steps-parts" : "steps-parts alone"}>
      <${Explained} at=${at} />
      <${WholeTable} at=${at} />
    </div>
  `;
}

// ---- which step

/** @param {{ at: Moment }} props */
function Navigator({ at }) {
  const { step } = at;
  const last = lastStep.value;
  const lanes = scene.value?.lanes ?? [];
  const followed = ownStage.value === null ? "stage" : "replay";
  /** @param {{ target: HTMLInputElement }} event */
  const onInput = ({ target }) => {
    const number = Number(target.value);
    if (Number.isInteger(number) && number >= 1 && number <= last) chooseStep(number);
  };
  return html`
    <div class="steps-bar">
      ${lanes.length > 1 && html`
        <${Segments} label="Lane" value=${at.lane} onValue=${(/** @type {number} */ lane) => (chosenLane.value = lane)}
          choices=${lanes.map(({ lane, name }) => [lane, name])} />
      `}
      <div class="stepper" role="group" aria-label="Step">
        <button class="secondary compact" aria-label="One step back" disabled=${step <= 1}
          onClick=${() => chooseStep(step - 1)}>‹</button>
        <label>Step <input class="step-number" inputmode="numeric" value=${step} onChange=${onInput}
          aria-label="Step" /></label>
        <span class="dim">of ${whole(last)}</span>
        <button class="secondary compact" aria-label="One step forward" disabled=${step >= last}
          onClick=${() => chooseStep(step + 1)}>›</button>
      </div>
      ${isFollowing.value
        ? html`<span class="dim">It follows the ${followed}.</span>`
        : html`
          <button class="secondary compact" onClick=${followStage}>Follow the ${followed}</button>
          ${canPlay.value && shownRun.value?.kind === "training" && html`<${ShowOnStage} step=${step} />`}
        `}
    </div>
  `;
}

/** Show this step on the stage: practice takes as long for each of its steps. @param {{ step: number }} props */
function ShowOnStage({ step }) {
  const { duration_s, lanes = [] } = scene.value ?? {};
  if (!duration_s || !lanes[0]?.steps) return null;
  const seek = () => {
    setStage({ time_s: ((step - 1) * duration_s) / lanes[0].steps, playing: false });
    followStage();
  };
  return html`<button class="secondary compact" onClick=${seek}><${Icon} name="play" /> Show it on the stage</button>`;
}

// ---- its explanation

/** @param {{ at: Moment }} props */
function Explained({ at }) {
  const { answer, error, again } = explanation.value;
  const { step, run_id, lane } = at;
  const isOfMoment = answer && answer.run_id === run_id && (answer.lane ?? 0) === lane;
  const isOld = isOfMoment && answer.step !== step;
  return html`
    <section class="steps-part" aria-labelledby="explained-title" aria-busy=${isOld ? "true" : "false"}>
      <h3 id="explained-title">${isOfMoment ? `Step ${whole(answer.step)}, explained` : "Explain this step"}</h3>
      ${step === 0 && html`<p class="dim">It stands on the start line. Its first step comes next.</p>`}
      <${Trouble} error=${error} again=${again} />
      ${isOfMoment && !(error && !again) && html`<${ExplainedStep} told=${answer} />`}
      ${!isOfMoment && !error && step > 0 && html`<${Waiting} />`}
    </section>
  `;
}

const Waiting = () => html`
  <p role="status"><span class="spinner" aria-hidden="true"></span> The learner is built again…</p>
`;

/** @param {{ error: Error | null, again: boolean }} props */
const Trouble = ({ error, again }) => error && (again
  ? html`<p class="dim" role="status"><span class="spinner" aria-hidden="true"></span> ${messageOf(error)}</p>`
  : html`<p class="problem" role="alert"><span>${messageOf(error)}</span></p>`);

// ---- the whole table

/** @param {{ at: Moment }} props */
function WholeTable({ at }) {
  const { answer, error, again } = table.value;
  const wanted = tableMoment.value;
  const isShown = wanted && answer && (again || !error);
  return html`
    <section class="steps-part" aria-labelledby="table-title">
      <h3 id="table-title">The whole table <${TableTime} wanted=${wanted} /></h3>
      ${!wanted && html`<p class="dim">This lane has no table of a training.</p>`}
      <${Trouble} error=${error} again=${again} />
      ${isShown && html`<${TableOfStates} at=${at} shown=${answer} />`}
      ${wanted && !answer && !error && html`<${Waiting} />`}
    </section>
  `;
}

/** @param {{ wanted: typeof tableMoment.value }} props */
const TableTime = ({ wanted }) => wanted && html`
  <span class="dim">
    ${wanted.step === null ? "at the end of its practice" : `before step ${whole(wanted.step + 1)}`}
  </span>
`;

/** @param {{ at: Moment, shown: StateTable }} props */
function TableOfStates({ at, shown }) {
  const told = explanation.value.answer;
  const seen = told?.run_id === at.run_id ? told : null;
  const chosen = chosenState.value;
  const cells = chosen?.cells ?? seen?.observation;
  const index = cells ? stateIndex(cells, shown.cell_names.length) : null;
  const rows = shown.values.length;
  useEffect(() => {
    // Of a large table the part is shown in which the state is.
    const isOutside = index !== null && (index < shown.first || index >= shown.first + rows);
    if (isOutside && isFollowing.value) firstState.value = Math.floor(index / rows) * rows;
  }, [index, shown.states]);
  return html`
    ${shown.states > rows && html`<${Parts} shown=${shown} />`}
    <${Heatmap} shown=${shown} cells=${seen?.observation ?? null} move=${seen?.action ?? null}
      chosen=${chosen} onChoose=${chooseState} onGiveUp=${giveUpState} />
  `;
}

/** @param {{ shown: StateTable }} props */
function Parts({ shown }) {
  const rows = shown.values.length;
  const end = shown.first + rows;
  /** @param {number} first */
  const to = (first) => () => {
    firstState.value = Math.max(0, first);
  };
  return html`
    <div class="row">
      <button class="secondary compact" disabled=${shown.first === 0} onClick=${to(shown.first - rows)}>‹</button>
      <span class="dim">States ${whole(shown.first + 1)} to ${whole(end)} of ${whole(shown.states)}</span>
      <button class="secondary compact" disabled=${end >= shown.states} onClick=${to(end)}>›</button>
    </div>
  `;
}
