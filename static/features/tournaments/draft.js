// The entry that is being made: what was chosen and typed, whether it is valid, and the request that it makes.
import { signal } from "@preact/signals";
import { parseNumber, parseSetting } from "../../js/parse.js";
import { isSame } from "../../js/robots.js";
import { agentOf, furtherSettings, kindOf, mainSettings } from "../../js/settings.js";
import { options, served } from "../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Parsed } from "../../js/parse.js" */
/** @import { Agent, RobotConfig, Run, SettingOption, Tournament } from "../../js/types.js" */

/**
 * What was chosen and typed; texts of settings are kept for each agent.
 * @typedef {object} Draft
 * @property {string} agent empty for that of the server's defaults
 * @property {Record<string, string>} texts by agent and setting
 * @property {string} steps as it was typed; empty for the whole budget
 * @property {string} robot number of one of the creatures that the rules allow; empty for the robot of the rules
 * @property {string} training id of the training whose table enters; empty without one
 * @property {string} name of the entry, which operators choose
 */

/** @type {Signal<Draft>} */
export const draft = signal({ agent: "", texts: {}, steps: "", robot: "", training: "", name: "" });

/** @param {Partial<Draft>} changes */
export const change = (changes) => {
  draft.value = { ...draft.peek(), ...changes };
};

/** The agent that enters. @param {Draft} of */
export const agentIn = ({ agent }) => agent || served().defaults.training.agent;

/** @type {(of: Draft, name: string) => string} */
const keyOf = (of, name) => `${agentIn(of)} ${name}`;

/** @type {(name: string, text: string) => void} */
export const setText = (name, text) =>
  change({ texts: { ...draft.peek().texts, [keyOf(draft.peek(), name)]: text } });

// ---- what can be chosen

/** How the state is read: the server declares it among the settings that are common to all. */
const OBSERVATION = "observation";

/** The agents by what they do, as [title, agents]. @returns {[string, Agent[]][]} */
export function agentGroups() {
  const all = options.value?.agents ?? [];
  const isSearcher = (/** @type {Agent} */ { searches, steps_ahead }) => searches || steps_ahead !== null;
  /** @type {[string, Agent[]][]} */
  const groups = [
    ["Learners", all.filter(({ learns }) => learns)],
    ["Searchers", all.filter((agent) => !agent.learns && isSearcher(agent))],
    ["Others", all.filter((agent) => !agent.learns && !isSearcher(agent))],
  ];
  return groups.filter(([, agents]) => agents.length > 0);
}

/** The settings of the agent, those that matter most first. @param {Draft} of */
export function settingsOfEntry(of) {
  const agent = agentIn(of);
  const observation = options.value?.settings[OBSERVATION];
  /** @type {[string, SettingOption][]} */
  const main = mainSettings(agent).map(({ name, setting }) => [name, setting]);
  /** @type {[string, SettingOption][]} */
  const common = observation ? [[OBSERVATION, observation]] : [];
  return [...main, ...furtherSettings(agent), ...common];
}

/** The text of a setting: what was typed, else its default. */
/** @type {(of: Draft, name: string, setting: SettingOption) => string} */
export const textOf = (of, name, setting) => of.texts[keyOf(of, name)] ?? String(setting.default ?? "");

/** The limits of the steps of practice. @param {Tournament["rules"]} rules */
export const stepLimits = ({ steps }) =>
  ({ minimum: 1, maximum: steps, excludes_minimum: false, excludes_maximum: false });

/** The steps of practice of an entry. @type {(of: Draft, rules: Tournament["rules"]) => Parsed<number | null>} */
export const readSteps = ({ steps }, rules) =>
  (steps.trim() === "" ? { value: rules.steps } : parseNumber(steps, stepLimits(rules), true));

// ---- tables that were trained before

/**
 * Whether the table of a training can enter: it has finished, within the budget, in a gait of the rules and on their
 * grid. The server knows of more, such as what it continues.
 * @type {(run: Pick<Run, "kind" | "state" | "config" | "progress">, rules: Tournament["rules"]) => boolean}
 */
export function fits({ kind, state, config, progress }, rules) {
  if (kind !== "training" || state !== "finished" || progress.done > rules.steps) return false;
  const isOnGrid = config.divisions === rules.divisions && config.grid_side_m === rules.grid_side_m;
  return isOnGrid && (isSame(config.gait, rules.gait) || creatureOf({ config }, rules) !== null);
}

/** The creature of the rules that a training was of; null where it enters on the robot of the rules. */
/** @type {(run: Pick<Run, "config">, rules: Tournament["rules"]) => RobotConfig | null} */
const creatureOf = ({ config }, { robots, gaits }) =>
  robots.find((robot, n) => isSame(config.robot, robot) && isSame(config.gait, gaits[n])) ?? null;

// ---- the request

/**
 * The request of a draft; null while something is not valid, which `mistakes` tells by field.
 * @param {Draft} of
 * @param {Tournament["rules"]} rules
 * @param {Pick<Run, "id" | "config">[]} trainings whose tables can enter
 * @returns {{ body: Record<string, unknown> | null, mistakes: Record<string, string> }}
 */
export function requestOf(of, rules, trainings) {
  const name = of.name.trim() ? { name: of.name.trim() } : {};
  const training = trainings.find(({ id }) => id === of.training);
  if (training) {
    const robot = creatureOf(training, rules);
    const { agent } = training.config;
    return { body: { agent, training_id: training.id, ...(robot && { robot }), ...name }, mistakes: {} };
  }
  const { values, mistakes } = readSettings(of);
  const steps = readSteps(of, rules);
  const agent = agentIn(of);
  const practises = agentOf(agent).learns;
  if (practises && steps.mistake !== undefined) mistakes.steps = steps.mistake;
  if (Object.keys(mistakes).length > 0) return { body: null, mistakes };
  const { [OBSERVATION]: observation, ...settings } = values;
  return {
    body: {
      agent, settings,
      ...(observation === undefined ? {} : { observation }),
      ...(practises ? { steps: steps.value } : {}),
      ...(of.robot === "" ? {} : { robot: rules.robots[Number(of.robot)] }),
      ...name,
    },
    mistakes,
  };
}

/** The settings that were typed or chosen. @param {Draft} of */
function readSettings(of) {
  /** @type {Record<string, unknown>} */
  const values = {};
  /** @type {Record<string, string>} */
  const mistakes = {};
  for (const [name, setting] of settingsOfEntry(of)) {
    if (!(keyOf(of, name) in of.texts)) continue;
    const { value, mistake } = parseSetting(textOf(of, name, setting), setting);
    if (mistake !== undefined) mistakes[name] = mistake;
    // One that is left empty is the agent's own choice.
    else if (value !== null) values[name] = value;
  }
  return { values, mistakes };
}

/** The settings that differ from the defaults: told where they are folded. @param {Draft} of @returns {string[]} */
export const changedSettings = (of) =>
  settingsOfEntry(of).filter(([name, setting]) => textOf(of, name, setting) !== String(setting.default ?? ""))
    .map(([name, setting]) => {
      const title = setting.symbol ?? setting.title.toLowerCase();
      return kindOf(setting) === "choice" ? textOf(of, name, setting) : `${title}\u00a0${textOf(of, name, setting)}`;
    });
