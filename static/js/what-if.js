// What if one practised like this? Thirty ideal robots try the form's settings, thirty the defaults.
import { computed, effect, signal } from "@preact/signals";
import * as api from "./api.js";
import { form, mistakes, whatIfBody } from "./form.js";
import { isOperator } from "./selectors.js";

/** More practice than this takes longer than one would wait. */
export const MOST_STEPS = 2000;
/** So long after the last change a slider counts as released. */
const QUIET_MS = 300;

/** Whether the panel is unfolded: nothing is computed for one that nobody sees. */
export const isWatched = signal(false);
/** What is known: {settings, seeds, greedy_m, chosen, default} or null. */
export const answer = signal(null);
export const error = signal(null);
/** Whether thirty robots practise right now. */
export const isTrying = signal(false);

const settings = computed(() => JSON.stringify(whatIfBody(form.value)));
export const isTooLong = computed(() => form.value.steps > MOST_STEPS);
/** Whether what is shown is of the form as it is. */
export const isCurrent = computed(() => answer.value?.settings === settings.value);

const mayAsk = () =>
  isOperator.value && isWatched.value && !isTooLong.value && Object.keys(mistakes.value).length === 0;

let missed = false;

/** Try the form as it is; one at a time, and what was moved meanwhile comes next. */
export async function tryOut() {
  if (isTrying.peek()) {
    missed = true;
    return;
  }
  isTrying.value = true;
  missed = false;
  const asked = settings.peek();
  try {
    const found = await api.whatIf(JSON.parse(asked));
    answer.value = { ...found, settings: asked };
    error.value = null;
  } catch (problem) {
    error.value = asked === settings.peek() ? problem : null;
  } finally {
    isTrying.value = false;
  }
  if (missed && mayAsk() && !isCurrent.peek()) tryOut();
}

/** From now on, try out what the form says each time it comes to rest. */
export function followWhatIf() {
  let known = settings.peek();
  let timer = 0;
  effect(() => {
    const now = settings.value;
    const may = mayAsk();
    clearTimeout(timer);
    if (now === known || !may) return;
    timer = setTimeout(() => {
      known = now;
      if (!isCurrent.peek()) tryOut();
    }, QUIET_MS);
  });
}
