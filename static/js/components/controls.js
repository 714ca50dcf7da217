// The controls: settings, the primary button, the running work, and what failed.
import { useState } from "preact/hooks";
import {
  canStart, missingLane, pause, pending, primaryAction, resume, resumeRun, runPrimaryAction, secondaryActions,
  showOnStage, stop,
} from "../actions.js";
import { practiseAtPaceOfPicture } from "../live-changes.js";
import { raceEstimate } from "../estimate.js";
import { chooseLearner, form, mistakes, isReadOnly } from "../form.js";
import { count, listed, sentence, whole } from "../format.js";
import { ignored, page } from "../page-state.js";
import { isNarrow } from "../page.js";
import { interruptedRun, myWork, offStage, progress, shownRun, steering, work } from "../on-stage.js";
import { isOperator } from "../selectors.js";
import { agentOf, learners, ratesInWords } from "../settings.js";
import { scene } from "../store.js";
import { gaitTitle, inFormWords, labelOf } from "../titles.js";
import {
  EstimateNote, goToField, Held, html, Icon, Loaded, Problem, ProgressBar, UnknownParts,
} from "./elements.js";
import { Settings } from "./settings.js";
import { Branch, LiveWorld } from "./world-controls.js";

/** @import { Run } from "../types.js" */

export function Controls() {
  if (!isOperator.value) return html`<${Spectator} />`;
  // On a phone the button comes first. Keys keep what is unfolded when the phone is turned.
  const actions = html`<${Actions} key="actions" />`;
  const settings = html`<${FoldedSettings} key="settings" />`;
  return html`
    <section class="panel controls" aria-label="Train and race">
      ${isNarrow.value ? [actions, settings] : [settings, actions]}
    </section>
  `;
}

/** The settings; on a phone one line until they are opened. */
function FoldedSettings() {
  const [isOpen, setOpen] = useState(false);
  const { gait, steps, agent } = form.value;
  const wrong = Object.keys(mistakes.value).map(labelOf);
  const about = wrong.length
    ? [`Not valid: ${listed(wrong)}`]
    : [gaitTitle(gait), count(steps, "step"), agentOf(agent).title, ...ratesInWords(agent, form.value)];
  /** @param {{ target: HTMLDetailsElement }} event */
  const onToggle = ({ target }) => isNarrow.value && setOpen(target.open);
  return html`
    <details class="folded" open=${isOpen || !isNarrow.value} onToggle=${onToggle}
      tabindex=${isReadOnly.value ? "0" : undefined}>
      <summary hidden=${!isNarrow.value}>
        <span>Settings</span>
        <span class="dim">${about.join(", ")}</span>
      </summary>
      <${Settings} />
    </details>
  `;
}

function Actions() {
  const isBusy = Boolean(myWork.value) || pending.value.start;
  const label = isBusy ? busyLabel() : primaryAction.value.label;
  const isDisabled = isBusy || !canStart.value;
  const isHeld = !isBusy && Object.keys(mistakes.value).length > 0;
  return html`
    <div class="actions" role="group" aria-label="Actions">
      <button class="primary" aria-disabled=${isDisabled ? "true" : undefined} onClick=${runPrimaryAction}
        aria-describedby=${isHeld ? "held-start" : undefined}>
        ${!isBusy && html`<${Icon} name="play" />`}${label}
      </button>
      ${isHeld && html`<${Held} id="held-start" mistakes=${mistakes.value} onField=${showField} />`}
      ${!isBusy && html`<${EstimateNote} words=${raceEstimate} />`}
      <${UnknownParts} parts=${ignored.query} />
      <${Problem} at="start" />
      ${!isBusy && html`<${MissingLane} />`}
      ${!myWork.value && html`<${SecondaryActions} />`}
      <${Progress} />
      ${work.value && html`<${WorkActions} />`}
      <${Steering} />
      <${LiveWorld} />
      <${Branch} />
      <${Problem} at="work" />
      <${Problem} at="tune" />
      <${OffStage} />
      <${Failure} />
      <${Interrupted} />
    </div>
  `;
}

/**
 * Focus a field; a setting of another learner of the race has one once that learner is chosen.
 * @param {string} field
 */
function showField(field) {
  const { agent, lanes } = form.value;
  const owner = learners.value.find(({ name, settings }) => lanes.includes(name) && field in settings);
  if (owner && !(field in agentOf(agent).settings)) chooseLearner(owner.name);
  requestAnimationFrame(() => goToField(`field-${field}`));
}

const busyLabel = () => {
  const { requested, current } = myWork.value ?? {};
  if (!requested || !current) return "Starting…";
  if (current.state === "paused") return `${sentence(current.kind)} paused`;
  if (current.kind !== "training" && scene.value?.kind !== "training") return "Racing…";
  return requested.kind === "training" ? "Practising…" : "Practising, then racing…";
};

function MissingLane() {
  const missing = missingLane.value;
  return missing && html`
    <p class="notice">
      <span>${missing.words}</span>
      ${missing.action && html`<button class="link" onClick=${missing.action.run}>${missing.action.label}</button>`}
    </p>
  `;
}

const SecondaryActions = () => html`
  <div class="row">
    ${secondaryActions.value.map(({ label, run }) => html`
      <button class="secondary" onClick=${run} aria-disabled=${canStart.value ? undefined : "true"}>${label}</button>
    `)}
  </div>
`;

function WorkActions() {
  const { kind, state } = work.value?.current ?? {};
  const isPaused = state === "paused";
  // Events tell of a new state before the command is answered; a click in between would be lost.
  // Not `disabled`, by which the button would lose the keyboard's focus.
  const isHeld = pending.value.work ? "true" : undefined;
  return html`
    <div class="row">
      <button class="secondary" onClick=${isPaused ? resume : pause} aria-disabled=${isHeld}
        disabled=${state === "queued"}>
        <${Icon} name=${isPaused ? "play" : "pause"} />${isPaused ? "Resume" : "Pause"} ${kind}
      </button>
      <button class="secondary" onClick=${stop} aria-disabled=${isHeld}>
        <${Icon} name="stop" />Stop
      </button>
    </div>
  `;
}

function Progress() {
  const shown = progress.value;
  if (!shown) return null;
  return html`
    <div class="progress">
      <p><span>${shown.label}</span><span class="dim">${shown.left}</span></p>
      <${ProgressBar} ...${shown} />
    </div>
  `;
}

/** What a live setting acts on while the computation is ahead of the picture: its next step, or the next training. */
function Steering() {
  const state = steering.value;
  if (state === null) return null;
  const isOver = state === "computed";
  const words = isOver
    ? "This training is computed to its end; the picture is still on its way. A change acts on the next training."
    : `A change acts on step ${whole(state.step)}, which is computed next${seenStep(state)}.`;
  return html`
    <div class="steering">
      <p>${words}</p>
      <button class="link" onClick=${practiseAtPaceOfPicture}>
        ${isOver ? "Let the next one practise" : "Practise on"} at the pace of the picture, to steer it
      </button>
    </div>
  `;
}

/** @param {{ shown: number | null }} state */
const seenStep = ({ shown }) => (shown === null ? "; it is not on stage" : `; the picture shows step ${whole(shown)}`);

function OffStage() {
  const run = offStage.value;
  if (!run) return null;
  return html`
    <div class="notice">
      <p>The stage shows another run; your ${run.kind} goes on without a picture.</p>
      <button class="secondary" onClick=${() => showOnStage(run)}>Show on stage</button>
      <${Problem} at=${run.id} />
    </div>
  `;
}

/** @param {{ run: Run }} props */
const ResumeButton = ({ run }) => html`
  <button class="secondary" disabled=${pending.value[run.id]} onClick=${() => resumeRun(run)}>Resume</button>
  <${Problem} at=${run.id} />
`;

function Failure() {
  const run = shownRun.value;
  if (run?.state !== "failed") return null;
  return html`
    <div class="notice bad">
      <p><b>The ${run.kind} failed.</b> ${inFormWords(run.error ?? "")}</p>
      <p>Change what it names, or resume it from its last checkpoint. Other runs are not affected.</p>
      ${run.can_resume && html`<${ResumeButton} run=${run} />`}
    </div>
  `;
}

/** Of the newest run, while another one is on stage: the stage offers to resume its own. */
function Interrupted() {
  const run = interruptedRun.value;
  if (!run) return null;
  const { done, total } = run.progress;
  const where = run.kind === "training" ? ` at step ${whole(done)} of ${whole(total)}` : "";
  return html`
    <div class="notice">
      <p><b>${sentence(run.kind)} “${run.name}” was interrupted${where}; it is not on stage.</b> ${run.error}</p>
      <${ResumeButton} run=${run} />
    </div>
  `;
}

// ---- spectators: every setting, to read or to try

const loadOwnChoices = () => import("./own-choices.js").then(({ OwnChoices }) => OwnChoices);

/** Shown to spectators in place of the controls. */
function Spectator() {
  const kind = shownRun.value?.kind;
  const of = kind ? `the ${kind} that is shown` : "the next run, as they are by default";
  const words = isReadOnly.value
    ? `These are the settings of ${of}. The operator starts runs. On your own page you can:`
    : "Only “What if?” tries these settings; the stage goes on as it is.";
  return html`
    <section class="panel controls" aria-label="Run on stage">
      <div class="watching">
        <h2>You are watching</h2>
        <p class="dim">${words}</p>
        ${progress.value && html`<${Progress} />`}
        ${isReadOnly.value
          ? html`<${Loaded} name="choices" load=${loadOwnChoices} />`
          : html`
            <div class="row">
              <button class="secondary compact" onClick=${() => (page.form.value = new URLSearchParams())}>
                Back to the settings on stage
              </button>
            </div>
          `}
        <${UnknownParts} parts=${ignored.query} />
      </div>
      <${FoldedSettings} />
    </section>
  `;
}
