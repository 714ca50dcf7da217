// The form of a new experiment. Only values that differ from the experiment's defaults are kept and sent.
import { batch, computed } from "@preact/signals";
import { isSimulated, parseWorld, splitWorlds } from "../../js/disturbances.js";
import {
  makeTexts, parseChoice, parseChoices, parseName, parseNumber, parseSetting, parseValues,
} from "../../js/parse.js";
import { unknownTo } from "../../js/form.js";
import { ignored, page } from "../../js/page-state.js";
import { customRobotInWords, presetOf } from "../../js/robots.js";
import { learns, limitsOf, settingsOf } from "../../js/settings.js";
import { options, served } from "../../js/store.js";

/** @import { Parsed } from "../../js/parse.js" */
/** @import { ExperimentKind, ExperimentValue, ExperimentValues } from "../../js/types.js" */
/** @import { RobotConfig, Run, SettingValue } from "../../js/types.js" */

// ---- the experiments that the server offers

/** Every kind of experiment, robots by the names of their presets. @type {{ value: ExperimentKind[] }} */
export const experiments = computed(() =>
  (options.value?.experiments ?? []).map((kind) => {
    // The settings have the defaults of the agents that are chosen.
    const { settings: _, robots, ...defaults } = /** @type {ExperimentValues} */ (kind.defaults);
    return { ...kind, defaults: { ...defaults, name: "", robots: robots.map((robot) => presetOf(robot) ?? "") } };
  }),
);

/** The kind of a name, else the first. @type {(name: string) => ExperimentKind} */
export const experimentOf = (name) =>
  experiments.value.find((kind) => kind.name === name) ?? experiments.value[0];

// ---- the number of trials, counted before they are started

const PLACE_FIELDS = ["gaits", "observations", "robots", "divisions", "grid_side_m"];
const NOISE = "sensor-noise";
const PRACTICE_FIELDS = ["steps", "steps_per_episode"];

/**
 * Fields without a value, where each agent has its own default, count once.
 * @type {(values: ExperimentValues, fields: string[]) => number}
 */
const combinations = (values, fields) =>
  fields.reduce((total, field) => total * Math.max(1, /** @type {unknown[]} */ (values[field] ?? []).length), 1);

/**
 * Learners have one trial per seed, agents that look ahead one in all; references are always tried for comparison.
 * @param {ExperimentKind} kind
 * @param {ExperimentValues} values
 */
function countTrials(kind, values) {
  const worlds = /** @type {string[]} */ (values.worlds ?? [""]);
  const inPlace = worlds.reduce((total, world) => total + countInWorld(kind, values, world), 0);
  return combinations(values, PLACE_FIELDS) * (inPlace + (kind.is_timed ? 1 : 0));
}

/**
 * Where robots or their sensors differ by seed, each agent has a trial per seed; where the world or the robots are
 * not the nominal ones, greedy plans with the nominal model besides. Practice in blocks is repeated in one go.
 * @param {ExperimentKind} kind
 * @param {ExperimentValues} values
 * @param {string} world empty where the experiment has none
 */
function countInWorld({ measure, references }, values, world) {
  const disturbances = world ? parseWorld(world).value ?? [] : [];
  const varies = Boolean(values.tolerance) || disturbances.some(({ kind }) => kind === NOISE);
  const trialsOf = (/** @type {string} */ agent) => {
    const settingCount = combinations(values, Object.keys(settingsOf([agent])));
    if (!learns(agent)) return varies ? settingCount * values.seeds : settingCount;
    return settingCount * combinations(values, PRACTICE_FIELDS) * values.seeds * (measure === "blocks" ? 2 : 1);
  };
  const agents = [...new Set([...references, ...values.agents])];
  const nominal = disturbances.length || values.tolerance ? ["greedy"] : [];
  return [...agents, ...nominal].reduce((total, agent) => total + trialsOf(agent), 0);
}

// ---- the form

/** Texts set by a person or a link; all else is the default. */
const texts = () => page.experiment;
const { set, keep, valueOf } = makeTexts(texts);

export const chosenExperiment = computed(() => experimentOf(texts().value.get("experiment") ?? ""));

/** The settings of all agents by name. */
const everySetting = computed(() => settingsOf((options.value?.agents ?? []).map(({ name }) => name)));

const chosenAgents = computed(() => {
  const kind = chosenExperiment.value;
  const typed = kind.fields.includes("agents") ? valueOf("agents", READERS.agents, null) : null;
  return /** @type {string[]} */ (typed ?? kind.defaults.agents);
});

/** The settings of the chosen agents that the experiment varies, by name. */
export const agentSettings = computed(() => {
  const settings = Object.entries(settingsOf(chosenAgents.value));
  return Object.fromEntries(settings.filter(([name]) => chosenExperiment.value.fields.includes(name)));
});

/** @param {string} field */
export const takesField = (field) =>
  field === "name" ||
  (chosenExperiment.value.fields.includes(field) && (!(field in everySetting.value) || field in agentSettings.value));

/** A setting's default for the chosen agents; empty if each has its own. @type {(name: string) => SettingValue[]} */
function defaultOf(name) {
  const declared = chosenAgents.value.map((agent) => settingsOf([agent])[name]).filter(Boolean);
  const ofAgents = [...new Set(declared.map((setting) => setting.default))];
  return ofAgents.length === 1 ? ofAgents : [];
}

/** The experiment's defaults in the chosen simulator, with those of the settings of its agents. */
export const defaults = computed(() => {
  const kind = chosenExperiment.value;
  const ofSettings = Object.keys(agentSettings.value).map((name) => [name, defaultOf(name)]);
  const ofSimulator = kind.simulator_defaults[valueOf("simulator", READERS.simulator, kind.defaults.simulator)];
  return /** @type {ExperimentValues} */ ({ ...kind.defaults, ...ofSimulator, ...Object.fromEntries(ofSettings) });
});

/** The fields that were set, and that the chosen experiment takes. */
export const givenFields = () => [...new Set(texts().value.keys())].filter(takesField);

/** The values that the experiment would be started with. */
export const values = computed(() => {
  const fields = givenFields().map((field) =>
    [field, valueOf(field, (text) => parse(field, text), defaults.value[field])]);
  return /** @type {ExperimentValues} */ ({ ...defaults.value, ...Object.fromEntries(fields) });
});

/** The number of trials that it would have. */
export const trials = computed(() => countTrials(chosenExperiment.value, values.value));

// ---- texts as values

/** @param {{ name: string }[] | undefined} list */
const namesOf = (list) => (list ?? []).map(({ name }) => name);

const SEVERAL = { minimum: 1, maximum: null, excludes_minimum: false, excludes_maximum: false };

/** Field that takes no list of values of a setting → how its text is read. */
const READERS = /** @type {Record<string, (text: string) => Parsed<ExperimentValue>>} */ ({
  experiment: (/** @type {string} */ text) => parseChoice(text, namesOf(experiments.value)),
  simulator: (/** @type {string} */ text) => parseChoice(text, namesOf(served().simulators)),
  name: (/** @type {string} */ text) => parseName(text, limitsOf("name")),
  seeds: (/** @type {string} */ text) => parseNumber(text, limitsOf("seeds"), true),
  seed: (/** @type {string} */ text) => parseNumber(text, limitsOf("seed"), true),
  gaits: (/** @type {string} */ text) => parseChoices(text, namesOf(served().gaits), SEVERAL),
  robots: (/** @type {string} */ text) => parseChoices(text, namesOf(served().robots), SEVERAL),
  observations: (/** @type {string} */ text) => parseChoices(text, namesOf(served().observations), SEVERAL),
  agents: (/** @type {string} */ text) => parseChoices(text, offeredAgents(), SEVERAL),
  worlds: (/** @type {string} */ text) => parseWorlds(text),
  tolerance: (/** @type {string} */ text) => parseNumber(text, limitsOf("tolerance"), false),
  reward: (/** @type {string} */ text) => parseSetting(text, served().settings.reward),
});

/** The agents that the chosen experiment can compare; all of them where it has its own. */
export const offeredAgents = () => {
  const { fields, agents } = chosenExperiment.value;
  return fields.includes("agents") ? agents : namesOf(served().agents);
};

/** @type {(text: string) => Parsed<string[]>} */
function parseWorlds(text) {
  const worlds = splitWorlds(text);
  const mistake = worlds.map((world) => parseWorld(world).mistake).find(Boolean);
  if (mistake) return { mistake };
  if (new Set(worlds).size < worlds.length) return { mistake: "Enter each world once" };
  return worlds.length ? { value: worlds } : { mistake: "Choose at least 1 of these" };
}

/** Why a world cannot be had in the chosen simulator. */
function mistakeInWorlds() {
  const { worlds, simulator } = values.value;
  const disturbances = /** @type {string[]} */ (worlds ?? []).flatMap((world) => parseWorld(world).value ?? []);
  const impossible = disturbances.find(({ kind }) => !isSimulated(kind, simulator));
  return impossible ? unknownTo(simulator, impossible.kind) : null;
}

/** The declaration of a setting: that of the chosen agents, else the first agent's. @type {(field: string) => any} */
export const settingFor = (field) =>
  agentSettings.value[field] ?? everySetting.value[field] ?? served().settings[field];

/**
 * A text as the value of a field, or why it is none. A setting of which each agent has its own default may be empty.
 * @param {string} field
 * @param {string} text
 * @returns {Parsed<ExperimentValue>}
 */
export function parse(field, text) {
  if (READERS[field]) return READERS[field](text);
  const isOwn = defaults.value[field]?.toString() === "";
  return isOwn && text.trim() === "" ? { value: defaults.value[field] } : parseValues(text, settingFor(field));
}

/** The fields whose text is not valid; any of them holds the start. */
export const wrong = computed(() => {
  /** @type {Record<string, { text: string, mistake: string }>} */
  const mistaken = {};
  for (const field of ["experiment", ...givenFields()]) {
    const text = texts().value.get(field);
    const { mistake: why } = text === null ? {} : parse(field, text);
    if (text !== null && why !== undefined) mistaken[field] = { text, mistake: why };
  }
  const mistake = takesField("worlds") ? mistakeInWorlds() : null;
  if (mistake) mistaken.worlds ??= { text: joined(values.value.worlds, ","), mistake };
  return mistaken;
});

/** Field → why its text is not valid. */
export const mistakes = computed(() =>
  Object.fromEntries(Object.entries(wrong.value).map(([field, { mistake }]) => [field, mistake])),
);

/** @param {string} name */
export const chooseExperiment = (name) => set({ experiment: name === experiments.value[0].name ? [] : [name] });

/** @type {(field: string, value: ExperimentValue) => void} */
export const setField = (field, value) =>
  set({ [field]: String(value) === String(defaults.value[field] ?? "") ? [] : [inAddress(field, value)] });

/**
 * Take what was typed or chosen in a field: its value if the text is valid, else the text as it is.
 * @param {string} field
 * @param {string} text
 */
export function enter(field, text) {
  const { value, mistake } = parse(field, text);
  if (mistake === undefined) setField(field, value);
  else keep(field, text);
}

/**
 * Set the form anew: these values in their order, for a later one may depend on those before it.
 * @param {[string, ExperimentValue][]} entries
 */
export const setForm = (entries) => batch(() => {
  texts().value = new URLSearchParams();
  for (const [field, value] of entries) {
    if (field === "experiment") chooseExperiment(String(value));
    else setField(field, value);
  }
});

/** Fields on which the defaults of others depend. */
const FIRST = ["experiment", "simulator", "agents"];

/**
 * Set the form to the config of an experiment. What the form cannot say, as a robot of one's own, is left at its
 * default.
 * @param {Run["config"]} config
 * @returns {string[]} the fields that were left out
 */
export function setFormOf(config) {
  const { settings = {}, robots = [], ...fields } = config;
  const named = robots.map((/** @type {RobotConfig} */ robot) => (customRobotInWords(robot) ? null : presetOf(robot)));
  /** @type {Record<string, any>} */
  const formValues = { ...fields, ...settings, robots: named };
  const { fields: taken } = experimentOf(config.experiment);
  const isSayable = (/** @type {string} */ field) =>
    ![formValues[field]].flat().some((value) => value === null || typeof value === "object");
  const present = [...new Set([...FIRST, ...taken])].filter((field) => formValues[field] !== undefined);
  const order = present.filter((field) => field === "experiment" || taken.includes(field));
  setForm(order.filter(isSayable).map((field) => [field, formValues[field]]));
  return order.filter((field) => !isSayable(field));
}

/** The request's body. @returns {Record<string, unknown>} */
export function requestBody() {
  const entries = givenFields().map((field) => [field, values.value[field]]);
  const fields = Object.fromEntries(entries.filter(([field]) => !(String(field) in everySetting.value)));
  const settings = Object.fromEntries(entries.filter(([field]) => String(field) in everySetting.value));
  const { name = "", ...rest } = fields;
  const trimmed = String(name).trim();
  return {
    experiment: chosenExperiment.value.name,
    ...rest,
    ...(Object.keys(settings).length ? { settings } : {}),
    ...(trimmed ? { name: trimmed } : {}),
  };
}

/** @type {(value: ExperimentValue, separator: string) => string} */
const joined = (value, separator) => (Array.isArray(value) ? value.join(separator) : String(value));

/**
 * A value as a text of which there is no other reading: 0 and 1 are "0;1", because "0,1" can be a tenth.
 * @type {(field: string, value: ExperimentValue) => string}
 */
function inAddress(field, value) {
  const both = [",", ";"].map((separator) => joined(value, separator));
  return both.find((text) => parse(field, text).mistake === undefined) ?? both[0];
}

/** Read the form of the link that was opened: what is no field of it is told. */
export function openExperimentForm() {
  const names = ["experiment", "name", ...experiments.value.flatMap((kind) => kind.fields)];
  const entries = [...texts().peek()];
  ignored.experiments.value = entries.filter(([field]) => !names.includes(field)).map((pair) => pair.join("="));
  texts().value = new URLSearchParams(entries.filter(([field]) => names.includes(field)));
}
