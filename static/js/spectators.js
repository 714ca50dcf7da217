// The form on a spectator's page: the settings of the run that is shown, or other ones, which only "What if?" tries.
import { batch, computed, effect, untracked } from "@preact/signals";
import { copySettings } from "./actions.js";
import { isChanged, isReadOnly, readQuery, unknownParts, writeAddress } from "./form.js";
import { shownRun, trainingIds } from "./selectors.js";
import { options, role, runs } from "./store.js";

const isSpectator = computed(() => options.value !== null && role.value === "spectator");

/** What decides the settings of the run that is shown: the run, which of its trainings are known, and changes. */
const version = computed(() => {
  const run = shownRun.value;
  if (!run || run.kind === "experiment") return null;
  const known = [run, ...trainingIds(run).flatMap((id) => runs.value.get(id) ?? [])];
  return known.map(({ id, changes = [] }) => `${id} ${changes?.length ?? 0}`).join();
});

/** Let spectators change the form. */
export function tryOwnSettings() {
  isReadOnly.value = false;
  writeAddress();
}

/** Let the form show the settings of the run that is shown, whichever that is. */
export const showStageSettings = () => (isReadOnly.value = true);

/** Keep a spectator's form as the run that is shown has it, unless a link or the spectator says otherwise. */
export function followStageSettings() {
  effect(() => {
    if (!isSpectator.value) isReadOnly.value = false;
    else if (!untracked(() => isChanged.value || unknownParts.value.length)) isReadOnly.value = true;
  });
  effect(() => {
    const hasSettings = version.value !== null;
    if (!isReadOnly.value) return;
    untracked(() => batch(() => {
      readQuery(new URLSearchParams());
      if (hasSettings && shownRun.value) copySettings(shownRun.value);
      writeAddress();
    }));
  });
}
