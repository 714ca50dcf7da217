// What the class of a room teaches: its robots, the presses by step, and those of one's own.
import { computed, effect, signal, untracked } from "@preact/signals";
import * as api from "../api.js";
import { isShownToEnd } from "../../../js/narrative/moment.js";
import { connection, scene } from "../../../js/store.js";
import { code, isTeaching, newestTeaching, room } from "./room.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../../js/api.js" */
/** @import { StepPresses, TeachingState } from "../../../js/types.js" */

/** The teaching of the card that is shown; null until it is known, and on other cards. */
/** @type {Signal<TeachingState | null>} */
export const teaching = signal(null);
/** Step → what was pressed on this page for it, 1 or −1. @type {Signal<Record<number, number>>} */
export const ownPresses = signal({});
/** The newest press of this page, which counts them; null before the first. */
/** @type {Signal<{ value: 1 | -1, number: number } | null>} */
export const newestPress = signal(null);
/** Why the newest press does not count; empty if it does. */
export const pressProblem = signal("");

/** Id of the newest race of both robots that this page has shown to its end. @type {Signal<string | null>} */
const racedToEnd = signal(null);
/** Whether the picture has been where it can be told how far both walk. */
export const isTold = computed(() => racedToEnd.value !== null && racedToEnd.value === teaching.value?.race_id);

/**
 * Presses with those that are missing among them, by step: an event and an answer can have the same step.
 * @param {StepPresses[]} presses
 * @param {StepPresses[]} others
 */
export function withPresses(presses, others) {
  const steps = new Set(presses.map(({ step }) => step));
  return [...presses, ...others.filter(({ step }) => !steps.has(step))].sort((a, b) => a.step - b.step);
}

export async function refreshTeaching() {
  if (!isTeaching.peek()) return;
  try {
    const answer = await api.getTeaching(code);
    const shown = teaching.peek();
    const isSameRobot = answer.taught?.run_id === shown?.taught?.run_id;
    if (!isSameRobot) ownPresses.value = {};
    // An event may have come while the answer was on its way.
    teaching.value = isSameRobot ? { ...answer, presses: withPresses(answer.presses, shown?.presses ?? []) } : answer;
  } catch {
    // The next event asks again.
  }
}

effect(() => {
  // Another card, a stop for all, and the reveal: each has more to tell.
  const { card, state, revealed } = room.value ?? {};
  const isNew = isTeaching.value && connection.value === "live" && `${card} ${state} ${revealed}` !== "";
  if (!isTeaching.value) teaching.value = null;
  if (isNew) untracked(refreshTeaching);
});
effect(() => {
  const event = newestTeaching.value;
  if (event === null) return;
  untracked(() => {
    const shown = teaching.peek();
    if (shown === null || event.card !== shown.card || event.presses.length === 0) refreshTeaching();
    else teaching.value = { ...shown, presses: withPresses(shown.presses, event.presses) };
  });
});
effect(() => {
  const id = teaching.value?.race_id ?? null;
  if (id === null || racedToEnd.value === id || !isShownToEnd(scene.value, id)) return;
  // Now it is computed, and so are both distances.
  untracked(refreshTeaching).then(() => (racedToEnd.value = id));
});

/** Press + (1) or − (−1). @param {1 | -1} value @param {number} at_s time of the run in the picture of this page */
export async function press(value, at_s) {
  const run_id = teaching.peek()?.taught?.run_id;
  if (!run_id) return;
  newestPress.value = { value, number: (newestPress.peek()?.number ?? 0) + 1 };
  try {
    const { step } = await api.press(code, { run_id, at_s, value });
    ownPresses.value = { ...ownPresses.peek(), [step]: value };
    pressProblem.value = "";
  } catch (error) {
    pressProblem.value = /** @type {RequestError} */ (error).message;
  }
}

/** How many steps the class has praised, and how many it has rebuked. @param {StepPresses[]} presses */
export const countsOf = (presses) => ({
  praised: presses.filter(({ value }) => value > 0).length,
  rebuked: presses.filter(({ value }) => value < 0).length,
});
