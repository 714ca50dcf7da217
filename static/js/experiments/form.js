// The form of a new experiment. Only values that differ from the experiment's defaults are kept and sent.
import { computed, signal } from "@preact/signals";
import { withMistake } from "../form.js";
import { presetOf } from "../selectors.js";
import { learns, settingsOf, valueOf } from "../settings.js";
import { options } from "../store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { ExperimentKind, ExperimentValue, ExperimentValues, SettingOption, SettingValue } from "../types.js" */

// ---- the experiments that the server offers

/** Every kind of experiment, robots by the names of their presets. @type {{ value: ExperimentKind[] }} */
export const experiments = computed(() =>
  (options.value?.experiments ?? []).map((kind) => {
    const robots = kind.defaults.robots.map((robot) => presetOf(robot) ?? "");
    return { ...kind, defaults: { ...kind.defaults, name: "", robots } };
  }),
);

/** The kind of a name, else the first. @type {(name: string) => ExperimentKind} */
export const experimentOf = (name) =>
  experiments.value.find((one) => one.name === name) ?? experiments.value[0];

// ---- the number of trials, counted before they are started

const PLACE_FIELDS = ["gaits", "observations", "robots", "divisions", "grid_side_m"];
const PRACTICE_FIELDS = ["steps", "steps_per_episode"];

/**
 * Fields without a value, where each agent has its own default, count once.
 * @type {(values: ExperimentValues, fields: string[]) => number}
 */
const combinations = (values, fields) =>
  fields.reduce((total, field) => total * Math.max(1, /** @type {unknown[]} */ (values[field] ?? []).length), 1);

/**
 * Learners have one trial per seed, agents that look ahead one in all; greedy is always tried for comparison.
 * Table 1 has two-step and a race that measures decision times besides.
 * @param {string} experiment
 * @param {ExperimentValues} values
 */
function countTrials(experiment, values) {
  const places = combinations(values, PLACE_FIELDS);
  if (experiment === "table1") return places * (2 + values.steps.length * values.seeds + 1);
  const perPlace = [...new Set(["greedy", ...values.agents])].map((agent) => {
    const own = combinations(values, Object.keys(settingsOf([agent])));
    return learns(agent) ? own * combinations(values, PRACTICE_FIELDS) * values.seeds : own;
  });
  return places * perPlace.reduce((total, one) => total + one, 0);
}

// ---- the form

/** Empty: the first one that the server offers. */
const chosenName = signal("");
/** Field → value that differs from the default. @type {Signal<Record<string, ExperimentValue>>} */
export const overrides = signal({});
/** Field → why its text is not valid. @type {Signal<Record<string, string>>} */
export const mistakes = signal({});

export const chosenExperiment = computed(() => experimentOf(chosenName.value));

/** The settings of all agents by name. */
const everySetting = computed(() => settingsOf((options.value?.agents ?? []).map(({ name }) => name)));

const chosenAgents = computed(() => {
  const kind = chosenExperiment.value;
  const given = kind.fields.includes("agents") ? overrides.value.agents : null;
  return /** @type {string[]} */ (given ?? kind.defaults.agents);
});

/** The settings of the chosen agents that the experiment varies, by name. */
export const agentSettings = computed(() => {
  const own = Object.entries(settingsOf(chosenAgents.value));
  return Object.fromEntries(own.filter(([name]) => chosenExperiment.value.fields.includes(name)));
});

/** @param {string} field */
export const takesField = (field) =>
  field === "name" ||
  (chosenExperiment.value.fields.includes(field) && (!(field in everySetting.value) || field in agentSettings.value));

/** A setting's default for the chosen agents; empty if each has its own. @type {(name: string) => SettingValue[]} */
function defaultOf(name) {
  const own = chosenAgents.value.map((agent) => settingsOf([agent])[name]).filter(Boolean);
  const found = [...new Set(own.map((setting) => setting.default))];
  return found.length === 1 ? found : [];
}

/** The experiment's defaults, with those of the settings of its agents. */
export const defaults = computed(() => {
  const own = Object.keys(agentSettings.value).map((name) => [name, defaultOf(name)]);
  return /** @type {ExperimentValues} */ ({ ...chosenExperiment.value.defaults, ...Object.fromEntries(own) });
});

/** The values that the experiment would be started with. */
export const values = computed(() => {
  const own = Object.entries(overrides.value).filter(([field]) => takesField(field));
  return /** @type {ExperimentValues} */ ({ ...defaults.value, ...Object.fromEntries(own) });
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
  const isDefault = String(value) === String(defaults.value[field] ?? "");
  overrides.value = isDefault ? others : { ...others, [field]: value };
}

/** @type {(field: string, message: string | null) => void} */
export const setMistake = (field, message) => (mistakes.value = withMistake(mistakes.value, field, message));

/** The request's body. @returns {Record<string, ExperimentValue>} */
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
  for (const kind of experiments.value) {
    for (const field of ["name", ...kind.fields]) {
      const given = query.get(field);
      const value = given === null ? undefined : parse(given, kind.defaults[field], everySetting.value[field]);
      if (value !== undefined) found[field] = value;
    }
  }
  overrides.value = found;
}

/**
 * A text as a value of the type that the default has, or as a list of values of an agent's setting; undefined for
 * text that is no such value.
 * @param {string} text
 * @param {ExperimentValue | undefined} standard
 * @param {SettingOption} [setting]
 * @returns {ExperimentValue | undefined}
 */
export function parse(text, standard, setting) {
  if (typeof standard === "string") return text;
  if (typeof standard === "number") return /^\d+$/.test(text) ? Number(text) : undefined;
  const parts = text.split(",").filter((part) => part.trim() !== "");
  const isNumeric = typeof standard?.[0] === "number";
  const list = parts.map((part) => (setting ? valueOf(part.trim(), setting) : isNumeric ? Number(part) : part));
  const isValid = list.length > 0 && !list.some((one) => one === undefined || Number.isNaN(one));
  return isValid ? /** @type {SettingValue[]} */ (list) : undefined;
}
