// Ways to begin an experiment, each with the few fields that it is about: a table over what the server offers. A card
// sets the form; which card is chosen follows from the form, so that a link needs no word for it.
import { signal } from "@preact/signals";
import { page } from "../../js/page-state.js";
import { kindOf, learns, mistakeIn } from "../../js/settings.js";
import { served } from "../../js/store.js";
import {
  agentSettings, chosenExperiment, defaults, experimentOf, experiments, givenFields, setField, setForm, settingFor,
  takesField, values, wrong,
} from "./form.js";

/** @import { ExperimentKind, ExperimentValue, SettingOption, SettingValue } from "../../js/types.js" */

/**
 * `fields`: those that it shows, "setting" being the one that is swept, with its values. `begins`: the values with
 * which it begins, where they are not the experiment's own.
 * @typedef {object} Preset
 * @property {string} name
 * @property {string} title
 * @property {string} about
 * @property {string} experiment
 * @property {string[]} fields
 * @property {(kind: ExperimentKind) => Record<string, ExperimentValue>} begins
 */

/** The simulator that is done soonest, and a single gait: a first answer in seconds. */
const QUICK = "kinematic";
/** @param {ExperimentKind} kind */
const quickly = ({ defaults: { gaits } }) => ({
  ...(served().simulators.some(({ name }) => name === QUICK) ? { simulator: QUICK } : {}),
  gaits: gaits.slice(0, 1),
});

/** A few learners of different kinds: those that are compared after something happened to them. */
const severalLearners = () =>
  experiments.value.find(({ measure }) => measure === "recovery")?.defaults.agents.filter(learns) ?? [];
const MAX_FEW = 3;

/** @type {Preset[]} */
const OWN = [
  {
    name: "setting", title: "A setting", about: "One setting in several values", experiment: "sweep",
    fields: ["setting", "agents", "seeds", "simulator"],
    begins: (kind) => {
      const [agent] = kind.defaults.agents;
      const [name, setting] = Object.entries(settingsOfAgent(agent))[0] ?? [];
      return { ...quickly(kind), ...(setting ? { [name]: suggestedValues(setting) } : {}) };
    },
  },
  {
    name: "learners", title: "Learners", about: "Several learners side by side", experiment: "sweep",
    fields: ["agents", "steps", "seeds", "simulator"],
    begins: (kind) => ({ ...quickly(kind), agents: severalLearners() }),
  },
  {
    name: "worlds", title: "Worlds", about: "One learner on flat ground, ice, a slope", experiment: "league",
    fields: ["agents", "worlds", "steps", "seeds", "simulator"],
    begins: ({ defaults: { agents, gaits } }) =>
      ({ agents: agents.filter(learns).slice(0, 1), gaits: gaits.slice(0, 1) }),
  },
];

/** Shows every setting, with the defaults of the experiment that varies them. @type {Preset} */
const EMPTY = {
  name: "empty", title: "Empty", about: "Choose everything", experiment: "sweep", fields: [], begins: () => ({}),
};

const SHOWN = ["agents", "worlds", "steps", "seeds", "simulator"];

/** The presets that the server can run: the own ones, its experiments as they are, and all. @returns {Preset[]} */
export function presets() {
  const kinds = experiments.value;
  const isServed = (/** @type {Preset} */ { experiment }) => kinds.some(({ name }) => name === experiment);
  const rest = kinds.filter((kind) => !kind.takes_settings).map(({ name, title, about, fields }) => ({
    name, title, about, experiment: name,
    fields: SHOWN.filter((field) => fields.includes(field)), begins: () => ({}),
  }));
  return [...OWN.filter(isServed), ...rest, ...[EMPTY].filter(isServed)];
}

// ---- the preset that the form shows

/** Name of the card that was chosen last; another one where the form has become that of another experiment. */
const lastChosen = signal("");

/** Fields that are told in one line below, whichever the preset: where it walks. */
const TOLD = ["experiment", "gaits", "robots", "observations"];

/** @param {string} field */
const isSeveral = (field) => /** @type {unknown[]} */ (values.value[field]).length > 1;

/** The settings that were set, or that have several values by default. */
const sweptFields = () => sweepable().filter((field) => givenFields().includes(field) || isSeveral(field));

/**
 * Whether a preset shows all that was set.
 * @param {Preset} preset
 */
function shows({ fields, name }) {
  const isHidden = (/** @type {string} */ field) =>
    !fields.includes(field) && (Boolean(wrong.value[field]) || !TOLD.includes(field));
  if (name !== "setting") return !givenFields().some(isHidden);
  const swept = sweptFields();
  return values.value.agents.length === 1 && swept.length <= 1 &&
    !givenFields().some((field) => isHidden(field) && !swept.includes(field));
}

/**
 * Whether the form looks like this preset rather than like another one of its experiment.
 * @type {Record<string, () => boolean>}
 */
const LOOKS_LIKE = {
  learners: () => values.value.agents.length > 1,
  worlds: () => values.value.agents.length <= MAX_FEW,
};

/** The preset that was chosen, else the one that a link looks like. @returns {Preset} */
export function chosenPreset() {
  const ofExperiment = presets().filter(({ experiment }) => experiment === chosenExperiment.value.name);
  const alike = ofExperiment.find(({ name }) => LOOKS_LIKE[name]?.());
  return ofExperiment.find(({ name }) => name === lastChosen.value) ?? alike ??
    ofExperiment.find(({ name }) => !LOOKS_LIKE[name]) ?? ofExperiment[0];
}

/** Whether more was set than the chosen preset shows, or it shows all by itself; then all is shown. */
export const isMoreSet = () => chosenPreset().name === EMPTY.name || !shows(chosenPreset());

/** Whether nothing was set yet. */
export const isUntouched = () => page.experiment.value.size === 0;

/** Read a form anew: which card it looks like follows from it alone. */
export const forgetPreset = () => (lastChosen.value = "");

/**
 * Begin a preset. What was set of the fields that it shows stays; the rest is as it begins: all in the empty one.
 * @param {string} name
 * @param {boolean} [showsAll] whether every setting is shown, whichever the preset
 */
export function choosePreset(name, showsAll = false) {
  const preset = presets().find((candidate) => candidate.name === name) ?? presets()[0];
  const begun = isUntouched() ? {} : chosenPreset().begins(chosenExperiment.value);
  const isOwn = (/** @type {string} */ field) => String(begun[field]) !== String(values.value[field]);
  const keepsAll = showsAll && preset.name !== EMPTY.name;
  const isShown = (/** @type {string} */ field) => keepsAll || [...preset.fields, "seed", "name"].includes(field);
  const keptFields = givenFields().filter((field) => isOwn(field) && isShown(field));
  const keptValues = Object.fromEntries(keptFields.map((field) => [field, values.value[field]]));
  lastChosen.value = name;
  const { simulator, agents, ...rest } = /** @type {Record<string, ExperimentValue>} */ (
    { ...preset.begins(experimentOf(preset.experiment)), ...keptValues });
  /** @type {[string, ExperimentValue][]} */
  const first = [["experiment", preset.experiment], ["simulator", simulator], ["agents", agents]];
  setForm([...first, ...Object.entries(rest)].filter(([, value]) => value !== undefined));
  if (name !== "setting") return;
  // An agent that was kept may lack the setting with which the preset begins.
  if (values.value.agents.length > 1) setField("agents", values.value.agents.slice(0, 1));
  if (!sweptFields().length) chooseSwept(sweepable()[0]);
}

// ---- the setting that is swept

/** @param {string} name */
const settingsOfAgent = (name) => served().agents.find((agent) => agent.name === name)?.settings ?? {};

/** The settings of the chosen agents that can be swept, then those of every practice. */
export function sweepable() {
  const ofAgent = Object.keys(agentSettings.value);
  return [...ofAgent, ...chosenExperiment.value.grid.filter((field) => takesField(field) && !ofAgent.includes(field))];
}

/** The setting whose values were last edited: with a single value it looks like any other. */
const lastSwept = signal("");

/** The one that is swept: with several values, else the one that was edited, else the first that was set. */
export function sweptField() {
  const all = sweptFields();
  const swept = [...all.filter(isSeveral), lastSwept.value, ...all].find((field) => sweepable().includes(field));
  return swept ?? sweepable()[0];
}

/** Shares of a quantity without a unit that goes from 0 to 1, and factors of any other; a length soon is too long. */
const SHARES = [0.1, 0.3, 0.5, 0.7, 0.9];
const FACTORS = [0.25, 0.5, 1, 2];
const FACTORS_OF_COUNTS = [...FACTORS, 4];
const DIGITS = 2;

/**
 * Values of a setting that are worth a try, its default among them: all of a few words, a range of shares, or
 * multiples of the default.
 * @param {SettingOption} setting
 * @returns {SettingValue[]}
 */
export function suggestedValues(setting) {
  const { default: usual, minimum, maximum, unit, is_whole: isWhole } = setting;
  if (kindOf(setting) !== "number") return setting.choices;
  const isShare = minimum === 0 && maximum === 1 && unit === null && !isWhole;
  const base = typeof usual === "number" ? usual : null;
  const multiples = base ? (isWhole ? FACTORS_OF_COUNTS : FACTORS).map((factor) => base * factor) : [];
  const rounded = (isShare ? SHARES : multiples).map((number) =>
    (isWhole ? Math.round(number) : Number(number.toPrecision(DIGITS))));
  const all = [...new Set([...rounded, ...(base === null ? [] : [base])])];
  return all.filter((number) => mistakeIn(number, setting, isWhole) === null).sort((a, b) => a - b);
}

/** Sweep a setting, and no other, in its suggested values. @param {string} name */
export function chooseSwept(name) {
  for (const field of sweptFields()) setField(field, defaults.value[field]);
  lastSwept.value = name;
  setField(name, suggestedValues(settingFor(name)));
}

/** Try one agent. Values that were only suggested become those that are suggested for it. @param {string} agent */
export function chooseAgent(agent) {
  const swept = sweptField();
  const isSuggested = String(values.value[swept]) === String(suggestedValues(settingFor(swept)));
  setField("agents", [agent]);
  const isTaken = sweepable().includes(swept);
  if (!isTaken || isSuggested) chooseSwept(isTaken ? swept : sweepable()[0]);
}
