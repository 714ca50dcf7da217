// The foot of the panel: the primary button, the running work, what failed, and what a spectator can do.
import {
  canStart, dismissProblem, missingLane, pending, primaryAction, problems, runPrimaryAction, secondaryActions,
} from "../actions.js";
import { chooseLearner, form, mistakes, isReadOnly } from "../form.js";
import { percentage, t } from "../format.js";
import { ignored, page } from "../page-state.js";
import { isFootOpen, isPhone } from "../page.js";
import { interruptedRun, myWork, offStage, progress, shownRun, work } from "../on-stage.js";
import { isGuest, mayStart } from "../selectors.js";
import { agentOf, learners, placeOf } from "../settings.js";
import { isAway, scene } from "../store.js";
import { labelOf, messageOf } from "../titles.js";
import { isAtLeast, openTab, setDepth, tab } from "../workspace.js";
import { goToField, html, Icon, ProgressBar, UnknownParts } from "./elements.js";
import { Loaded, Slot } from "../features.js";

export const Foot = () => (mayStart.value ? html`<${Actions} />` : html`<${Spectator} />`);

const isAtWork = () => Boolean(myWork.value) || Boolean(pending.value.start);

function Actions() {
  const isBusy = isAtWork();
  // As it is by default it is short.
  const isChanged = page.form.value.size > 0;
  return html`
    <div class="actions" role="group" aria-label="Actions">
      ${hasNotices() && html`<${Loaded} name="notices" load=${loadNotices} isQuiet />`}
      <${Problem} at="start" />
      <${Problem} at="work" />
      <${Problem} at="tune" />
      <${UnknownParts} parts=${ignored.query} />
      ${isHeldBack() && html`<${Held} id="held-start" mistakes=${mistakes.value} onField=${showField} />`}
      ${!isBusy && isChanged && !isPhone.value && html`<${Slot} name="estimate" />`}
      ${!isBusy && html`<${MissingLane} />`}
      <${Slot} name="actions" />
      <${WorkActions} />
      ${isAway.value && html`
        <p class="dim" id="held-away">Nothing can be started or stopped until the server is back.</p>
      `}
      ${!myWork.value && !isPhone.value && html`
        <${PrimaryButton} />
        ${hasRoomForOthers() && html`<${SecondaryActions} />`}
      `}
    </div>
  `;
}

/**
 * Focus a field, in the tab and the depth that have it; a setting of another learner of the race has one once that
 * learner is chosen.
 * @param {string} field
 */
function showField(field) {
  const { agent, lanes } = form.value;
  const owner = learners.value.find(({ name, settings }) => lanes.includes(name) && field in settings);
  if (owner && !(field in agentOf(agent).settings)) chooseLearner(owner.name);
  const place = placeOf(field, form.value.agent);
  if (place.isFull) setDepth("study");
  openTab(place.tab);
  goWhenThere(`field-${field}`);
}

/** The tab of a field may be loaded first. */
const LONGEST_WAIT_MS = 5000;

/** Focus a field as soon as it is there. @param {string} id */
function goWhenThere(id, since = performance.now()) {
  requestAnimationFrame(() => {
    if (document.getElementById(id)) goToField(id);
    else if (performance.now() - since < LONGEST_WAIT_MS) goWhenThere(id, since);
  });
}

const busyLabel = () => {
  const { requested, current } = myWork.value ?? {};
  if (!requested || !current) return t("Starting…");
  if (current.state === "paused") return current.kind === "race" ? t("Race paused") : t("Training paused");
  if (current.kind !== "training" && scene.value?.kind !== "training") return t("Racing…");
  return requested.kind === "training" ? t("Practising…") : t("Practising, then racing…");
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

/** Whether a start waits for settings that are not valid. */
const isHeldBack = () => !isAtWork() && Object.keys(mistakes.value).length > 0;

/** The button that starts what comes next, in short where there is little room. @param {{ isShort?: boolean }} props */
function PrimaryButton({ isShort = false }) {
  const isBusy = isAtWork();
  const { label, short } = isBusy ? { label: busyLabel(), short: busyLabel() } : primaryAction.value;
  const isDisabled = isBusy || !canStart.value;
  return html`
    <button class="primary" aria-disabled=${isDisabled ? "true" : undefined} title=${isShort ? label : undefined}
      onClick=${runPrimaryAction}
      aria-describedby=${isAway.value ? "held-away" : isHeldBack() ? "held-start" : undefined}>
      ${!isBusy && html`<${Icon} name="play" />`}${isShort ? short : label}
    </button>
  `;
}

/** On a phone, beside the title: the start, and what opens the foot of the panel, with how far the work is. */
export function FoldedFoot() {
  if (!mayStart.value) return isAtLeast("try") && html`<${FootFold} words="Choices" />`;
  return html`
    ${work.value && html`<${FootFold} words=${percentage(progress.value?.share ?? 0)} of="Progress" />`}
    ${!myWork.value && html`<${PrimaryButton} isShort=${true} />`}
  `;
}

/** @param {{ words: string, of?: string }} props */
const FootFold = ({ words, of = "" }) => html`
  <button class="secondary compact" aria-expanded=${isFootOpen.value ? "true" : "false"} aria-controls="panel-foot"
    onClick=${() => (isFootOpen.value = !isFootOpen.value)}>
    ${of && html`<span class="sr-only">${of}:${" "}</span>`}<span class="num">${words}</span>
  </button>
`;

/** On a phone, below the settings of the next run: how long it takes, and the other ways to start. */
export const OtherStarts = () => mayStart.value && !isAtWork() && html`
  <div class="actions" role="group" aria-label="Other ways to start">
    ${page.form.value.size > 0 && html`<${Slot} name="estimate" />`}
    <${SecondaryActions} />
  </div>
`;

/** The tabs in which runs are prepared. */
const hasRoomForOthers = () => isAtLeast("try") && ["train", "board"].includes(tab.value);

const SecondaryActions = () => html`
  <div class="others">
    ${secondaryActions.value.map(({ label, run }) => html`
      <button class="secondary" aria-disabled=${canStart.value ? undefined : "true"}
        onClick=${() => canStart.peek() && run()}>${label}</button>
    `)}
  </div>
`;

/** What is computed, and for those who try the ways to hold and to end it. */
function WorkActions() {
  if (!work.value) return null;
  return html`
    <${Progress} />${(isAtLeast("try") || isGuest.value) && html`
      <${Loaded} name="buttons of the work" load=${loadButtons} isQuiet />
    `}
  `;
}

const loadButtons = () => import("./work-buttons.js").then(({ WorkButtons }) => WorkButtons);

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

const loadNotices = () => import("./run-notices.js").then(({ RunNotices }) => RunNotices);

/** Whether something of a run is to be told: it was interrupted or failed, or is not on the stage. */
const hasNotices = () => interruptedRun.value !== null || Boolean(offStage.value) || shownRun.value?.state === "failed";

// ---- spectators: what is shown, and what they can do on their own page

const loadOwnChoices = () => import("./own-choices.js").then(({ OwnChoices }) => OwnChoices);

/** In place of the actions on the pages of those who may not start runs. */
function Spectator() {
  return html`
    <section class="actions watching" aria-label="You are watching">
      <${UnknownParts} parts=${ignored.query} />
      ${isReadOnly.value
        ? html`<p class="dim">You are watching. The operator starts runs.</p>`
        : html`
          <p class="dim">Only “What if” tries your settings; the stage goes on as it is.</p>
          <div class="row">
            <button class="secondary compact" onClick=${() => (page.form.value = new URLSearchParams())}>
              Back to the settings of the stage
            </button>
          </div>
        `}
      <${Progress} />
      ${isReadOnly.value && isAtLeast("try") && html`<${Loaded} name="choices" load=${loadOwnChoices} />`}
    </section>
  `;
}

// ---- what went wrong, beside the control that it is about

/** An error, beside the control that caused it. @param {{ at: string }} props */
export function Problem({ at }) {
  const error = problems.value[at];
  return html`
    <div role="alert">
      ${error && html`
        <p class="problem">
          <span>${messageOf(error)}</span>
          <button class="quiet square small" aria-label="Dismiss" onClick=${() => dismissProblem(at)}>✕</button>
        </p>
      `}
    </div>
  `;
}

/**
 * Why the button above is held: each field that is not valid, to go to, and what it must be.
 * @param {object} props
 * @param {string} props.id
 * @param {Record<string, string>} props.mistakes
 * @param {(field: string) => unknown} props.onField
 * @param {(field: string) => string} [props.nameOf]
 */
export const Held = ({ id, mistakes: held, onField, nameOf = labelOf }) => html`
  <ul class="held" id=${id}>
    ${Object.entries(held).map(([field, mistake]) => html`
      <li key=${field}>
        <button class="link" onClick=${() => onField(field)}>${nameOf(field)}</button>: ${mistake}
      </li>
    `)}
  </ul>
`;
