// The form's values, their query string, and the request bodies that they make.
import { computed, signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */
/** @import { FormValues, Options } from "./types.js" */

/**
 * How a field is read from the query string; undefined for text that is no value of it.
 * @typedef {{ read: (text: string) => any, write: (value: any) => string }} FieldType
 */

/** @type {FieldType} */
const text = { read: (given) => given, write: (value) => value };
/** @type {FieldType} */
const number = {
  read: (given) => (given.trim() === "" || !Number.isFinite(Number(given)) ? undefined : Number(given)),
  write: String,
};
/** @type {FieldType} */
const pace = { read: (given) => (given === "max" ? "max" : number.read(given)), write: String };
/** @type {FieldType} */
const names = { read: (given) => given.split(",").filter(Boolean), write: (list) => list.join(",") };

/** Every field, in the order of the query string. @satisfies {Record<keyof FormValues, FieldType>} */
const FIELD_TYPES = {
  gait: text, steps: number, seed: number, observation: text,
  alpha: number, gamma: number, epsilon_start: number, epsilon_end: number,
  steps_per_episode: number, evaluate_every: number, pace,
  robot: text, simulator: text, divisions: number, grid_side_m: number,
  race_steps: number, lanes: names, name: text,
};
const FIELDS = /** @type {(keyof FormValues)[]} */ (Object.keys(FIELD_TYPES));

/** Empty until the server's options have come; no component shows the form before. */
const UNKNOWN = /** @type {FormValues} */ ({});
let defaults = UNKNOWN;

/** @type {Signal<FormValues>} */
export const form = signal(UNKNOWN);
/** Field → why its text is not a valid number; any entry disables the start. @type {Signal<Record<string, string>>} */
export const mistakes = signal({});

/**
 * Change one field, and the address with it.
 * @param {string} field
 * @param {unknown} value
 */
export const setField = (field, value) => {
  form.value = { ...form.value, [field]: value };
  writeAddress();
};

/**
 * A record with a message for a field, or without one.
 * @param {Record<string, string>} messages
 * @param {string} field
 * @param {string | null} message
 */
export function withMistake(messages, field, message) {
  const { [field]: _, ...others } = messages;
  return message ? { ...others, [field]: message } : others;
}

/** @type {(field: string, message: string | null) => void} */
export const setMistake = (field, message) => (mistakes.value = withMistake(mistakes.value, field, message));

/** @type {(values: FormValues, field: keyof FormValues) => string} */
const written = (values, field) => FIELD_TYPES[field].write(values[field]);

const isChanged = computed(() => FIELDS.some((field) => written(form.value, field) !== written(defaults, field)));

/**
 * Reset the form to the server's defaults.
 * @param {Pick<Options, "defaults">} served
 */
export function applyDefaults({ defaults: { training, race } }) {
  const values = { ...training, race_steps: race.steps, lanes: race.lanes.map(({ agent }) => agent), name: "" };
  const { agent: _, ...fields } = values;
  defaults = fields;
  form.value = defaults;
}

/**
 * The whole form as a query string; empty texts are left out.
 * @param {FormValues} values
 */
export const toQuery = (values) =>
  new URLSearchParams(
    FIELDS.map((field) => [field, written(values, field)]).filter(([, value]) => value !== ""),
  );

/**
 * The fields that a query string sets; unreadable values are skipped.
 * @param {URLSearchParams} query
 * @returns {Partial<FormValues>}
 */
export function fromQuery(query) {
  /** @type {Record<string, unknown>} */
  const found = {};
  for (const field of FIELDS) {
    const given = query.get(field);
    const value = given === null ? undefined : FIELD_TYPES[field].read(given);
    if (value !== undefined) found[field] = value;
  }
  return found;
}

/** Set the fields that the page's address contains. */
export function readAddress() {
  form.value = { ...form.value, ...fromQuery(new URLSearchParams(location.search)) };
}

/** Write the form to the page's address; an unchanged form keeps it clean. */
export function writeAddress() {
  const search = isChanged.value ? `?${toQuery(form.value)}` : "";
  history.replaceState(history.state, "", `${location.pathname}${search}${location.hash}`);
}

/** A link to the page with every field of the form. */
export const link = () =>
  form.value === UNKNOWN
    ? location.href
    : `${location.origin}${location.pathname}?${toQuery(form.value)}${location.hash}`;

/** @param {FormValues} values */
const walkBody = ({ gait, robot, simulator, divisions, grid_side_m, name }) => ({
  gait, robot, simulator, divisions, grid_side_m, ...(name.trim() ? { name: name.trim() } : {}),
});

/**
 * @typedef {Omit<FormValues, "gait" | "seed" | "robot" | "simulator" | "divisions" | "grid_side_m" | "race_steps" |
 *   "lanes" | "name"> & { seed?: number, continue_from?: string }} PracticeBody
 */

/**
 * A continued training has no seed of its own: it goes on with its generator.
 * @param {FormValues} values
 * @param {string | null} continueFrom
 * @returns {PracticeBody}
 */
function practiceBody(values, continueFrom) {
  const { steps, seed, observation, alpha, gamma } = values;
  const { epsilon_start, epsilon_end, steps_per_episode, evaluate_every } = values;
  return {
    steps, observation, alpha, gamma, epsilon_start, epsilon_end, steps_per_episode,
    evaluate_every, pace: values.pace, ...(continueFrom ? { continue_from: continueFrom } : { seed }),
  };
}

/**
 * Request body of a training.
 * @param {FormValues} values
 * @param {string | null} continueFrom id of the training whose table it starts with
 */
export const trainingBody = (values, continueFrom = null) =>
  ({ ...walkBody(values), ...practiceBody(values, continueFrom) });

/**
 * Request body of a what-if: the settings of the practice, without seed, pace and simulator.
 * @param {FormValues} values
 */
export function whatIfBody(values) {
  const { gait, robot, divisions, grid_side_m, steps, observation, alpha, gamma } = values;
  const { epsilon_start, epsilon_end, steps_per_episode } = values;
  return {
    gait, robot, divisions, grid_side_m, steps, observation, alpha, gamma, epsilon_start, epsilon_end,
    steps_per_episode,
  };
}

/**
 * Request body of a race. Its learners practise first, continue from a table, or use it as it is.
 * @param {FormValues} values
 * @param {(agent: string) => boolean} learns
 * @param {{ continueFrom?: string | null, table?: string | null }} how ids of trainings
 */
export const raceBody = (values, learns, { continueFrom = null, table = null } = {}) => ({
  ...walkBody(values),
  steps: values.race_steps,
  seed: values.seed,
  lanes: values.lanes.map((agent) => {
    if (!learns(agent)) return { agent };
    if (table) return { agent, training_id: table };
    return { agent, training: practiceBody(values, continueFrom) };
  }),
});
