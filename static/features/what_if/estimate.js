// Estimated duration of the run that the form would start, told before a long start.
import { computed, effect, signal } from "@preact/signals";
import * as api from "../../js/api.js";
import { form, mistakes, raceBody } from "../../js/form.js";
import { aboutDuration } from "../../js/format.js";
import { isOperator } from "../../js/selectors.js";
import { learns } from "../../js/settings.js";
import { connection } from "../../js/store.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { Estimate } from "../../js/types.js" */

/** A start that takes longer is told of. */
const LONG_S = 20;
/** A form that has not changed for so long is asked about. */
const QUIET_MS = 600;

/** Request of a start. @typedef {{ path: string, body: object }} Start */

/**
 * Ask how long a start takes, each time it has come to rest as another one.
 * @param {ReadonlySignal<Start | null>} start null while it cannot be, or is surely short
 * @returns {ReadonlySignal<Estimate | null | undefined>} undefined while it is asked, null where it is not known
 */
export function makeAnswer(start) {
  const key = computed(() => (connection.value === "live" && start.value ? JSON.stringify(start.value) : ""));
  /** @type {Signal<{ key: string, told: Estimate | null }>} */
  const answer = signal({ key: "", told: null });
  let newest = Promise.resolve();
  effect(() => {
    const wantedKey = key.value;
    if (!wantedKey) return undefined;
    const isWanted = () => wantedKey === key.peek();
    const ask = async () => {
      const { path, body } = JSON.parse(wantedKey);
      // Without an answer nothing is told: the start itself says what is wrong.
      const told = await api.patiently(() => api.call("POST", `${path}/estimate`, body), isWanted).catch(() => null);
      if (isWanted()) answer.value = { key: wantedKey, told };
    };
    // One request at a time: each may hold a thread of the server.
    const timer = setTimeout(() => (newest = newest.then(ask)), QUIET_MS);
    return () => clearTimeout(timer);
  });
  return computed(() => {
    if (!key.value) return null;
    const { key: asked, told } = answer.value;
    return asked === key.value ? told : undefined;
  });
}

/**
 * How long a start takes, in words; empty while it is short or not known.
 * @param {ReadonlySignal<Start | null>} start null while it cannot be, or is surely short
 * @returns {ReadonlySignal<string>}
 */
export function makeEstimate(start) {
  const answer = makeAnswer(start);
  return computed(() => {
    const seconds = answer.value?.seconds ?? 0;
    return seconds > LONG_S ? `Takes ${aboutDuration(seconds)} on this machine.` : "";
  });
}

/** Steps below which a start is surely short: of learners together, and of lanes that look ahead. */
const SHORT_PRACTICE = 2000;
const SHORT_RACE = 200;

/** Whether the form's race may take long. */
const mayBeLong = computed(() => {
  const { steps, lanes, race_steps, divisions, pace } = form.value;
  const learners = lanes.filter(learns).length;
  const isFine = divisions > 2 && learners < lanes.length;
  return learners * steps > SHORT_PRACTICE || race_steps > SHORT_RACE || isFine || pace !== "max";
});

/** Estimated duration of the form's practice and race, in words. */
export const raceEstimate = makeEstimate(computed(() => {
  const isValid = Object.keys(form.value).length > 0 && Object.keys(mistakes.value).length === 0;
  return isValid && isOperator.value && mayBeLong.value ? { path: "races", body: raceBody() } : null;
}));
