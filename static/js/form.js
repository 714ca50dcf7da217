// The form's values, their query string, and the request bodies that they make.
import { computed, signal } from "@preact/signals";
import { learners, learns, settingsOf, valueOf } from "./settings.js";
import { options, served } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { FormValue, FormValues, SettingValue } from "./types.js" */

/** Empty until the server's options have come; no component shows the form before. */
const UNKNOWN = /** @type {FormValues} */ ({});

/** What a person or a link has set; all else is the server's default. @type {Signal<Record<string, FormValue>>} */
export const overrides = signal({});
/** Field → why its text is not valid; any entry disables the start. @type {Signal<Record<string, string>>} */
export const mistakes = signal({});

/**
 * The defaults of the fields that do not depend on the learner.
 * @returns {Record<string, FormValue>}
 */
function commonDefaults() {
  const { training, race } = served().defaults;
  const own = settingsOf([training.agent]);
  const common = Object.entries(training).filter(([field]) => field !== "agent" && !(field in own));
  return { ...Object.fromEntries(common), race_steps: race.steps, name: "" };
}

/**
 * The lanes of a race by default: those of the server, in which the learner's is the chosen one's.
 * @param {string} agent
 */
function defaultLanes(agent) {
  const { training, race } = served().defaults;
  return race.lanes.map((lane) => (lane.agent === training.agent ? agent : lane.agent));
}

/**
 * Values of an agent's settings: those that are given and of the right kind, else the agent's defaults.
 * @param {string} agent
 * @param {Record<string, FormValue>} given
 * @returns {Record<string, SettingValue>}
 */
const settingValues = (agent, given) =>
  Object.fromEntries(
    Object.entries(settingsOf([agent])).map(([name, setting]) => {
      const value = name in given ? valueOf(written(given[name]), setting) : undefined;
      return [name, value === undefined ? setting.default : value];
    }),
  );

/** @param {Record<string, FormValue>} given */
function complete(given) {
  const agent = String(given.agent ?? served().defaults.training.agent);
  const defaults = { ...commonDefaults(), agent, lanes: defaultLanes(agent) };
  const common = Object.entries(given).filter(([field]) => field in defaults);
  return /** @type {FormValues} */ ({ ...defaults, ...Object.fromEntries(common), ...settingValues(agent, given) });
}

/** The form without the settings of the chosen learner. */
const commonFields = () => {
  const own = settingsOf([form.value.agent]);
  return select(form.value, (field) => !(field in own));
};

/** The common fields, and the settings of the chosen learner. */
export const form = computed(() => (options.value ? complete(overrides.value) : UNKNOWN));

/**
 * Change fields, and the address with them.
 * @param {Record<string, FormValue>} changes
 */
export const setFields = (changes) => {
  overrides.value = { ...overrides.value, ...changes };
  writeAddress();
};

/** @type {(field: string, value: FormValue) => void} */
export const setField = (field, value) => setFields({ [field]: value });

/**
 * Choose the learner. It takes the lane of the one before it, unless it has its own.
 * @param {string} agent
 */
export function chooseLearner(agent) {
  const { lanes, agent: before } = form.value;
  const isSet = "lanes" in overrides.value && !lanes.includes(agent);
  setFields({ agent, ...(isSet ? { lanes: lanes.map((lane) => (lane === before ? agent : lane)) } : {}) });
}

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

// ---- the address

/** @param {FormValue} value */
const written = (value) => String(value ?? "");

/** The form, and what is set for other learners of the race. @returns {Record<string, FormValue>} */
const everyValue = () => {
  const own = settingsOf(form.value.lanes);
  return { ...form.value, ...select(overrides.value, (field) => field in own && !(field in form.value)) };
};

const isChanged = computed(() => {
  const defaults = complete({});
  return Object.entries(everyValue()).some(([field, value]) => written(value) !== written(defaults[field]));
});

/** The whole form as a query string; empty texts are left out. */
export const toQuery = () =>
  new URLSearchParams(
    Object.entries(everyValue()).map(([field, value]) => [field, written(value)]).filter(([, value]) => value !== ""),
  );

/**
 * The fields that a query string sets to something else than the default; unreadable values are skipped.
 * @param {URLSearchParams} query
 * @returns {Record<string, FormValue>}
 */
export function fromQuery(query) {
  /** @type {Record<string, FormValue>} */
  const found = {};
  const agent = query.get("agent") ?? "";
  if (learners.value.some(({ name }) => name === agent)) found.agent = agent;
  const lanes = (query.get("lanes") ?? "").split(",").filter(Boolean);
  if (lanes.length) found.lanes = lanes;
  const defaults = complete(found);
  const declared = { ...served().settings, ...settingsOf([defaults.agent, ...defaults.lanes]) };
  for (const [field, text] of query) {
    const isKnown = field in defaults || field in declared;
    const value = field in declared ? valueOf(text, declared[field]) : text;
    const isFound = field === "agent" || field === "lanes" || value === undefined;
    if (isKnown && !isFound && value !== defaults[field]) found[field] = value;
  }
  return found;
}

/** Set the fields that the page's address contains. */
export function readAddress() {
  overrides.value = fromQuery(new URLSearchParams(location.search));
}

/** Write the form to the page's address; an unchanged form keeps it clean. */
export function writeAddress() {
  const search = isChanged.value ? `?${toQuery()}` : "";
  history.replaceState(history.state, "", `${location.pathname}${search}${location.hash}`);
}

/** A link to the page with every field of the form. */
export const link = () =>
  form.value === UNKNOWN
    ? location.href
    : `${location.origin}${location.pathname}?${toQuery()}${location.hash}`;

// ---- request bodies

const WALK_FIELDS = ["gait", "robot", "simulator", "divisions", "grid_side_m"];
const RACE_FIELDS = ["race_steps", "lanes"];
/** Fields on which what is learned does not depend. */
const SHOW_FIELDS = ["evaluate_every", "pace"];

/** @type {<Value>(values: Record<string, Value>, isWanted: (field: string) => boolean) => Record<string, Value>} */
const select = (values, isWanted) =>
  Object.fromEntries(Object.entries(values).filter(([field]) => isWanted(field)));

const walkFields = () => select(form.value, (field) => WALK_FIELDS.includes(field));

const nameField = () => {
  const name = form.value.name.trim();
  return name ? { name } : {};
};

/** The practice of an agent: the fields that are common to all, and the agent's own. @param {string} agent */
function practiceFields(agent) {
  const elsewhere = ["agent", "name", "seed", ...WALK_FIELDS, ...RACE_FIELDS];
  const common = select(commonFields(), (field) => !elsewhere.includes(field));
  const own = Object.entries(settingValues(agent, overrides.value)).filter(([, value]) => value !== null);
  return { ...common, ...Object.fromEntries(own) };
}

/**
 * A training's seed; one that continues another goes on with its generator.
 * @param {string | null | undefined} id of the training whose table it starts with
 */
const beginning = (id) => (id ? { continue_from: id } : { seed: form.value.seed });

/**
 * Request body of a training.
 * @param {string | null} continueFrom id of the training whose table it starts with
 * @returns {Record<string, unknown>}
 */
export const trainingBody = (continueFrom = null) => {
  const { agent } = form.value;
  return { agent, ...walkFields(), ...nameField(), ...practiceFields(agent), ...beginning(continueFrom) };
};

/** Request body of a what-if: the settings of the practice, without seed, pace and simulator. */
export function whatIfBody() {
  const { agent } = form.value;
  const body = { agent, ...walkFields(), ...practiceFields(agent) };
  return select(body, (field) => field !== "simulator" && !SHOW_FIELDS.includes(field));
}

/** Agent → id of a training. @typedef {Record<string, string | undefined>} TrainingIds */

/**
 * Request body of a race. Its learners practise first, continue from a table, or use it as it is.
 * @param {{ continued?: TrainingIds, tables?: TrainingIds }} how
 */
export const raceBody = ({ continued = {}, tables = {} } = {}) => ({
  ...walkFields(),
  ...nameField(),
  steps: form.value.race_steps,
  seed: form.value.seed,
  lanes: form.value.lanes.map((agent) => {
    if (!learns(agent)) return { agent };
    if (tables[agent]) return { agent, training_id: tables[agent] };
    return { agent, training: { ...practiceFields(agent), ...beginning(continued[agent]) } };
  }),
});
