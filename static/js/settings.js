// What the server offers, its options; and the settings among them: their controls, names and limits, and those of each
// agent.
import { computed, signal } from "@preact/signals";
import { sentence, t, whole } from "./format.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Agent, Bounds, FieldOption, Limits, Options, SettingOption, SettingValue } from "./types.js" */

/** Null until the server has answered. A page without a server has it in itself. @type {Signal<Options | null>} */
export const options = signal(null);
/** The options, for code that runs only once they are known: components, and what they call. */
export const served = () => /** @type {Options} */ (options.value);
/** The entry of a list of options that has a name; undefined where there is none. */
/** @type {<Entry extends { name: string }>(entries: Entry[] | undefined, name: string) => Entry | undefined} */
export const optionNamed = (entries, name) => entries?.find((entry) => entry.name === name);

/**
 * The kind of control that a setting needs.
 * @param {SettingOption} setting
 * @returns {"number" | "choice" | "switch" | "text"}
 */
export function kindOf({ is_number, is_boolean, choices }) {
  if (is_boolean) return "switch";
  if (choices.length) return is_number ? "text" : "choice";
  return is_number ? "number" : "text";
}

/** A slider divides its range in about so many steps. */
const SLIDER_STEPS = 100;

/**
 * The ends and the step of a setting's slider; null without both limits. A limit that is not valid itself is one
 * step beyond the end.
 * @param {Limits & { is_whole: boolean }} setting
 */
export function sliderOf({ minimum, maximum, excludes_minimum, excludes_maximum, is_whole }) {
  if (minimum === null || maximum === null) return null;
  const power = 10 ** Math.floor(Math.log10((maximum - minimum) / SLIDER_STEPS));
  const step = is_whole ? Math.max(1, power) : power;
  return { min: excludes_minimum ? minimum + step : minimum, max: excludes_maximum ? maximum - step : maximum, step };
}

/**
 * The quantity of a setting: "Exploration", of which "Final exploration" is one value.
 * @param {SettingOption} setting
 */
export const quantityOf = ({ title, quantity }) => sentence(quantity ?? title);

/**
 * A setting's name where there is little room: "α", "Final ε".
 * @param {SettingOption} setting
 */
export const shortTitle = ({ title, symbol, quantity, unit }) =>
  symbol ? title.replace(quantity ?? title, symbol) : withUnit(title, unit);

/**
 * A setting's name in a sentence: "Learning rate α", "Grid side".
 * @param {SettingOption} setting
 */
export const titleOf = ({ title, symbol }) => (symbol ? `${title} ${symbol}` : title);

/**
 * A setting's name as a label: "Learning rate α", "Grid side (m)".
 * @param {SettingOption} setting
 */
export const fullTitle = (setting) => withUnit(titleOf(setting), setting.unit);

/** @type {(title: string, unit: string | null) => string} */
const withUnit = (title, unit) => (unit ? `${title} (${unit})` : title);

/**
 * The title of a setting's choice: "true model".
 * @param {SettingOption} setting
 * @param {string} choice
 */
export const choiceTitle = ({ choices, choice_titles }, choice) => choice_titles[choices.indexOf(choice)] ?? choice;

// ---- limits

/** @type {(value: number) => string} */
const formatted = (value) => (Number.isInteger(value) ? whole(value) : String(value));

/**
 * The declaration of a setting, for components: they are formatted once the server has answered.
 * @type {(field: string) => SettingOption}
 */
export const settingOf = (field) => served().settings[field];

/**
 * The limits of a field; none where the server states none.
 * @param {string} field
 * @returns {Limits}
 */
export function limitsOf(field) {
  const setting = options.value?.settings[field];
  if (setting) return setting;
  const [minimum, maximum] = options.value?.limits[field] ?? [null, null];
  return { minimum, maximum, excludes_minimum: false, excludes_maximum: false };
}

/**
 * Limits in words: "from 0 to 1", "over 0 and at most 1", "at least 0"; empty without limits.
 * @param {Limits} limits
 */
export function rangeOf({ minimum, maximum, excludes_minimum, excludes_maximum }) {
  const [low, high] = [minimum, maximum].map((limit) => (limit === null ? "" : formatted(limit)));
  const lower = !low ? "" : excludes_minimum ? t("over {low}", { low }) : t("at least {low}", { low });
  const upper = !high ? "" : excludes_maximum ? t("under {high}", { high }) : t("at most {high}", { high });
  if (minimum === null || maximum === null) return lower || upper;
  if (excludes_minimum) return t("{lower} and {upper}", { lower, upper });
  return excludes_maximum ? t("from {low} to under {high}", { low, high }) : t("from {low} to {high}", { low, high });
}

/** @type {(value: number, limits: Limits) => boolean} */
const isWithin = (value, { minimum, maximum, excludes_minimum, excludes_maximum }) =>
  (minimum === null || value > minimum || (value === minimum && !excludes_minimum)) &&
  (maximum === null || value < maximum || (value === maximum && !excludes_maximum));

/**
 * The reason why a number is not valid; null if it is.
 * @param {number} value
 * @param {Limits} limits
 * @param {boolean} isInteger
 */
export function mistakeIn(value, limits, isInteger) {
  const range = rangeOf(limits);
  const said = range && `, ${range}`;
  const isOfOtherKind = !Number.isFinite(value) || (isInteger && !Number.isInteger(value));
  if (isOfOtherKind) return (isInteger ? t("Enter a whole number") : t("Enter a number")) + said;
  // Beyond it a number of the page is not exact: another would be sent than was typed.
  const high = Number.MAX_SAFE_INTEGER;
  if (isInteger && value > high) return t("Must be {range}", { range: t("at most {high}", { high: whole(high) }) });
  return isWithin(value, limits) ? null : t("Must be {range}", { range });
}

/**
 * The declaration of a field whose limits depend on another one, beside its values: of an angle, on the joint.
 * @param {FieldOption} field
 * @param {{ [field: string]: any }} values
 * @returns {FieldOption}
 */
export function fieldBeside(field, values) {
  const range = field.ranges?.ranges[values[field.ranges.field]];
  return range ? { ...field, minimum: range[0], maximum: range[1] } : field;
}

/**
 * Values of fields; those whose limits depend on another are at the nearest end where they are out of them.
 * @template {{ [field: string]: any }} Values
 * @param {Record<string, FieldOption>} fields
 * @param {Values} values
 * @returns {Values}
 */
export function withinRanges(fields, values) {
  const narrowed = Object.entries(fields).filter(([name, { ranges }]) => ranges && name in values);
  const nearest = narrowed.map(([name, field]) => {
    const { minimum, maximum } = fieldBeside(field, values);
    return [name, Math.max(minimum ?? -Infinity, Math.min(values[name], maximum ?? Infinity))];
  });
  return { ...values, ...Object.fromEntries(nearest) };
}

// ---- agents, with the settings that each declares

/** For an agent that a run names and the server no longer has. */
const REMOVED_AGENT = {
  description: "", color: "#888888", learns: false, searches: false, needs_practice: false, keeps_learning: false,
  steps_ahead: null, settings: {}, live_settings: {},
};

/** @type {(name: string) => Agent} */
export const agentOf = (name) =>
  options.value?.agents.find((agent) => agent.name === name) ?? { name, title: name, ...REMOVED_AGENT };

/** @param {string} name */
export const learns = (name) => agentOf(name).learns;

/** The agents that learn. */
export const learners = computed(() => (options.value?.agents ?? []).filter((agent) => agent.learns));

/**
 * The settings of some agents by name, each as the first agent that has it declares it.
 * @param {string[]} names
 * @returns {Record<string, SettingOption>}
 */
export function settingsOf(names) {
  const each = names.map((name) => agentOf(name).settings);
  // The first pass gives the order, the second lets the first agent's declarations win.
  return Object.assign({}, ...each, ...each.reverse());
}

/**
 * The settings of lanes, by form field such as `beam.width`: the own ones of a searcher, what it knows and how it
 * reads its state, and whether a learner keeps learning; a learner's other settings are those of its practice.
 * @param {string[]} names of the lanes' agents
 * @returns {Record<string, SettingOption>}
 */
export function laneSettings(names) {
  const ofLane = (/** @type {string} */ name) => {
    const { settings, searches, keeps_learning } = agentOf(name);
    const keepLearning = { ...settingOf("keep_learning"), default: keeps_learning };
    const ofSearch = searches ? { plans_with: settingOf("plans_with") } : {};
    const observation = settingOf("observation");
    return Object.entries(learns(name) ? { keep_learning: keepLearning } : { ...settings, ...ofSearch, observation });
  };
  return Object.fromEntries(names.flatMap((name) => ofLane(name).map(([key, setting]) => [`${name}.${key}`, setting])));
}

/**
 * A lane's agent with the lane's settings in short: "Beam, width 8, depth 3". Of a learner, those that are not the
 * defaults.
 * @param {import("./types.js").LaneConfig} lane
 */
export function laneTitle(lane) {
  const { title, settings, learns: isLearner, keeps_learning } = agentOf(lane.agent);
  const values = lane.settings ?? {};
  const differing = Object.entries(settings).filter(
    ([name, setting]) => name in values && (!isLearner || values[name] !== setting.default),
  );
  const words = differing.map(([name, setting]) => settingInWords(setting, values[name]));
  if ((lane.keep_learning ?? keeps_learning) !== keeps_learning) {
    words.push(lane.keep_learning ? "keeps learning" : "frozen");
  }
  return [title, ...words].join(", ");
}

/** A choice says by itself what it is of. @type {(setting: SettingOption, value: unknown) => string} */
export const settingInWords = (setting, value) =>
  kindOf(setting) === "choice" ? String(value) : `${setting.symbol ?? setting.title.toLowerCase()}\u00a0${value}`;

/**
 * The settings that an agent shows first: those that may change while it learns, those with which such a one
 * begins, and the first that it declares. Settings of one symbol are values of one quantity: the second ends
 * what the first begins, and a live setting beside them replaces both while it learns.
 * @typedef {object} MainSetting
 * @property {string} name
 * @property {SettingOption} setting
 * @property {string | null} live the live setting that acts on its quantity
 * @property {string | null} end the setting that its quantity ends with
 */

/** @type {(symbol: string | null, entries: [string, SettingOption][]) => string[]} */
const namesOfSymbol = (symbol, entries) =>
  symbol === null ? [] : entries.filter(([, setting]) => setting.symbol === symbol).map(([name]) => name);

/**
 * @param {string} agent
 * @returns {MainSetting[]}
 */
export function mainSettings(agent) {
  const { settings, live_settings } = agentOf(agent);
  const entries = Object.entries(settings);
  const liveOnly = Object.entries(live_settings).filter(([name]) => !(name in settings));
  return entries.flatMap(([name, setting], number) => {
    /** @type {(live: string | null, end: string | null) => MainSetting[]} */
    const main = (live, end) => [{ name, setting, live, end }];
    if (name in live_settings) return main(name, null);
    const [first, end = null] = namesOfSymbol(setting.symbol, entries);
    const [live = null] = namesOfSymbol(setting.symbol, liveOnly);
    if (live !== null && first === name) return main(live, end);
    return number === 0 ? main(null, null) : [];
  });
}

/**
 * The settings that `mainSettings` leaves for further down.
 * @param {string} agent
 */
export function furtherSettings(agent) {
  const main = mainSettings(agent).map(({ name }) => name);
  return Object.entries(agentOf(agent).settings).filter(([name]) => !main.includes(name));
}

/**
 * The values of a run's main settings in short: "α 0.3". Without those that cannot change while it learns.
 * @param {string} agent
 * @param {{ [name: string]: any }} values
 */
export const ratesInWords = (agent, values) =>
  mainSettings(agent)
    .filter(({ name, live }) => live === name && values[name] !== undefined)
    .map(({ name, setting }) => `${setting.symbol ?? setting.title}\u00a0${values[name]}`);

/**
 * The value of an agent's live setting that no setting of its name begins: where its quantity begins.
 * @param {string} agent
 * @param {string} name
 * @param {{ [name: string]: any }} values
 * @returns {SettingValue}
 */
export function beginningOf(agent, name, values) {
  const { settings, live_settings } = agentOf(agent);
  const [first] = namesOfSymbol(live_settings[name].symbol, Object.entries(settings));
  return values[name] ?? values[first ?? ""] ?? null;
}

// ---- where the fields of the form are

export const PRACTICE_FIELDS = ["steps_per_episode", "evaluate_every", "reward"];
export const ROBOT_FIELDS = ["robot", "simulator", "divisions", "grid_side_m", "tolerance"];
/** Fields beside the learner's main settings that those who try see. */
const TRIED_FIELDS = ["agent", "steps", "gait", "world"];

/**
 * The tab in which a field of the form is, and whether only those who study see it.
 * @param {string} field
 * @param {string} agent the chosen learner
 */
export const placeOf = (field, agent) => ({
  tab: ["world", "disturb", ...ROBOT_FIELDS].includes(field) ? "world" : "train",
  isFull: !TRIED_FIELDS.includes(field) && !mainSettings(agent).some(({ name }) => name === field),
});

// ---- a restriction of the settings by a feature: courtesy, since it is the server that locks

/**
 * By name the bounds of the settings that can be changed, and who sets the others, as "The example sets"; null without
 * a restriction.
 */
export const restriction = signal(
  /** @type {{ bounds: Record<string, Partial<Bounds>>, reason: string } | null} */ (null));
/** Whether the user has opened all settings. */
export const isLifted = signal(false);

/** Whether a feature presets the form. */
export const isPreset = signal(false);

const limits = computed(() => (isLifted.value ? null : restriction.value?.bounds ?? null));

/** Whether some settings are closed. */
export const closesSome = computed(() => limits.value !== null);

/** These are open in any case: they change nothing of what is learned. */
const ALWAYS_OPEN = ["seed", "pace", "name"];

/** Whether a field of the form has to stay as it is. @param {string} field */
export const isClosed = (field) =>
  limits.value !== null && !(field in limits.value) && !ALWAYS_OPEN.includes(field);

/**
 * A setting of the form, within the bounds of the restriction.
 * @template {SettingOption | undefined} Setting
 * @param {string} field
 * @param {Setting} setting
 * @returns {Setting}
 */
export function bounded(field, setting) {
  const bounds = limits.value?.[field];
  if (!bounds || !setting) return setting;
  const { minimum = null, maximum = null, choices = null } = bounds;
  return {
    ...setting,
    ...(minimum === null ? {} : { minimum, excludes_minimum: setting.excludes_minimum && minimum === setting.minimum }),
    ...(maximum === null ? {} : { maximum, excludes_maximum: setting.excludes_maximum && maximum === setting.maximum }),
    ...(choices === null ? {} : { choices: choices.map(String) }),
  };
}

/** Whether a choice of a field can be chosen. @param {string} field @param {unknown} choice */
export function isAllowed(field, choice) {
  const choices = limits.value?.[field]?.choices ?? null;
  return choices === null || choices.some((valid) => valid === choice);
}
