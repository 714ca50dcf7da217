// What trainings and races are made of, field by field: what some differ in, and what they have in common, in words.
import { changesInWords, rateChanges } from "./training.js";
import { disturbancesOf, inTime, joinedBySteps } from "./disturbances.js";
import { count, sentence, whole } from "./format.js";
import { canonical, formRobot } from "./robots.js";
import { runOf, trainingIds } from "./selectors.js";
import { agentOf, laneTitle, settingInWords, shortTitle } from "./settings.js";
import { served } from "./store.js";
import { agentTitle, gaitTitle, observationTitle, rewardInWords, robotTitle, simulatorTitle } from "./titles.js";

/** @import { Disturbance, Run, SettingOption } from "./types.js" */

/**
 * A field of a run's settings. `key` is the same where runs do not differ in it: empty for what is by default, which
 * may be another value for another agent.
 * @typedef {{ value: any, key: string }} Field
 */
/** Field by name. @typedef {Record<string, Field>} Fields */

/** @type {(value: unknown) => Field} */
const always = (value) => ({ value, key: canonical(value) });
/** @type {(value: unknown, byDefault: unknown) => Field} */
const unlessDefault = (value, byDefault) => {
  const key = canonical(value);
  return { value, key: key === canonical(byDefault) ? "" : key };
};

/** Of all fields that a walk has: where it is, and on what. @param {Run} run @returns {Fields} */
function ofWalk(run) {
  const { config } = run;
  const { training } = served().defaults;
  return {
    gait: always(config.gait),
    world: unlessDefault(disturbancesOf(run), []),
    robot: unlessDefault(formRobot(config.robot), formRobot(training.robot)),
    simulator: unlessDefault(config.simulator, training.simulator),
    divisions: unlessDefault(config.divisions, training.divisions),
    grid_side_m: unlessDefault(config.grid_side_m, training.grid_side_m),
    tolerance: unlessDefault(config.tolerance ?? 0, 0),
    reward: unlessDefault(config.reward ?? training.reward, training.reward),
  };
}

/** Practice. @param {Run} run @returns {Fields} */
function ofPractice(run) {
  const { config } = run;
  const { training } = served().defaults;
  const declared = agentOf(config.agent).settings;
  const settings = Object.entries(config.settings ?? {})
    .map(([name, value]) => [name, unlessDefault(value, declared[name]?.default)]);
  return {
    agent: always(config.agent),
    steps: always(config.steps),
    seed: always(config.seed),
    observation: unlessDefault(config.observation, training.observation),
    steps_per_episode: unlessDefault(config.steps_per_episode, training.steps_per_episode),
    before: unlessDefault(config.continue_from ?? null, null),
    changes: unlessDefault(changesInWords(config.agent, rateChanges(run)), []),
    ...Object.fromEntries(settings),
  };
}

/** A race with one learner has the fields of its practice, too. @param {Run} run @returns {Fields} */
function ofRace(run) {
  const { lanes, steps, seed, branch_from: branch = null } = run.config;
  const trainings = trainingIds(run).map(runOf).filter((training) => training !== null);
  const [practice, ...morePractices] = trainings.map(ofPractice);
  const isOne = practice && morePractices.length === 0;
  // Its learner is one of the lanes.
  const { seed: practice_seed, agent, ...practiceFields } = isOne ? practice : /** @type {Partial<Fields>} */ ({});
  return {
    ...practiceFields,
    ...(agent && practice_seed ? { agent: { ...agent, key: "" }, practice_seed } : {}),
    ...(morePractices.length ? { practices: always([practice, ...morePractices].map(canonical)) } : {}),
    lanes: always((lanes ?? []).map(laneTitle)),
    race_steps: unlessDefault(steps, served().defaults.race.steps),
    seed: unlessDefault(seed, served().defaults.race.seed),
    branch: unlessDefault(branch, null),
  };
}

/** The fields of a training or a race, those that are told first before the others. @param {Run} run */
export function fieldsOf(run) {
  /** @type {Fields} */
  const all = { ...(run.kind === "race" ? ofRace(run) : ofPractice(run)), ...ofWalk(run) };
  const further = Object.keys(all).filter((name) => !ORDER.includes(name));
  const [first, last] = [ORDER.slice(0, FIRST), ORDER.slice(FIRST)];
  const names = [...first, ...further, ...last].filter((name) => name in all);
  return /** @type {Fields} */ (Object.fromEntries(names.map((name) => [name, all[name]])));
}

/** The settings of agents come after the first of these. */
const ORDER = [
  "lanes", "agent", "steps",
  "gait", "seed", "world", "robot", "simulator", "observation", "divisions", "grid_side_m", "tolerance", "reward",
  "steps_per_episode", "race_steps", "practice_seed", "practices", "before", "changes", "branch",
];
const FIRST = 3;

/**
 * The names of fields in which runs differ.
 * @param {Fields[]} all
 */
export function variedIn(all) {
  const names = [...new Set(all.flatMap(Object.keys))];
  return names.filter((name) => new Set(all.map((fields) => fields[name]?.key ?? "")).size > 1);
}

// ---- in words

/** A world by its name if it has one, else by what happens. @param {Disturbance[]} disturbances */
function worldInWords(disturbances) {
  const named = served().worlds.find((world) => canonical(world.disturbances) === canonical(disturbances));
  return named?.title ?? sentence(joinedBySteps(disturbances).map(inTime).join("; "));
}

/** @type {Record<string, (value: any) => string>} */
const WORDS = {
  lanes: (titles) => titles.join(", "),
  agent: agentTitle,
  steps: (steps) => count(steps, "step"),
  gait: gaitTitle,
  seed: (seed) => `seed\u00a0${seed}`,
  world: worldInWords,
  robot: robotTitle,
  simulator: (name) => sentence(simulatorTitle(name)),
  observation: (name) => sentence(observationTitle(name)),
  reward: rewardInWords,
  race_steps: (steps) => `${count(steps, "step")} raced`,
  practice_seed: (seed) => `practised with seed\u00a0${seed}`,
  practices: () => "other practice",
  before: (id) => (id === null ? "from the start" : `continues ${runOf(id)?.name || "an earlier one"}`),
  changes: (words) => words.join(", ") || "nothing changed",
  branch: (branch) => (branch === null ? "from the start" : `from step ${whole(branch.step + 1)}`),
};

/** @type {(name: string, agent: string) => SettingOption | undefined} */
const declaredOf = (name, agent) => agentOf(agent).settings[name] ?? served().settings[name];

/**
 * A field of a run in words: "α 0.3", "500 steps"; empty where the run has none.
 * @param {Fields} fields
 * @param {string} name
 */
export function fieldInWords(fields, name) {
  const field = fields[name];
  if (!field || field.value === undefined) return "";
  if (name in WORDS) return WORDS[name](field.value);
  const setting = declaredOf(name, fields.agent?.value ?? "");
  return setting ? settingInWords(setting, field.value) : `${name} ${field.value}`;
}

/** What a run is, by some of its fields: "α 0.3, 500 steps". @type {(fields: Fields, names: string[]) => string} */
export const differenceInWords = (fields, names) =>
  names.map((name) => fieldInWords(fields, name)).filter(Boolean).join(", ");

/** What all practices of a race have in common is told with its trainings. */
const UNTOLD = new Set(["practices", "practice_seed"]);

/**
 * What runs have in common, but for what is by default.
 * @param {Fields[]} all
 * @param {string[]} varied what they differ in
 */
export function commonInWords([first], varied) {
  const isTold = (/** @type {string} */ name) =>
    !varied.includes(name) && !UNTOLD.has(name) && first[name].key !== "";
  return Object.keys(first).filter(isTold).map((name) => fieldInWords(first, name)).filter(Boolean);
}

/** The title of what differs in one field only. @type {Record<string, string>} */
const SOLE_TITLES = {
  agent: "Learners", steps: "Practice", gait: "Gaits", seed: "Seeds", world: "Worlds", robot: "Robots",
  simulator: "Simulators", observation: "Observations", before: "Continued practice", changes: "Changes while it ran",
};
/** @type {Record<string, string>} */
const LABELS = {
  agent: "learner", steps: "practice", gait: "gait", seed: "seed", world: "world", robot: "robot",
  simulator: "simulator", observation: "observation", lanes: "lanes", race_steps: "length",
  practice_seed: "seed of practice", practices: "practice", before: "earlier practice", changes: "changes",
  branch: "branch",
};

/** A field's name in a sentence: "α", "practice". @type {(name: string, agent: string) => string} */
function labelOf(name, agent) {
  const setting = declaredOf(name, agent);
  if (LABELS[name] || !setting) return LABELS[name] ?? name;
  return setting.symbol ? shortTitle(setting) : setting.title.toLowerCase();
}

/**
 * A title of runs by what they differ in: "Sweep of α", "Learners", "Races by world".
 * @param {Run} first
 * @param {string[]} varied
 */
export function titleOfSweep({ kind, config }, varied) {
  const labels = varied.map((name) => labelOf(name, config.agent ?? "")).join(" and ");
  if (kind === "race") return `Races by ${labels}`;
  const [only] = varied;
  return (varied.length === 1 && SOLE_TITLES[only]) || `Sweep of ${labels}`;
}
