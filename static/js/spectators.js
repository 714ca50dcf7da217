// The form on a spectator's page follows the run that is shown. Loaded on spectators' pages only.
import { batch, computed, effect, untracked } from "@preact/signals";
import { copySettings } from "./actions.js";
import { isReadOnly, stageTexts } from "./form.js";
import { shownRun } from "./on-stage.js";
import { isWalk, trainingIds } from "./selectors.js";
import { runs } from "./store.js";

/** Key of the settings of the run that is shown: the run, which of its trainings are known, and changes. */
const version = computed(() => {
  const run = shownRun.value;
  if (!run || !isWalk(run)) return null;
  const shownRuns = [run, ...trainingIds(run).flatMap((id) => runs.value.get(id) ?? [])];
  return shownRuns.map(({ id, changes }) => `${id} ${changes?.length ?? 0}`).join();
});

let isFollowing = false;

/** Keep the form as the run that is shown has it, unless a link or the spectator says otherwise. */
export function followStageSettings() {
  if (isFollowing) return;
  isFollowing = true;
  effect(() => {
    const hasSettings = version.value !== null;
    if (!isReadOnly.value) return;
    untracked(() => batch(() => {
      stageTexts.value = new URLSearchParams();
      if (hasSettings && shownRun.value) copySettings(shownRun.value);
    }));
  });
}
