// The form's values, what was typed that is none, their query string, and the request bodies that they make.
import { computed, signal } from "@preact/signals";
import { isSimulated, parseText } from "./disturbances.js";
import { listed } from "./format.js";
import { parseChoice, parseChoiceOrParts, parseChoices, parseName, parseSetting } from "./parse.js";
import { hasOwnSettings, isReadOnly, PAGE_FIELDS } from "./page.js";
import { agentOf, laneSettings, learners, learns, limitsOf, settingsOf } from "./settings.js";
import { options, served } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Parsed } from "./parse.js" */
/** @import { FormValue, FormValues, SettingValue } from "./types.js" */

/** Empty until the server's options have come; no component shows the form before. */
const UNKNOWN = /** @type {FormValues} */ ({});

/** Values set by a person or a link; all else is the server's default. @type {Signal<Record<string, FormValue>>} */
export const overrides = signal({});
/**
 * Field → its text, as it was typed or as a link has it, while it is not valid. The field's value stays the last
 * valid one until then.
 * @type {Signal<Record<string, string>>}
 */
export const typed = signal({});
/** Parts of a link that are no field of the form, as "alhpa=0.5". @type {Signal<string[]>} */
export const unknownParts = signal([]);

// ---- texts as values

/** @param {FormValue | undefined} value */
const written = (value) =>
  typeof value === "object" && value !== null && !Array.isArray(value) ? JSON.stringify(value) : String(value ?? "");

/** @param {{ name: string }[]} list */
const namesOf = (list) => list.map(({ name }) => name);

/** Field that is no declared setting → how its text is read. @type {Record<string, (text: string) => Parsed<any>>} */
const READERS = {
  agent: (text) => parseChoice(text, namesOf(learners.value)),
  gait: (text) => parseChoiceOrParts(text, namesOf(served().gaits)),
  robot: (text) => parseChoiceOrParts(text, namesOf(served().robots)),
  simulator: (text) => parseChoice(text, namesOf(served().simulators)),
  observation: (text) => parseChoice(text, namesOf(served().observations)),
  lanes: (text) => parseChoices(text, namesOf(served().agents), limitsOf("lanes")),
  name: (text) => parseName(text, limitsOf("name")),
  world: (text) => parseChoice(text, namesOf(served().worlds)),
};
/** A list of texts, each of which a link has as a part of its own. They are kept as they are, valid or not. */
const REPEATED = "disturb";

/**
 * A text as the value of a field, or why it is none.
 * @param {string} field
 * @param {string} text
 * @param {string[]} agents whose settings, or whose lanes' settings, the field may be
 * @returns {Parsed<any>}
 */
function read(field, text, agents) {
  const declared = settingsOf(agents)[field] ?? laneSettings(agents)[field] ?? served().settings[field];
  return (READERS[field] ?? ((/** @type {string} */ one) => parseSetting(one, declared)))(text);
}

/**
 * The defaults of the fields that do not depend on the learner.
 * @returns {Record<string, FormValue>}
 */
function commonDefaults() {
  const { training, race } = served().defaults;
  const others = ["agent", "disturbances", "settings"];
  const common = Object.entries(training).filter(([field]) => !others.includes(field));
  const world = { world: served().worlds[0].name, disturb: [] };
  return { ...Object.fromEntries(common), ...world, race_steps: race.steps, name: "" };
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
 * Values of an agent's settings: those that are given and valid for it, else the agent's defaults.
 * @param {string} agent
 * @param {Record<string, FormValue>} given
 * @returns {Record<string, SettingValue>}
 */
const settingValues = (agent, given) =>
  Object.fromEntries(
    Object.entries(settingsOf([agent])).map(([name, setting]) => {
      const texts = [typed.value[name], name in given ? written(given[name]) : undefined];
      const readings = texts.filter((text) => text !== undefined).map((text) => parseSetting(text, setting));
      return [name, readings.find(({ mistake }) => mistake === undefined)?.value ?? setting.default];
    }),
  );

/** @param {Record<string, FormValue>} given */
function complete(given) {
  const agent = String(given.agent ?? served().defaults.training.agent);
  const lanes = /** @type {string[]} */ (given.lanes ?? defaultLanes(agent));
  const ofLanes = Object.entries(laneSettings(lanes)).map(([field, setting]) => [field, setting.default]);
  const defaults = { ...commonDefaults(), agent, lanes, ...Object.fromEntries(ofLanes) };
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

/** The learners whose settings the form has: the chosen one, and the others of the race. */
const learnersInUse = computed(() => [...new Set([form.value.agent, ...form.value.lanes.filter(learns)])]);

/**
 * The fields whose text is not valid: what was typed, and what is valid for another learner only. Any of them holds
 * the start.
 */
export const wrong = computed(() => {
  /** @type {Record<string, { text: string, mistake: string }>} */
  const found = {};
  if (!options.value) return found;
  const check = (/** @type {string} */ field, /** @type {string} */ text, /** @type {string[]} */ agents) => {
    const { mistake } = read(field, text, agents);
    if (mistake !== undefined) found[field] ??= { text, mistake };
  };
  for (const agent of learnersInUse.value) {
    for (const name of Object.keys(settingsOf([agent]))) {
      if (name in typed.value) check(name, typed.value[name], [agent]);
      else if (name in overrides.value) check(name, written(overrides.value[name]), [agent]);
    }
  }
  const common = Object.keys({ ...commonDefaults(), agent: "", lanes: "" });
  for (const field of common.filter((one) => one in typed.value)) check(field, typed.value[field], []);
  const { lanes } = form.value;
  const ofLanes = Object.keys(laneSettings(lanes)).filter((field) => field in typed.value);
  for (const field of ofLanes) check(field, typed.value[field], lanes);
  const { world, disturb, simulator } = form.value;
  const impossible = disturbancesOf(world).find(({ kind }) => !isSimulated(kind, simulator));
  if (impossible) found.world ??= { text: world, mistake: unknownTo(simulator, impossible.kind) };
  for (const text of disturb) {
    const mistake = mistakeInText(text, simulator);
    if (mistake) found[REPEATED] ??= { text, mistake };
  }
  return found;
});

/** Disturbances of a named world. @param {string} name */
const disturbancesOf = (name) => served().worlds.find((world) => world.name === name)?.disturbances ?? [];

/** @type {(simulator: string, kind: string) => string} */
export function unknownTo(simulator, kind) {
  const others = served().simulators.map(({ name }) => name).filter((name) => isSimulated(kind, name));
  return `The ${simulator} simulator knows no ${kind}: choose ${listed(others)}`;
}

/**
 * Why a text of a disturbance is not valid; null if it is.
 * @param {string} text
 * @param {string} simulator
 */
export function mistakeInText(text, simulator) {
  const { value, mistake } = parseText(text);
  return mistake ?? (isSimulated(value.kind, simulator) ? null : unknownTo(simulator, value.kind));
}

/** Field → why its text is not valid; any entry disables the start. */
export const mistakes = computed(() =>
  Object.fromEntries(Object.entries(wrong.value).map(([field, { mistake }]) => [field, mistake])),
);

/** The steps of practice; null while their field has a text that is none. @returns {number | null} */
export const validSteps = () => ("steps" in mistakes.value ? null : form.value.steps);

/**
 * Change fields, and the address with them.
 * @param {Record<string, FormValue>} changes
 */
export const setFields = (changes) => {
  typed.value = select(typed.value, (field) => !(field in changes));
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
 * Take what was typed or chosen in a field: its value if the text is valid, else the text as it is.
 * @param {string} field
 * @param {string} text
 */
export function enter(field, text) {
  const { value, mistake } = read(field, text, [form.value.agent, ...form.value.lanes]);
  if (mistake === undefined) {
    setField(field, value);
    return;
  }
  typed.value = { ...typed.value, [field]: text };
  writeAddress();
}

// ---- the address

/** The form, and what is set for other learners of the race. @returns {Record<string, FormValue>} */
const everyValue = () => {
  const own = settingsOf(form.value.lanes);
  return { ...form.value, ...select(overrides.value, (field) => field in own && !(field in form.value)) };
};

/** Whether the form says anything else than its defaults. */
export const isChanged = computed(() => {
  const defaults = complete({});
  const isOther = (/** @type {[string, FormValue]} */ [field, value]) => written(value) !== written(defaults[field]);
  return Object.keys(wrong.value).length > 0 || Object.entries(everyValue()).some(isOther);
});

/** The whole form as a query string, what is not valid as it was typed; empty texts are left out. */
export function toQuery() {
  const valid = Object.entries(everyValue()).map(([field, value]) => [field, written(value)]);
  const entries = valid.filter(([field, text]) => text !== "" && field !== REPEATED && !(field in wrong.value));
  const kept = Object.entries(wrong.value).filter(([field]) => field !== REPEATED);
  const disturbances = form.value.disturb.map((text) => [REPEATED, text]);
  return new URLSearchParams([...entries, ...kept.map(([field, { text }]) => [field, text]), ...disturbances]);
}

/**
 * Set the form to what a query string says; what is not valid is kept as it is, and unknown fields are told.
 * @param {URLSearchParams} query
 */
export function readQuery(query) {
  /** @type {Record<string, FormValue>} */
  const found = {};
  /** @type {Record<string, string>} */
  const texts = {};
  const take = (/** @type {string} */ field, /** @type {string} */ text, /** @type {string[]} */ agents) => {
    const { value, mistake } = read(field, text, agents);
    if (mistake === undefined) found[field] = value;
    else texts[field] = text;
  };
  typed.value = {};
  // First those on which the others depend.
  for (const field of ["agent", "lanes"]) if (query.has(field)) take(field, query.get(field) ?? "", []);
  const defaults = complete(found);
  const agents = [defaults.agent, ...defaults.lanes];
  const known = { ...defaults, ...served().settings, ...settingsOf(agents), ...laneSettings(agents) };
  if (query.has(REPEATED)) found[REPEATED] = query.getAll(REPEATED);
  for (const [field, text] of query) {
    if (field in known && !(field in found) && !(field in texts)) take(field, text, agents);
  }
  const isUnknown = (/** @type {string} */ field) => !(field in known) && !PAGE_FIELDS.includes(field);
  unknownParts.value = [...query].filter(([field]) => isUnknown(field)).map((part) => part.join("="));
  overrides.value = select(found, (field) => field === "lanes" || written(found[field]) !== written(defaults[field])
    || (field === "agent" && found.agent !== served().defaults.training.agent));
  typed.value = texts;
}

/** Set the fields that the page's address contains. */
export const readAddress = () => readQuery(new URLSearchParams(location.search));

/** Write the form to the page's address; an unchanged form keeps it clean. */
export function writeAddress() {
  const query = isChanged.value && !isReadOnly.value ? toQuery() : new URLSearchParams();
  for (const [field, text] of new URLSearchParams(location.search)) {
    if (PAGE_FIELDS.includes(field)) query.set(field, text);
  }
  const search = query.size ? `?${query}` : "";
  history.replaceState(history.state, "", `${location.pathname}${search}${location.hash}`);
}

/** Let a spectator change the form. */
export const tryOwnSettings = () => {
  hasOwnSettings.value = true;
  writeAddress();
};

/** A link to the page with every field of the form. */
export const link = () =>
  form.value === UNKNOWN
    ? location.href
    : `${location.origin}${location.pathname}?${toQuery()}${location.hash}`;

// ---- request bodies

const WALK_FIELDS = ["gait", "robot", "simulator", "divisions", "grid_side_m", "tolerance"];
const RACE_FIELDS = ["race_steps", "lanes"];
const WORLD_FIELDS = ["world", REPEATED];
/** Fields on which what is learned does not depend. */
const SHOW_FIELDS = ["evaluate_every", "pace"];

/** @type {<Value>(values: Record<string, Value>, isWanted: (field: string) => boolean) => Record<string, Value>} */
const select = (values, isWanted) =>
  Object.fromEntries(Object.entries(values).filter(([field]) => isWanted(field)));

const walkFields = () => ({ ...select(form.value, (field) => WALK_FIELDS.includes(field)), ...worldFields() });

/** The named world and the disturbances besides, unless there are none. */
function worldFields() {
  const { world, disturb } = form.value;
  const disturbances = disturb.flatMap((text) => parseText(text).value ?? []);
  return {
    ...(world === served().worlds[0].name ? {} : { world }),
    ...(disturbances.length ? { disturbances } : {}),
  };
}

const nameField = () => {
  const name = form.value.name.trim();
  return name ? { name } : {};
};

/** The settings of an agent that have a value. @param {string} agent */
const ownSettings = (agent) =>
  Object.fromEntries(Object.entries(settingValues(agent, overrides.value)).filter(([, value]) => value !== null));

/** The practice of an agent: the fields that are common to all, and the agent's settings. @param {string} agent */
function practiceFields(agent) {
  const elsewhere = [
    "agent", "name", "seed", ...WALK_FIELDS, ...WORLD_FIELDS, ...RACE_FIELDS,
    ...Object.keys(laneSettings(form.value.lanes)),
  ];
  const common = select(commonFields(), (field) => !elsewhere.includes(field));
  return { ...common, settings: ownSettings(agent) };
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

/** Request body of a what-if, which has ideal robots: the practice, without seed, pace, world and build tolerance. */
export function whatIfBody() {
  const { agent } = form.value;
  const body = { agent, ...walkFields(), ...practiceFields(agent) };
  const others = ["simulator", "world", "disturbances", "tolerance", ...SHOW_FIELDS];
  return select(body, (field) => !others.includes(field));
}

/**
 * The fields of an agent's lane that are not the default, and all settings that are the agent's own.
 * @param {string} agent
 */
function laneFields(agent) {
  const { settings } = agentOf(agent);
  const given = Object.entries(laneSettings([agent]))
    .map(([field, setting]) => ({ name: field.slice(agent.length + 1), value: form.value[field], setting }))
    .filter(({ value }) => value !== null);
  const own = given.filter(({ name }) => name in settings).map(({ name, value }) => [name, value]);
  const others = given.filter(({ name, value, setting }) => !(name in settings) && value !== setting.default);
  const ofAgent = own.length ? { settings: Object.fromEntries(own) } : {};
  return { ...Object.fromEntries(others.map(({ name, value }) => [name, value])), ...ofAgent };
}

/** Agent → id of a training. @typedef {Record<string, string | undefined>} TrainingIds */

/**
 * Request body of a race. Its learners practise first, continue from a table, use it as it is, or, if they keep
 * learning in the race, begin there.
 * @param {{ continued?: TrainingIds, tables?: TrainingIds, isUnpractised?: boolean }} how
 */
export const raceBody = ({ continued = {}, tables = {}, isUnpractised = false } = {}) => ({
  ...walkFields(),
  ...nameField(),
  steps: form.value.race_steps,
  seed: form.value.seed,
  lanes: form.value.lanes.map((agent) => {
    const own = laneFields(agent);
    if (!learns(agent)) return { agent, ...own };
    if (isUnpractised) return { agent, ...own, observation: form.value.observation, settings: ownSettings(agent) };
    if (tables[agent]) return { agent, ...own, training_id: tables[agent] };
    return { agent, ...own, training: { ...practiceFields(agent), ...beginning(continued[agent]) } };
  }),
});
