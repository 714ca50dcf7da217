// Display names of what the server knows by identifiers, and of the fields and values of settings.
import { worldTitle } from "./disturbances.js";
import { sentence, t } from "./format.js";
import { customRobotInWords, offered, partInWords, presetOf, storedName } from "./robots.js";
import { agentOf, choiceTitle, options, shortTitle, titleOf } from "./settings.js";

/** @import { Described, GaitConfig, RobotConfig } from "./types.js" */

/** @type {(list: Described[] | undefined, name: string) => Described | undefined} */
const find = (list, name) => list?.find((item) => item.name === name);

/** @param {GaitConfig} gait */
export const gaitTitle = (gait) =>
  typeof gait === "string" ? find(options.value?.gaits, gait)?.title ?? gait : ownGaitTitle(gait);

/** A gait by what it is made of: "Groups 1+3, 2+5, 4". @param {Exclude<GaitConfig, string>} gait */
function ownGaitTitle({ groups, pairs, symmetry }) {
  const parts = groups ?? pairs;
  if (Array.isArray(parts)) return `Groups ${parts.map((legs) => legs.join("+")).join(", ")}`;
  return `Custom gait, ${parts ?? (symmetry === "origin" ? "opposite legs" : "mirrored legs")}`;
}
/** @param {RobotConfig} robot */
export function robotTitle(robot) {
  const custom = customRobotInWords(robot);
  const name = presetOf(robot) ?? "own robot";
  // What people call a robot stays as they write it.
  const title = find(options.value?.robots, name)?.title ?? storedName(robot);
  return custom ? sentence(custom) : title ?? sentence(name);
}
/** @type {(field: string, choice: string) => string} */
const titleOfChoice = (field, choice) => {
  const setting = options.value?.settings[field];
  return setting ? choiceTitle(setting, choice) : choice;
};
/** @param {string} name */
export const observationTitle = (name) => titleOfChoice("observation", name);
/** What a step's reward is: "reward along the track". @param {string} name */
export const rewardInWords = (name) => `reward ${titleOfChoice("reward", name)}`;
/** Model that a search plans with: "nominal model". @param {string} name */
export const planningModelTitle = (name) => titleOfChoice("plans_with", name);
/** @param {string} name */
export const simulatorTitle = (name) => find(options.value?.simulators, name)?.title ?? name;
/** @param {string} name */
export const clockTitle = (name) => find(options.value?.clocks, name)?.title ?? name;

/** Meaning of flat parts of a lane's line under each clock. @type {Record<string, string>} */
const FLAT_PARTS = {
  paper: t("Flat parts are thinking, which takes as long as it did in the paper."),
  wall: t("Flat parts are thinking, which takes as long as it did on this machine."),
  free: t("Thinking takes no time without a clock: in a flat part a robot gains no ground."),
};

/** @param {string} clockName */
export const flatParts = (clockName) => FLAT_PARTS[clockName] ?? t("Flat parts are thinking.");

/**
 * [name, title] of each, for a list of choices.
 * @param {Described[] | undefined} list
 * @param {(name: string) => string} nameOf
 * @returns {[string, string][]}
 */
export const choicesOf = (list, nameOf) => (list ?? []).map(({ name }) => [name, sentence(nameOf(name))]);

/**
 * Robots to choose from, those that are hidden only if they are chosen.
 * @type {(chosen: unknown[]) => [string, string][]}
 */
export const robotChoices = (chosen) =>
  offered(options.value?.robots ?? [], chosen).map(({ name, title }) => [name, title]);

// ---- fields

/** The served name of a field that is no declared setting. @param {string} field */
const titleOfField = (field) => options.value?.titles[field];

/**
 * A field's name as the form shows it: "Learning rate α".
 * @param {string} field
 * @returns {string}
 */
export function labelOf(field) {
  const [agent, settingName] = field.split(".");
  if (settingName) return `${agentOf(agent).title}: ${labelOf(settingName).toLowerCase()}`;
  const setting = options.value?.settings[field];
  return setting ? titleOf(setting) : titleOfField(field) ?? field;
}

const ROBOT_PART = /\brobot\.([a-z_]+)/gi;
/** @param {string} text */
const withPartsInWords = (text) => text.replace(ROBOT_PART, (_, name) => `Robot, ${partInWords(name)[0]}`);

/**
 * A path of the API, such as `lanes.0.training.settings.alpha`, and what follows it where it is the subject of a
 * sentence.
 */
const FIELD = String.raw`[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*`;
const PATH = new RegExp(
  String.raw`\b((?:lanes\.\d+\.)?(?:training\.)?(?:settings\.)?)(${FIELD})(?=( must be | is missing)?)`, "g");

/**
 * A sentence of the server in which fields have their names of the form. A word such as "steps" is a field only
 * where the sentence is about it; one with an underscore always.
 * @param {string} text
 */
export const inFormWords = (text) =>
  withPartsInWords(text).replace(PATH, (...[whole, path, name, verb]) => {
    const field = name.toLowerCase();
    const isField = options.value?.settings[field] || titleOfField(field);
    return isField && (path || verb || name.includes("_")) ? labelOf(field) : whole;
  });

/** The message of a failed request. @param {{ message: string }} error */
export const messageOf = (error) => inFormWords(error.message);

// ---- fields of settings, and their values

/** @param {string} name */
export const agentTitle = (name) => agentOf(name).title;

/**
 * The name of a field of settings; of a setting the short one that it declares.
 * @param {string} field
 */
export function fieldTitle(field) {
  const setting = options.value?.settings[field];
  // Not the learner alone: some agents do not learn.
  if (field === "agent") return "Agent";
  return setting ? shortTitle(setting) : titleOfField(field) ?? field;
}

/**
 * The fields in which settings differ; a setting that an agent does not have is null there.
 * @param {Record<string, any>[]} settings
 * @param {string[]} fields
 */
export const variedFields = (settings, fields) =>
  fields.filter((field) => new Set(settings.map((values) => values[field]).filter((value) => value !== null)).size > 1);

/** @type {Record<string, (name: string) => string>} */
const VALUE_TITLES = {
  gait: gaitTitle, agent: agentTitle, observation: observationTitle, robot: robotTitle, world: worldTitle,
  plans_with: planningModelTitle,
};

/**
 * Whether the values of a field tell by themselves what they are: "Greedy", but not "0.3".
 * @param {string} field
 */
const isNamedByValue = (field) => field in VALUE_TITLES;

/**
 * A value of a setting's field in words.
 * @param {string} field
 * @param {any} value
 */
export function valueTitle(field, value) {
  if (value === null || value === undefined) return "–";
  return (VALUE_TITLES[field] ?? String)(value);
}

/**
 * Values of fields: "Sarsa(λ), α 0.1"; without those that the settings do not have.
 * @param {Record<string, any>} settings
 * @param {string[]} fields
 */
export const fieldsInWords = (settings, fields) =>
  fields.filter((field) => settings[field] !== null && settings[field] !== undefined)
    .map((field) => (isNamedByValue(field) ? "" : `${fieldTitle(field)}\u00a0`) + valueTitle(field, settings[field]))
    .join(", ");
