// Announces the end of the experiment in view to screen readers.
import { effect } from "@preact/signals";
import { isActive } from "../selectors.js";
import { announcement } from "../outcome.js";
import { chosenRun } from "./selection.js";
import { runTitle } from "./titles.js";

/** @import { Run } from "../types.js" */

export function announceExperiments() {
  /** @type {Run | null} */
  let before = null;
  effect(() => {
    const run = chosenRun.value;
    if (run && before?.id === run.id && isActive(before) && !isActive(run)) {
      announcement.value = `${runTitle(run)} is ${run.state}. ${run.error ?? ""}`;
    }
    before = run;
  });
}
