// Which step is looked at: that of the stage, or one that is chosen here.
import { useEffect } from "preact/hooks";
import { setStage } from "../../../js/actions.js";
import { t, whole } from "../../../js/format.js";
import { canPlay, shownRun } from "../../../js/on-stage.js";
import { followChosenState } from "../posture.js";
import { isOwn } from "../../../js/player.js";
import { scene } from "../../../js/store.js";
import { chosenLane, chooseStep, followMoment, followStage, isFollowing, lastStep } from "../steps.js";
import { messageOf } from "../../../js/titles.js";
import { html, Icon, Segments } from "../../../js/components/elements.js";

/** @import { Moment } from "../steps.js" */

/** Number of the open tabs that show the moment. */
let users = 0;
/** @type {(() => void) | null} */
let stop = null;

/** Keep the explanation, the table and the ghost of the moment while any tab that shows them is open. */
export const useMoment = () => useEffect(() => {
  users += 1;
  if (stop === null) {
    const stops = [followMoment(), followChosenState()];
    stop = () => stops.forEach((end) => end());
  }
  return () => {
    users -= 1;
    // Not yet: the next tab may show it, too.
    setTimeout(() => {
      if (users > 0) return;
      stop?.();
      stop = null;
    });
  };
}, []);

/** @param {{ at: Moment }} props */
export function Navigator({ at }) {
  const { step } = at;
  const last = lastStep.value;
  const lanes = scene.value?.lanes ?? [];
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
        ? html`<span class="dim">${isOwn.value ? t("It follows the replay.") : t("It follows the stage.")}</span>`
        : html`
          <button class="secondary compact" onClick=${followStage}>
            ${isOwn.value ? t("Follow the replay") : t("Follow the stage")}
          </button>
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
  return html`
    <button class="secondary compact" onClick=${seek}>
      <${Icon} name="play" /> ${isOwn.value ? t("Show in the replay") : t("Show on the stage")}
    </button>
  `;
}

// ---- an answer that is not there

export const Waiting = () => html`
  <p role="status"><span class="spinner" aria-hidden="true"></span> The learner is built again…</p>
`;

/** @param {{ error: Error | null, again: boolean }} props */
export const Trouble = ({ error, again }) => error && (again
  ? html`<p class="dim" role="status"><span class="spinner" aria-hidden="true"></span> ${messageOf(error)}</p>`
  : html`<p class="problem" role="alert"><span>${messageOf(error)}</span></p>`);
