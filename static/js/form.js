// The form's values, what was typed that is none, and the request bodies that they make.
import { batch, computed, signal } from "@preact/signals";
import { isSimulated, parseText } from "./disturbances.js";
import { listed } from "./format.js";
import { makeTexts, parseChoice, parseChoiceOrParts, parseChoices, parseName, parseSetting } from "./parse.js";
import { ignored, page } from "./page-state.js";
import { linkedText, unlinked } from "./robots.js";
import {
  agentOf, bounded, isClosed, isPreset, laneSettings, learners, learns, limitsOf, settingsOf,
} from "./settings.js";
import { options, role, served } from "./store.js";

/** @import { Parsed } from "./parse.js" */
/** @import { FormValue, FormValues, GaitConfig, RobotConfig, SettingValue } from "./types.js" */

/** Empty until the server's options have come; no component shows the form before. */
const UNKNOWN = /** @type {FormValues} */ ({});

/** Whether the form shows a spectator the settings of the run that is shown, which are not in the address. */
export const isReadOnly = computed(() => role.value === "spectator" && page.form.value.size === 0);
/** The texts of those settings. */
export const stageTexts = signal(new URLSearchParams());
/** Texts set by a person or a link; all else is the server's default. */
const texts = () => (isReadOnly.value ? stageTexts : page.form);
const { set, keep, valueOf } = makeTexts(texts);

// ---- texts as values

/** @param {FormValue | undefined} value */
const written = (value) =>
  typeof value === "object" && value !== null && !Array.isArray(value) ? JSON.stringify(value) : String(value ?? "");

/** The text of a field, as a link has it. @type {(field: string, value: FormValue) => string} */
const textOf = (field, value) =>
  (field === "robot" && linkedText(/** @type {RobotConfig} */ (value), served().robots)) || written(value);

/** @param {{ name: string }[]} list */
const namesOf = (list) => list.map(({ name }) => name);

/** Field that is no declared setting → how its text is read. @type {Record<string, (text: string) => Parsed<any>>} */
const READERS = {
  agent: (text) => parseChoice(text, namesOf(learners.value)),
  gait: (text) => parseChoiceOrParts(text, namesOf(served().gaits)),
  robot: readRobot,
  simulator: (text) => parseChoice(text, namesOf(served().simulators)),
  observation: (text) => parseChoice(text, namesOf(served().observations)),
  lanes: (text) => parseChoices(text, namesOf(served().agents), limitsOf("lanes")),
  name: (text) => parseName(text, limitsOf("name")),
  world: (text) => parseChoice(text, namesOf(served().worlds)),
};
/** @param {string} text @returns {Parsed<RobotConfig>} */
function readRobot(text) {
  const { robots } = served();
  const { value, mistake } = parseChoiceOrParts(text, namesOf(robots));
  return mistake === undefined ? { value: unlinked(value, robots) } : { mistake };
}

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
  const declared = bounded(field, settingsOf(agents)[field] ?? laneSettings(agents)[field] ?? served().settings[field]);
  return (READERS[field] ?? ((/** @type {string} */ typed) => parseSetting(typed, declared)))(text);
}

/**
 * The defaults of the fields that do not depend on the learner.
 * @returns {Record<string, FormValue>}
 */
function commonDefaults() {
  const { training, race } = served().defaults;
  const notLimited = ["agent", "disturbances", "settings"];
  const common = Object.entries(training).filter(([field]) => !notLimited.includes(field));
  return { ...Object.fromEntries(common), world: served().worlds[0].name, race_steps: race.steps, name: "" };
}

/**
 * The lanes of a race by default: those of the server, in which the learner's is the chosen one's.
 * @param {string} agent
 */
function defaultLanes(agent) {
  const { training, race } = served().defaults;
  return race.lanes.map((lane) => (lane.agent === training.agent ? agent : lane.agent));
}

/** Values of an agent's settings. @type {(agent: string) => Record<string, SettingValue>} */
const settingValues = (agent) =>
  Object.fromEntries(Object.entries(settingsOf([agent])).map(([name, setting]) =>
    [name, valueOf(name, (text) => parseSetting(text, setting), setting.default)]));

/** @type {(field: string, byDefault: FormValue, agents?: string[]) => [string, FormValue]} */
const entryOf = (field, byDefault, agents = []) =>
  [field, valueOf(field, (text) => read(field, text, agents), byDefault)];

/** @returns {FormValues} */
function complete() {
  const [, agent] = /** @type {[string, string]} */ (entryOf("agent", served().defaults.training.agent));
  const [, lanes] = /** @type {[string, string[]]} */ (entryOf("lanes", defaultLanes(agent)));
  const common = Object.entries(commonDefaults()).map(([field, value]) => entryOf(field, value));
  const ofLanes = Object.entries(laneSettings(lanes)).map(([field, setting]) => entryOf(field, setting.default, lanes));
  const disturb = texts().value.getAll(REPEATED);
  return /** @type {FormValues} */ (
    { ...Object.fromEntries([...common, ...ofLanes]), agent, lanes, disturb, ...settingValues(agent) });
}

/** The form without the settings of the chosen learner. */
const commonFields = () => {
  const agentSettings = settingsOf([form.value.agent]);
  return select(form.value, (field) => !(field in agentSettings));
};

/** The common fields, and the settings of the chosen learner. */
export const form = computed(() => (options.value ? complete() : UNKNOWN));

/** The learners whose settings the form has: the chosen one, and the others of the race. */
const learnersInUse = computed(() => [...new Set([form.value.agent, ...form.value.lanes.filter(learns)])]);

/**
 * The fields whose text is not valid: what was typed, and what is valid for another learner only. Any of them holds
 * the start.
 */
export const wrong = computed(() => {
  /** @type {Record<string, { text: string, mistake: string }>} */
  const errors = {};
  if (!options.value) return errors;
  const typed = texts().value;
  const check = (/** @type {string} */ field, /** @type {string[]} */ agents) => {
    const text = typed.get(field);
    const { mistake } = text === null ? {} : read(field, text, agents);
    if (text !== null && mistake !== undefined) errors[field] ??= { text, mistake };
  };
  for (const agent of learnersInUse.value) Object.keys(settingsOf([agent])).forEach((name) => check(name, [agent]));
  for (const field of Object.keys({ ...commonDefaults(), agent: "", lanes: "" })) check(field, []);
  const { lanes } = form.value;
  Object.keys(laneSettings(lanes)).forEach((field) => check(field, lanes));
  const { world, disturb, simulator, robot } = form.value;
  const impossible = disturbancesOf(world).find(({ kind }) => !isSimulated(kind, simulator));
  if (impossible) errors.world ??= { text: world, mistake: unknownTo(simulator, impossible.kind) };
  for (const text of disturb) {
    const mistake = mistakeInText(text, simulator, robot);
    if (mistake) errors[REPEATED] ??= { text, mistake };
  }
  return errors;
});

/** Disturbances of a named world. @param {string} name */
const disturbancesOf = (name) => served().worlds.find((world) => world.name === name)?.disturbances ?? [];

/** @type {(simulator: string, kind: string) => string} */
export function unknownTo(simulator, kind) {
  const simulators = served().simulators.map(({ name }) => name).filter((name) => isSimulated(kind, name));
  return `The ${simulator} simulator knows no ${kind}: choose ${listed(simulators)}`;
}

/**
 * Why a text of a disturbance is not valid; null if it is.
 * @param {string} text
 * @param {string} simulator
 * @param {RobotConfig} [robot]
 */
export function mistakeInText(text, simulator, robot) {
  const { value, mistake } = parseText(text, robot);
  return mistake ?? (isSimulated(value.kind, simulator) ? null : unknownTo(simulator, value.kind));
}

/** Field → why its text is not valid; any entry disables the start. */
export const mistakes = computed(() =>
  Object.fromEntries(Object.entries(wrong.value).map(([field, { mistake }]) => [field, mistake])),
);

/** The steps of practice; null while their field has a text that is none. @returns {number | null} */
export const validSteps = () => ("steps" in mistakes.value ? null : form.value.steps);

/** Change fields. @param {Record<string, FormValue>} changes */
export const setFields = (changes) => batch(() => {
  set(Object.fromEntries(Object.entries(changes).map(([field, value]) =>
    [field, field === REPEATED ? /** @type {string[]} */ (value) : [textOf(field, value)]])));
  // What a spectator tries is theirs even where it is the default.
  if (role.peek() !== "spectator") leaveOutDefaults();
});

/** @type {(field: string, value: FormValue) => void} */
export const setField = (field, value) => setFields({ [field]: value });

/** Whether a person or a link has chosen the learner; else the page offers one that suits the body. */
export const learnerIsChosen = signal(false);

/** Choose the learner. @param {string} agent */
export const chooseLearner = (agent) => batch(() => {
  learnerIsChosen.value = true;
  takeLearner(agent);
});

/**
 * Offer a learner for the body: it is taken unless a person has chosen one, or a feature sets it. Without one it is the
 * server's default.
 * @param {string | null} agent
 */
export function offerLearner(agent) {
  const offered = agent ?? served().defaults.training.agent;
  const isFree = !learnerIsChosen.value && !isReadOnly.value && !isPreset.value && !isClosed("agent");
  if (isFree && offered !== form.value.agent && learns(offered)) takeLearner(offered);
}

/**
 * Take a learner into the form. It takes the lane of the one before it, unless it has its own.
 * @param {string} agent
 */
function takeLearner(agent) {
  const { lanes, agent: before } = form.value;
  const isSet = texts().peek().has("lanes") && !lanes.includes(agent);
  setFields({ agent, ...(isSet ? { lanes: lanes.map((lane) => (lane === before ? agent : lane)) } : {}) });
}

/** @param {RobotConfig} robot */
const optionOf = (robot) => served().robots.find(({ name }) => name === robot);

/**
 * Choose the robot. The gait that suits it is taken, unless another one was chosen that its legs can have; and the foot
 * grid that suits its size, where that of the robot before was one.
 * @param {RobotConfig} robot
 */
export function chooseRobot(robot) {
  const preset = optionOf(robot);
  /** @type {GaitConfig[]} */
  const gaits = preset?.gaits ?? [];
  const keeps = !preset || (texts().peek().has("gait") && gaits.includes(form.value.gait));
  const usual = optionOf(form.value.robot)?.grid_side_m ?? served().robots[0].grid_side_m;
  const isUsual = preset && form.value.grid_side_m === usual;
  setFields({
    robot,
    ...(keeps ? {} : { gait: /** @type {FormValue} */ (preset.gait) }),
    ...(isUsual ? { grid_side_m: preset.grid_side_m } : {}),
  });
}

/**
 * Take what was typed or chosen in a field: its value if the text is valid, else the text as it is.
 * @param {string} field
 * @param {string} text
 */
export function enter(field, text) {
  const { value, mistake } = read(field, text, [form.value.agent, ...form.value.lanes]);
  if (mistake === undefined) setField(field, value);
  else keep(field, text);
}

/**
 * Whether a text is the default of a field: of a setting, for each learner in use that has it.
 * @type {(field: string, text: string) => boolean}
 */
function isDefault(field, text) {
  const { agent, lanes } = form.value;
  const ofLearners = learnersInUse.value.map((learner) => settingsOf([learner]));
  const settingDefaults = [...ofLearners, laneSettings(lanes)].map((settings) =>
    Object.fromEntries(Object.entries(settings).map(([name, setting]) => [name, setting.default])));
  const common = { ...commonDefaults(), agent: served().defaults.training.agent, lanes: defaultLanes(agent) };
  const having = [common, ...settingDefaults].filter((defaults) => field in defaults);
  return having.length > 0 && having.every((defaults) => written(Reflect.get(defaults, field)) === text);
}

/** Leave out of the texts what is so by default. */
function leaveOutDefaults() {
  const notDefault = [...texts().peek()].filter(([field, text]) => field in wrong.value || !isDefault(field, text));
  texts().value = new URLSearchParams(notDefault);
}

/** Read the form of the link that was opened: what is no field is told, and what is the default left out. */
export const openForm = () => batch(() => {
  const agents = [form.value.agent, ...form.value.lanes];
  const valid = { ...form.value, ...served().settings, ...settingsOf(agents), ...laneSettings(agents) };
  const entries = [...page.form.peek()];
  const unknown = entries.filter(([field]) => !(field in valid)).map((entry) => entry.join("="));
  ignored.query.value = [...ignored.query.peek(), ...unknown];
  page.form.value = new URLSearchParams(entries.filter(([field]) => field in valid));
  learnerIsChosen.value = page.form.peek().has("agent");
  // What a link says goes before what is preset, the default too.
  if (!isPreset.peek()) leaveOutDefaults();
});

/** Let a spectator change the form. */
export const tryOwnSettings = () => {
  page.form.value = new URLSearchParams([["agent", form.value.agent], ...stageTexts.value]);
};

// ---- request bodies

const WALK_FIELDS = ["gait", "robot", "simulator", "divisions", "grid_side_m", "tolerance", "reward"];
const RACE_FIELDS = ["race_steps", "lanes"];
const WORLD_FIELDS = ["world", REPEATED];

/** @type {<Value>(values: Record<string, Value>, isWanted: (field: string) => boolean) => Record<string, Value>} */
const select = (values, isWanted) =>
  Object.fromEntries(Object.entries(values).filter(([field]) => isWanted(field)));

const walkFields = () => ({ ...select(form.value, (field) => WALK_FIELDS.includes(field)), ...worldFields() });

/** The named world and the disturbances besides, unless there are none. */
function worldFields() {
  const { world, disturb, robot } = form.value;
  const disturbances = disturb.flatMap((text) => parseText(text, robot).value ?? []);
  return {
    ...(world === served().worlds[0].name ? {} : { world }),
    ...(disturbances.length ? { disturbances } : {}),
  };
}

/** The robot, its gait and its foot grid, of which some things are known before anything runs. */
export const bodyFields = () =>
  select(form.value, (field) => ["gait", "robot", "divisions", "grid_side_m"].includes(field));

const nameField = () => {
  const name = form.value.name.trim();
  return name ? { name } : {};
};

/** The settings of an agent that have a value. @param {string} agent */
const ownSettings = (agent) =>
  Object.fromEntries(Object.entries(settingValues(agent)).filter(([, value]) => value !== null));

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

/**
 * The fields of an agent's lane that are not the default, and all settings that are the agent's own.
 * @param {string} agent
 */
function laneFields(agent) {
  const { settings } = agentOf(agent);
  const typed = Object.entries(laneSettings([agent]))
    .map(([field, setting]) => ({ name: field.slice(agent.length + 1), value: form.value[field], setting }))
    .filter(({ value }) => value !== null);
  const agentValues = typed.filter(({ name }) => name in settings).map(({ name, value }) => [name, value]);
  const laneValues = typed.filter(({ name, value, setting }) => !(name in settings) && value !== setting.default);
  const ofAgent = agentValues.length ? { settings: Object.fromEntries(agentValues) } : {};
  return { ...Object.fromEntries(laneValues.map(({ name, value }) => [name, value])), ...ofAgent };
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
    const fields = laneFields(agent);
    if (!learns(agent)) return { agent, ...fields };
    if (isUnpractised) return { agent, ...fields, observation: form.value.observation, settings: ownSettings(agent) };
    if (tables[agent]) return { agent, ...fields, training_id: tables[agent] };
    return { agent, ...fields, training: { ...practiceFields(agent), ...beginning(continued[agent]) } };
  }),
});
