// The ways to hold and to end what is computed, for those who try. Loaded for them.
import { t } from "../format.js";
import { pause, pending, resume, stop } from "../actions.js";
import { work } from "../on-stage.js";
import { isOperator } from "../selectors.js";
import { isAway } from "../store.js";
import { html, Icon } from "./elements.js";

export function WorkButtons() {
  const { kind, state } = work.value?.current ?? {};
  const labels = kind === "race" ? { pause: t("Pause race"), resume: t("Resume race") }
    : { pause: t("Pause training"), resume: t("Resume training") };
  const isPaused = state === "paused";
  // Events tell of a new state before the command is answered; a click in between would be lost.
  // Not `disabled`, by which the button would lose the keyboard's focus.
  const isHeld = pending.value.work || isAway.value ? "true" : undefined;
  return html`
    <div class="row">
      ${isOperator.value && html`
        <button class="secondary" onClick=${isPaused ? resume : pause} aria-disabled=${isHeld}
          disabled=${state === "queued"}>
          <${Icon} name=${isPaused ? "play" : "pause"} />${isPaused ? labels.resume : labels.pause}
        </button>
      `}
      <button class="secondary" onClick=${stop} aria-disabled=${isHeld}>
        <${Icon} name="stop" />Stop
      </button>
    </div>
  `;
}
