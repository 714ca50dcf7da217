// What one can do next: one primary button, and what runs already.
import { useState } from "preact/hooks";
import {
  canStart, doNext, goOn, nextDeed, otherDeeds, pause, pending, resume, showOnStage, stop,
} from "../actions.js";
import { form } from "../form.js";
import { count, whole } from "../format.js";
import { html } from "../html.js";
import { isNarrow } from "../page.js";
import { progress } from "../progress.js";
import { agentOf, interruptedRun, isOperator, myWork, offStage, shownRun, work } from "../selectors.js";
import { options, scene } from "../store.js";
import { Icon } from "./icon.js";
import { Problem } from "./problem.js";
import { ProgressBar } from "./progress-bar.js";
import { Settings } from "./settings.js";

export function Controls() {
  if (!isOperator.value) return html`<${WatchOnly} />`;
  // On a phone the button comes first. Keys, so that turning it loses nothing that is unfolded.
  const deeds = html`<${Deeds} key="deeds" />`;
  const settings = html`<${FoldedSettings} key="settings" />`;
  return html`
    <section class="panel controls" aria-label="Train and race">
      ${isNarrow.value ? [deeds, settings] : [settings, deeds]}
    </section>
  `;
}

/** On a phone the settings are one line, until they are asked for. */
function FoldedSettings() {
  const [isOpen, setOpen] = useState(false);
  const { gait, steps, alpha, gamma } = form.value;
  const chosen = options.value?.gaits?.find(({ name }) => name === gait);
  const onToggle = ({ target }) => isNarrow.value && setOpen(target.open);
  return html`
    <details class="folded" open=${isOpen || !isNarrow.value} onToggle=${onToggle}>
      <summary hidden=${!isNarrow.value}>
        <span>Settings</span>
        <span class="dim">${chosen?.title ?? gait}, ${count(steps, "step")}, α ${alpha}, γ ${gamma}</span>
      </summary>
      <${Settings} />
    </details>
  `;
}

function Deeds() {
  const isBusy = Boolean(myWork.value) || pending.value.start;
  const label = isBusy ? busyLabel() : nextDeed.value.label;
  return html`
    <div class="deeds">
      <button class="primary" aria-disabled=${canStart.value && !isBusy ? undefined : "true"} onClick=${doNext}>
        ${!isBusy && html`<${Icon} name="play" />`}${label}
      </button>
      <${Problem} at="start" />
      ${!myWork.value && html`<${Others} />`}
      <${Progress} />
      ${work.value && html`<${Running} />`}
      <${Problem} at="work" />
      <${Problem} at="tune" />
      <${OffStage} />
      <${Failure} />
      <${Interrupted} />
    </div>
  `;
}

const busyLabel = () => {
  const { asked, now } = myWork.value ?? {};
  if (!now) return "Starting…";
  if (now.state === "paused") return "Paused";
  if (now.kind === "training" || scene.value?.kind === "training") return asked.kind === "training" ? "Practising…" : "Practising, then racing…";
  return "Racing…";
};

const Others = () => html`
  <div class="row">
    ${otherDeeds.value.map(([label, deed]) => html`
      <button class="secondary" onClick=${deed} aria-disabled=${canStart.value ? undefined : "true"}>${label}</button>
    `)}
  </div>
`;

function Running() {
  const { now } = work.value;
  const isPaused = now.state === "paused";
  return html`
    <div class="row">
      <button class="secondary" onClick=${isPaused ? resume : pause} disabled=${now.state === "queued"}>
        <${Icon} name=${isPaused ? "play" : "pause"} />${isPaused ? "Resume" : "Pause"}
      </button>
      <button class="secondary" onClick=${stop}><${Icon} name="stop" />Stop</button>
    </div>
  `;
}

function Progress() {
  const shown = progress.value;
  if (!shown) return null;
  return html`
    <div class="progress">
      <p><span>${shown.label}</span><span class="dim">${shown.left}</span></p>
      <${ProgressBar} label=${shown.label} share=${shown.share} />
    </div>
  `;
}

function OffStage() {
  const run = offStage.value;
  if (!run) return null;
  return html`
    <div class="notice">
      <p>Another run is live on the stage, so yours goes on without a picture.</p>
      <button class="secondary" onClick=${() => showOnStage(run)}>Show on stage</button>
      <${Problem} at=${run.id} />
    </div>
  `;
}

function Failure() {
  const run = shownRun.value;
  if (run?.state !== "failed") return null;
  return html`
    <div class="notice bad">
      <p><b>The ${run.kind} failed.</b> ${run.error}</p>
      <p>Change what it names, or let it go on from what it has kept; everything else runs.</p>
      ${run.can_resume && html`
        <button class="secondary" disabled=${pending.value[run.id]} onClick=${() => goOn(run)}>Go on</button>
        <${Problem} at=${run.id} />
      `}
    </div>
  `;
}

function Interrupted() {
  const run = interruptedRun.value;
  if (!run) return null;
  const { done, total } = run.progress;
  const where = run.kind === "training" ? ` at step ${whole(done)} of ${whole(total)}` : "";
  return html`
    <div class="notice">
      <p><b>The ${run.kind} was interrupted${where}.</b> ${run.error}</p>
      <button class="secondary" disabled=${pending.value[run.id]} onClick=${() => goOn(run)}>Go on</button>
      <${Problem} at=${run.id} />
    </div>
  `;
}

/** What a spectator has in place of the controls. */
function WatchOnly() {
  const shown = progress.value;
  const names = (shownRun.value?.config?.lanes ?? []).map(({ agent }) => agentOf(agent).title);
  return html`
    <section class="panel" aria-label="What is happening">
      <h2>You are watching</h2>
      <p class="dim">${names.length ? `${names.join(", ")} race. ` : ""}The camera is yours; whoever has the operator’s link runs the show.</p>
      ${shown && html`<${Progress} />`}
    </section>
  `;
}
