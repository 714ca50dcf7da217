// Notes over the picture of a run: what ended and how to go on, and what comes next. Loaded with the first of them.
import { useEffect, useState } from "preact/hooks";
import { nameOf, t } from "../format.js";
import { keepWatching, pending, resumeRun, stay } from "../actions.js";
import { narrative } from "../headline.js";
import { isDecided, isStale } from "../on-stage.js";
import { isOwn, playback } from "../player.js";
import { isOperator } from "../selectors.js";
import { isAway, runs } from "../store.js";
import { isAtLeast } from "../workspace.js";
import { html, Icon } from "./elements.js";
import { Problem } from "./foot.js";

export const StageNotes = () => html`<${EarlyEndNote} /><${DecidedNote} /><${AnnouncementNote} />`;

/** Of a run on stage that ended early: where, and how to go on. */
function EarlyEndNote() {
  const { note } = narrative.value;
  if (!note) return null;
  const { what, words, action } = note;
  // What a person has stopped is not what is to be pressed next; what a crash has ended is.
  const style = action?.run.state === "stopped" ? "secondary" : "primary";
  return html`
    <div class="stage-note" role="status">
      <p><b>${what}</b> ${words}</p>
      ${action && html`
        <button class=${`${style} compact`} disabled=${pending.value[action.run.id]}
          onClick=${() => resumeRun(action.run)}>
          <${Icon} name="play" />${action.label}
        </button>
        <${Problem} at=${action.run.id} />
      `}
    </div>
  `;
}

/** At the photo finish, while other lanes still walk. */
const DecidedNote = () => isDecided.value && !isStale.value && isAtLeast("try") && isOperator.value &&
  !isOwn.value && playback.value?.end_at_time_out && html`
    <button class="secondary compact" onClick=${keepWatching} title="Some robots still walk">Keep watching</button>
  `;

/** The race that the stage shows again by itself. */
function AnnouncementNote() {
  const announced = isAway.value ? null : playback.value?.announced ?? null;
  const [left, setLeft] = useState(0);
  useEffect(() => {
    if (!announced) return undefined;
    const end = performance.now() + 1000 * announced.in_s;
    const count = () => setLeft(Math.max(0, Math.ceil((end - performance.now()) / 1000)));
    count();
    const timer = setInterval(count, 250);
    return () => clearInterval(timer);
  }, [announced]);
  if (!announced) return null;
  const run = runs.value.get(announced.run_id);
  const name = run ? nameOf(run) : t("a race");
  const what = announced.run_id === playback.value?.run_id ? t("the same again") : t("{name}, again", { name });
  return html`
    <div class="stage-note">
      <p role="status">Next: ${what}</p>
      <p class="dim num" aria-hidden="true">in ${left} s</p>
      ${isOperator.value && isAtLeast("try") && html`
        <button class="secondary compact" onClick=${stay}>Stay</button>
      `}
    </div>
  `;
}
