// Disturbances of robots and ground: conditions of a step, their words, and their text in links and commands.
import { decimal, listed, sentence, t } from "./format.js";
import { parseSetting, quoted } from "./parse.js";
import { builtPart, kindFor, kindNamed, legIn } from "./robots.js";
import { fieldBeside, mistakeIn, options } from "./settings.js";

/** @import { Parsed } from "./parse.js" */
/** @import { Disturbance, DisturbanceKind, FieldOption, RobotConfig, Run } from "./types.js" */

const STEPS = ["at_step", "until_step"];

export { kindFor, kindNamed, legIn };

/**
 * Whether a simulator knows a kind.
 * @param {string} kind
 * @param {string} simulator
 */
export const isSimulated = (kind, simulator) => kindNamed(kind)?.simulators.includes(simulator) ?? false;

/** All disturbances of a run, by its config and while it ran. @param {Pick<Run, "config" | "changes">} run */
export const disturbancesOf = ({ config, changes = [] }) => [
  ...(config.disturbances ?? []),
  ...changes.flatMap(({ disturbance }) => (disturbance ? [disturbance] : [])),
];

// ---- what holds in a step

/** @type {(disturbance: Disturbance, step: number) => boolean} */
const holdsAt = ({ at_step, until_step }, step) =>
  at_step <= step && (until_step === undefined || until_step === null || step < until_step);

/**
 * A disturbance by what it changes, leg by leg.
 * @param {Disturbance} disturbance
 * @returns {[string, Disturbance][]}
 */
function partsOf(disturbance) {
  const { kind, leg, legs } = disturbance;
  const { identified_by = [], part = [] } = kindNamed(kind) ?? {};
  if (legs) return legs.map((number) => [["leg", number, ...part].join(" "), { ...disturbance, legs: [number] }]);
  const key = [leg ? "leg" : kind, ...identified_by.map((field) => disturbance[field])].join(" ");
  return [[key, disturbance]];
}

/** Whether what changes one thing replaces what changes another: of a leg that of its joints. */
const covers = (/** @type {string} */ key, /** @type {string} */ other) => other === key || other.startsWith(`${key} `);

/** @param {Disturbance} disturbance */
const keysOf = (disturbance) => partsOf(disturbance).map(([key]) => key);

/**
 * The disturbances that hold in a step, leg by leg: a later one of the same thing replaces an earlier one.
 * @param {Disturbance[]} disturbances
 * @param {number} step counted from 0
 * @param {RobotConfig} [robot] to which they happen
 */
export function conditionsAt(disturbances, step, robot) {
  /** @type {Map<string, Disturbance>} */
  const newest = new Map();
  const lasting = disturbances.filter((disturbance) =>
    kindNamed(disturbance.kind)?.lasts !== false && holdsAt(disturbance, step));
  for (const disturbance of lasting.sort((a, b) => a.at_step - b.at_step)) {
    for (const [key, part] of partsOf(disturbance)) {
      [...newest.keys()].filter((old) => covers(key, old)).forEach((old) => newest.delete(old));
      newest.set(key, part);
    }
  }
  return [...newest.values()].filter((disturbance) =>
    !kindNamed(disturbance.kind)?.repairs && !isNothing(disturbance, robot));
}

/**
 * The size at which nothing happens: a slope of 0°, the friction with which the robot was built; null without one.
 * @param {string} name of the kind
 * @param {RobotConfig} [robot]
 */
export function nothingOf(name, robot) {
  const { nothing = null } = kindNamed(name) ?? {};
  return typeof nothing === "string" ? builtPart(robot, nothing, options.value?.robots ?? []) : nothing;
}

/** Whether it only ends an earlier one. @param {Disturbance} disturbance @param {RobotConfig} [robot] */
function isNothing(disturbance, robot) {
  const { size = null } = kindNamed(disturbance.kind) ?? {};
  return size !== null && disturbance[size] === nothingOf(disturbance.kind, robot);
}

/**
 * Whether something would change: a repair, or a slope of 0°, has to end something that holds.
 * @param {Disturbance} disturbance
 * @param {Disturbance[]} conditions
 * @param {RobotConfig} [robot]
 */
export function changesSomething(disturbance, conditions, robot) {
  if (!kindNamed(disturbance.kind)?.repairs && !isNothing(disturbance, robot)) return true;
  const keys = keysOf(disturbance);
  return conditions.some((other) => keysOf(other).some((key) => keys.some((mine) => covers(mine, key))));
}

/**
 * Add a disturbance to those chosen for the same step. It replaces those that it contradicts.
 * @param {Disturbance[]} chosen
 * @param {Disturbance} disturbance
 * @param {Disturbance[]} before those that hold without them
 * @param {RobotConfig} [robot]
 */
export function chosenWith(chosen, disturbance, before, robot) {
  const keys = keysOf(disturbance);
  const isKept = (/** @type {string} */ key) => !keys.some((mine) => covers(mine, key) || covers(key, mine));
  const remaining = chosen.flatMap(partsOf).flatMap(([key, part]) => (isKept(key) ? [part] : []));
  return [...remaining, ...(changesSomething(disturbance, before, robot) ? [disturbance] : [])];
}

/**
 * The disturbances that hold in a training that runs, those just sent to it included.
 * @param {Run} run
 */
export function conditionsNow(run) {
  const disturbances = disturbancesOf(run);
  const changed = (run.changes ?? []).map(({ step }) => step);
  return conditionsAt(disturbances, Math.max(run.progress.done, ...changed), run.config.robot);
}

// ---- words

const MIN_METRES = 0.1;
const JOIN = "\u00a0";

/** @type {(value: any, unit: string | null) => string} */
export function withUnit(value, unit) {
  const text = decimal(value).replace("-", "\u2212");
  if (unit === "m" && value !== 0 && Math.abs(value) < MIN_METRES) {
    return `${decimal(Number((1000 * value).toPrecision(4)))}${JOIN}mm`;
  }
  return unit === "°" ? `${text}°` : `${text}${unit ? JOIN + unit : ""}`;
}

/** The fields of a disturbance that are not its kind's defaults, in words. @param {Disturbance} disturbance */
function fieldsInWords(disturbance) {
  const fields = Object.entries(kindNamed(disturbance.kind)?.fields ?? {});
  // Beside the title of its kind, the only one that must be given needs no title.
  const isOnlyOne = fields.filter(([, { is_required }]) => is_required).length === 1;
  return fields
    .filter(([name, field]) =>
      !STEPS.includes(name) && !field.is_list && name in disturbance && disturbance[name] !== field.default)
    .map(([name, field]) => {
      const title = field.is_required && isOnlyOne ? "" : `${field.title.toLowerCase()} `;
      return `${title}${withUnit(disturbance[name], field.unit)}`;
    });
}

/** Adjective of a leg to which a kind of disturbance has happened. @param {string} kind */
export const adjectiveOf = (kind) => kindNamed(kind)?.adjective ?? kind;

/** @param {number[]} legs */
const legsInWords = (legs) =>
  (legs.length > 1 ? t("legs\u00a0{legs}", { legs: legs.join(", ") }) : t("leg\u00a0{leg}", { leg: legs[0] }));

/**
 * A disturbance in a few words: "legs 1, 4 limp", "slope 8°".
 * @param {Disturbance} disturbance
 */
export function inWords(disturbance) {
  const values = fieldsInWords(disturbance);
  const { kind, leg, legs, joint, angle_rad } = disturbance;
  if (legs) return [`${legsInWords(legs)} ${adjectiveOf(kind)}`, ...values].join(", ");
  if (leg) {
    const stuck = { leg, joint: `${joint}`, kind, angle: withUnit(angle_rad, "rad") };
    return t("leg\u00a0{leg}: {joint} {kind} at {angle}", stuck);
  }
  const title = (kindNamed(kind)?.title ?? kind).toLowerCase();
  return [title, values.join(", ")].filter(Boolean).join(" ");
}

/** Merge the same disturbance of several legs. @param {Disturbance[]} parts */
function joined(parts) {
  /** @type {Map<string, Disturbance>} */
  const byWords = new Map();
  for (const condition of parts) {
    const { legs, ...rest } = condition;
    const key = JSON.stringify({ ...rest, at_step: 0, until_step: 0, legs: Boolean(legs) });
    const before = byWords.get(key);
    const all = legs && before?.legs ? [...new Set([...before.legs, ...legs])].sort((a, b) => a - b) : legs;
    byWords.set(key, all ? { ...condition, legs: all } : condition);
  }
  return [...byWords.values()];
}

/**
 * Conditions in words: ["legs 1, 4 limp", "slope 8°"].
 * @param {Disturbance[]} conditions
 */
export const conditionsInWords = (conditions) => joined(conditions).map(inWords);

/**
 * A disturbance and its steps: "legs 1, 4 limp from step 26 to step 30". One that holds from the start names no step.
 * @param {Disturbance} disturbance
 */
export function inTime(disturbance) {
  const lasts = kindNamed(disturbance.kind)?.lasts ?? true;
  const step = disturbance.at_step + 1;
  const words = [inWords(disturbance)];
  if (!lasts) words.push(t("in step {step}", { step }));
  else if (disturbance.at_step > 0) words.push(t("from step {step}", { step }));
  if (disturbance.until_step) words.push(t("to step {step}", { step: disturbance.until_step }));
  return words.join(" ");
}

/**
 * Disturbances of the same kind and steps as one.
 * @param {Disturbance[]} disturbances
 */
export function joinedBySteps(disturbances) {
  const moments = [...new Set(disturbances.map(({ at_step, until_step }) => `${at_step} ${until_step ?? ""}`))];
  return moments.flatMap((moment) =>
    joined(disturbances.filter(({ at_step, until_step }) => `${at_step} ${until_step ?? ""}` === moment)));
}

/** @param {Disturbance} disturbance */
export const legsOf = ({ leg, legs }) => legs ?? (leg ? [leg] : []);

/** Conditions of each leg: "limp", "femur stuck, weak". @param {Disturbance[]} conditions */
export function legStates(conditions) {
  /** @type {Map<number, string>} */
  const states = new Map();
  for (const condition of conditions) {
    const word = condition.leg ? `${condition.joint} ${condition.kind}` : adjectiveOf(condition.kind);
    for (const leg of legsOf(condition)) states.set(leg, [states.get(leg), word].filter(Boolean).join(", "));
  }
  return states;
}

/**
 * The disturbance that a press on a leg stands for: the wanted one, or a repair if that already holds. What happened
 * to a leg as a whole, such as its loss, can only be repaired.
 * @param {Disturbance[]} conditions
 * @param {number} leg
 * @param {{ kind: string, [field: string]: any }} wanted without the leg
 */
export function pressed(conditions, leg, wanted) {
  const ofLeg = conditions.filter((condition) => legsOf(condition).includes(leg));
  const isSame = (/** @type {Disturbance} */ disturbance) =>
    (disturbance.legs && !kindNamed(disturbance.kind)?.part.length)
    || Object.entries(wanted).every(([name, value]) => disturbance[name] === value);
  const repair = options.value?.disturbances.find(({ repairs }) => repairs)?.name ?? "";
  if (wanted.kind === repair || ofLeg.some(isSame)) return { kind: repair, legs: [leg] };
  return { ...wanted, ...(kindNamed(wanted.kind)?.fields.legs ? { legs: [leg] } : { leg }) };
}

// ---- the text of a disturbance, as the command line has it: limp:legs=1,4:at=25

/**
 * The kind and the fields of a text, by the fields' short names; nothing is checked.
 * @param {string} text
 */
export function splitText(text) {
  const [kind, ...parts] = text.split(":");
  /** @type {[string, string][]} */
  const fields = parts.map((part) => {
    const at = part.indexOf("=");
    return at < 0 ? [part, ""] : [part.slice(0, at), part.slice(at + 1)];
  });
  return { kind, fields };
}

/** @type {(kind: string, fields: [string, string][]) => string} */
const joinText = (kind, fields) => [kind, ...fields.map(([name, value]) => `${name}=${value}`)].join(":");

/** The name of a kind's field in a text. @type {(kind: string, field: string) => string} */
export const shortName = (kind, field) => kindNamed(kind)?.fields[field]?.short ?? field;

/**
 * A text with another value of a field; without the field if the value is empty.
 * @param {string} text
 * @param {string} field
 * @param {string} value
 */
export function withField(text, field, value) {
  const { kind, fields } = splitText(text);
  const name = shortName(kind, field);
  const isSame = (/** @type {[string, string]} */ [key]) => key === name || key === field;
  if (value === "") return joinText(kind, fields.filter((pair) => !isSame(pair)));
  const changed = fields.map((pair) => (isSame(pair) ? /** @type {[string, string]} */ ([name, value]) : pair));
  return joinText(kind, fields.some(isSame) ? changed : [...fields, [name, value]]);
}

/**
 * The text of a disturbance.
 * @param {Partial<Disturbance> & { kind: string }} disturbance
 */
export const textOf = ({ kind, ...fields }) => {
  const order = Object.keys(kindNamed(kind)?.fields ?? {});
  const set = Object.entries(fields).filter(([name, value]) =>
    value !== null && value !== undefined && value !== kindNamed(kind)?.fields[name]?.default);
  set.sort(([a], [b]) => order.indexOf(a) - order.indexOf(b));
  return joinText(kind, set.map(([name, value]) => [shortName(kind, name), String(value)]));
};

/** @type {(text: string, field: FieldOption) => Parsed<any>} */
function parseField(text, field) {
  // A required field cannot be left empty.
  const setting = field.is_required ? { ...field, default: 0 } : field;
  if (!field.is_list) return parseSetting(text, setting);
  const values = text.split(",").map((word) => parseSetting(word, setting));
  const wrong = values.find(({ mistake }) => mistake !== undefined);
  if (wrong || new Set(values.map(({ value }) => value)).size < values.length) {
    return { mistake: wrong?.mistake ?? "Enter each once" };
  }
  return { value: values.map(({ value }) => value) };
}

/**
 * A text as a disturbance, or why it is none.
 * @param {string} text
 * @param {RobotConfig} [robot] to which it happens
 * @returns {Parsed<Disturbance>}
 */
export function parseText(text, robot) {
  const { kind: name, fields } = splitText(text);
  const kind = kindFor(name, robot, legIn(fields));
  if (!kind) return { mistake: `${quoted(name)} is nothing that can happen: choose one of these` };
  /** @type {Disturbance} */
  const disturbance = { kind: name, at_step: 0 };
  const seen = new Set();
  for (const [short, value] of fields) {
    const field = Object.keys(kind.fields).find((key) => key === short || kind.fields[key].short === short);
    if (!field) return { mistake: `${kind.title}: ${quoted(short)} is none of ${namesOf(kind)}` };
    if (seen.has(field)) return { mistake: `${kind.title}: give ${quoted(short)} once` };
    seen.add(field);
    const { value: read, mistake } = parseField(value, kind.fields[field]);
    const title = kind.fields[field].title.toLowerCase();
    if (mistake !== undefined && STEPS.includes(field)) return { mistake: `${kind.title}: enter a step, from 1` };
    if (mistake !== undefined) return { mistake: `${kind.title}, ${title}: ${mistake}` };
    disturbance[field] = read;
  }
  const missing = Object.entries(kind.fields).filter(([field, { is_required }]) => is_required && !seen.has(field));
  if (missing.length) {
    return { mistake: `${kind.title}: give ${listed(missing.map(([, { title }]) => title.toLowerCase()))}` };
  }
  for (const [name_, field] of Object.entries(kind.fields).filter(([, { ranges }]) => ranges)) {
    const number = /** @type {number} */ (disturbance[name_]);
    const mistake = mistakeIn(number, fieldBeside(field, disturbance), field.is_whole);
    if (mistake) return { mistake: `${kind.title}, ${field.title.toLowerCase()}: ${mistake}` };
  }
  return { value: disturbance };
}

/** @param {DisturbanceKind} kind */
const namesOf = ({ fields }) => listed(Object.values(fields).map(({ short }) => short));

// ---- worlds in a list: a name, or what happens, joined by +

/**
 * The worlds of a text: "flat, limp:legs=1,4+slope:degrees=4". Names and kinds begin with a letter, so a comma
 * before a number belongs to a list of legs.
 * @param {string} text
 */
export const splitWorlds = (text) =>
  text.split(/;|,(?=\s*(?:[a-z]|$))/i).map((piece) => piece.trim()).filter(Boolean);

/**
 * Disturbances of a world, or why there is no such world.
 * @param {string} text
 * @returns {Parsed<Disturbance[]>}
 */
export function parseWorld(text) {
  const named = worldNamed(text);
  if (named) return { value: named.disturbances };
  if (!text.includes(":")) return { mistake: `${quoted(text)} is no world: choose among these, or say what happens` };
  /** @type {Disturbance[]} */
  const disturbances = [];
  for (const part of text.split("+")) {
    const { value, mistake } = parseText(part.trim());
    if (mistake !== undefined) return { mistake };
    disturbances.push(value);
  }
  return disturbances.some(({ at_step, until_step }) => at_step > 0 || until_step)
    ? { mistake: `${quoted(text)}: it holds from the start to the end, so leave out at and until` }
    : { value: disturbances };
}

/** @param {string} name */
export const worldNamed = (name) => options.value?.worlds.find((world) => world.name === name);

/**
 * A world in words: "Slope", "legs 2, 5 limp, slope 4°".
 * @param {string} text
 */
export function worldTitle(text) {
  const { value } = parseWorld(text);
  return worldNamed(text)?.title ?? (value ? sentence(value.map(inWords).join(", ")) : text);
}
