// The form of a new experiment. Only values that differ from the experiment's defaults are kept and sent.
import { computed, signal } from "@preact/signals";
import { withMistake } from "../form.js";
import { countTrials } from "./trials.js";
import { experimentOf, experiments } from "./catalogue.js";

/** @import { Signal } from "@preact/signals" */
/** @import { ExperimentValue, ExperimentValues } from "../types.js" */

/** Empty: the first one that the server offers. */
const chosenName = signal("");
/** Field → value that differs from the default. @type {Signal<Record<string, ExperimentValue>>} */
export const overrides = signal({});
/** Field → why its text is not valid. @type {Signal<Record<string, string>>} */
export const mistakes = signal({});

export const chosenExperiment = computed(() => experimentOf(chosenName.value));

/** @param {string} field */
export const takesField = (field) => field === "name" || chosenExperiment.value.fields.includes(field);

/** The values that the experiment would be started with. */
export const values = computed(() => {
  const own = Object.entries(overrides.value).filter(([field]) => takesField(field));
  return /** @type {ExperimentValues} */ ({ ...chosenExperiment.value.defaults, ...Object.fromEntries(own) });
});

/** The number of trials that it would have. */
export const trials = computed(() => countTrials(chosenExperiment.value.name, values.value));

/** @param {string} name */
export function chooseExperiment(name) {
  chosenName.value = name;
  mistakes.value = {};
}

/**
 * @param {string} field
 * @param {ExperimentValue} value
 */
export function setField(field, value) {
  const { [field]: _, ...others } = overrides.value;
  const isDefault = String(value) === String(chosenExperiment.value.defaults[field] ?? "");
  overrides.value = isDefault ? others : { ...others, [field]: value };
}

/** @type {(field: string, message: string | null) => void} */
export const setMistake = (field, message) => (mistakes.value = withMistake(mistakes.value, field, message));

/** The request's body. */
export function requestBody() {
  const own = Object.entries(overrides.value).filter(([field, value]) => takesField(field) && value !== "");
  return { experiment: chosenExperiment.value.name, ...Object.fromEntries(own) };
}

/** The form as parameters of an address: [name, value]. */
export const toQuery = () => [
  ...(chosenExperiment.value === experiments.value[0] ? [] : [["experiment", chosenExperiment.value.name]]),
  ...Object.entries(overrides.value).map(([field, value]) => [field, String(value)]),
];

/**
 * Set the form from the parameters of an address; unreadable values are skipped.
 * @param {URLSearchParams} query
 */
export function readQuery(query) {
  chosenName.value = query.get("experiment") ?? "";
  /** @type {Record<string, ExperimentValue>} */
  const found = {};
  for (const { fields, defaults } of experiments.value) {
    for (const field of ["name", ...fields]) {
      const given = query.get(field);
      const value = given === null ? undefined : parse(given, defaults[field]);
      if (value !== undefined) found[field] = value;
    }
  }
  overrides.value = found;
}

/**
 * A text as a value of the type that the default has; undefined for text that is no such value.
 * @param {string} text
 * @param {ExperimentValue} standard
 * @returns {ExperimentValue | undefined}
 */
export function parse(text, standard) {
  if (typeof standard === "string") return text;
  if (typeof standard === "number") return /^\d+$/.test(text) ? Number(text) : undefined;
  const parts = text.split(",").filter((part) => part.trim() !== "");
  const list = typeof standard[0] === "number" ? parts.map(Number) : parts;
  return list.length && !list.some(Number.isNaN) ? list : undefined;
}
