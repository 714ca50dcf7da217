// What-if: kinematic trials of the settings of the draft, beside trials of the defaults.
import { computed, effect, signal } from "@preact/signals";
import * as api from "../../js/api.js";
import { isReadOnly, mistakes, trainingBody } from "../../js/form.js";
import { limitsOf } from "../../js/settings.js";
import { options, role } from "../../js/store.js";
import { differences, draft, triedValue } from "./draft.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../js/api.js" */
/** @import { WhatIfAnswer } from "../../js/types.js" */

/** A slider that has not moved for so long counts as released. */
const QUIET_MS = 300;

/** The newest answer, and the settings that it is for. @type {Signal<(WhatIfAnswer & { settings: string }) | null>} */
export const answer = signal(null);
/** @type {Signal<RequestError | null>} */
export const error = signal(null);
/** Whether a request is under way. */
export const isComputing = signal(false);

/** Fields of a practice on which ideal robots that never turn do not depend. */
const IGNORED = new Set([
  "simulator", "world", "disturbances", "tolerance", "reward", "name", "seed", "evaluate_every", "pace",
]);

/** Request body of a what-if: the form's practice with the draft, but for what the answer does not depend on. */
export function whatIfBody() {
  const body = trainingBody();
  const { steps = body.steps, ...tried } = draft.value;
  const settings = { .../** @type {object} */ (body.settings), ...tried };
  return Object.fromEntries(Object.entries({ ...body, steps, settings }).filter(([field]) => !IGNORED.has(field)));
}

const settings = computed(() => JSON.stringify(whatIfBody()));
/** The most steps of practice that the server tries; null without a limit. */
export const mostSteps = computed(() => limitsOf("what_if_steps").maximum);
export const isTooLong = computed(() => mostSteps.value !== null && triedValue("steps") > mostSteps.value);
/** Number of seeds of an answer. */
export const seeds = computed(() => options.value?.defaults.what_if.seeds ?? 0);
/** Whether the answer is for the settings as they are. */
export const isCurrent = computed(() => answer.value?.settings === settings.value);

/** A form that follows the stage would ask from every page at once. */
const canAsk = () => role.value !== null && (!isReadOnly.value || differences.value.length > 0) && !isTooLong.value &&
  Object.keys(mistakes.value).length === 0;

let hasMissed = false;

/** Request an answer for the settings; one request at a time, the newest settings next. */
export async function evaluateSettings() {
  if (isComputing.peek()) {
    hasMissed = true;
    return;
  }
  isComputing.value = true;
  hasMissed = false;
  const wanted = settings.peek();
  try {
    const result = await api.call("POST", "what-if", JSON.parse(wanted));
    answer.value = { ...result, settings: wanted };
    error.value = null;
  } catch (problem) {
    error.value = wanted === settings.peek() ? /** @type {RequestError} */ (problem) : null;
  } finally {
    isComputing.value = false;
  }
  if (hasMissed && canAsk() && !isCurrent.peek()) evaluateSettings();
}

/**
 * Request an answer now, unless they are those of the stage, and each time they have come to rest as others, until
 * the function that is returned is called.
 */
export function followWhatIf() {
  let answeredKey = "";
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const stop = effect(() => {
    const now = settings.value;
    const isAllowed = canAsk();
    clearTimeout(timer);
    if (now === answeredKey || !isAllowed) return;
    const isFirst = answeredKey === "";
    timer = setTimeout(() => {
      answeredKey = now;
      if (!isCurrent.peek()) evaluateSettings();
    }, isFirst ? 0 : QUIET_MS);
  });
  return () => {
    clearTimeout(timer);
    stop();
  };
}
