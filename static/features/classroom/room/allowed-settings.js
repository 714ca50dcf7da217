// The settings that a card opens, each within the card's bounds.
import { signal } from "@preact/signals";
import { html, Segments } from "../../../js/components/elements.js";
import { NumberRow } from "../../../js/components/number-row.js";
import { decimal, sentence } from "../../../js/format.js";
import { parseNumber } from "../../../js/parse.js";
import { agentOf, choiceTitle, fullTitle, rangeOf } from "../../../js/settings.js";
import { options, setEntry } from "../../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Bounds, LessonCard, Limits, SettingOption } from "../../../js/types.js" */

/** Card and setting → what was typed or chosen. @type {Signal<Record<string, any>>} */
const drafts = signal({});

const DEFAULT_AGENT = "q-learning";

/** The declaration of a setting; null for one that is a choice of names. */
/** @type {(name: string, card: LessonCard) => SettingOption | null} */
function settingOf(name, card) {
  const agent = String(card.state?.form?.agent ?? DEFAULT_AGENT);
  return agentOf(agent).settings[name] ?? options.value?.settings[name] ?? null;
}

/** The named choices of a field: [name, title]. @type {(name: string) => [string, string][]} */
function namesOf(name) {
  const { agents = [], gaits = [], robots = [], worlds = [], simulators = [], observations = [] } = options.value ?? {};
  const lists = /** @type {Record<string, { name: string, title: string }[]>} */ (
    { agent: agents, gait: gaits, robot: robots, world: worlds, simulator: simulators, observation: observations });
  return (lists[name] ?? []).map((item) => [item.name, sentence(item.title)]);
}

/**
 * What a setting may be: its choices as [value, title], or its limits.
 * @typedef {{ choices: [any, string][], limits?: undefined, isWhole?: undefined }} Choices
 * @typedef {{ choices?: undefined, limits: Limits, isWhole: boolean }} Range
 */

/** @type {(name: string, bounds: Partial<Bounds>, card: LessonCard) => Choices | Range} */
function ruleOf(name, bounds, card) {
  const setting = settingOf(name, card);
  const names = namesOf(name);
  const words = setting?.choices.map((choice) => [choice, choiceTitle(setting, choice)]) ?? [];
  const titles = new Map(/** @type {[any, string][]} */ (names.length ? names : words));
  const allowed = bounds.choices ?? [...titles.keys()];
  if (allowed.length) return { choices: allowed.map((choice) => [choice, titles.get(choice) ?? String(choice)]) };
  return { limits: limitsWithin(bounds, setting), isWhole: setting?.is_whole ?? false };
}

/** The limits of the card where it has any, else those of the setting. */
/** @type {(bounds: Partial<Bounds>, setting: SettingOption | null) => Limits} */
function limitsWithin(bounds, setting) {
  const minimum = bounds.minimum ?? setting?.minimum ?? null;
  const maximum = bounds.maximum ?? setting?.maximum ?? null;
  return {
    minimum, maximum,
    excludes_minimum: setting?.excludes_minimum === true && minimum === setting.minimum,
    excludes_maximum: setting?.excludes_maximum === true && maximum === setting.maximum,
  };
}

/** The value with which a setting begins. @type {(name: string, bounds: Partial<Bounds>, card: LessonCard) => any} */
function initialOf(name, bounds, card) {
  const form = card.state?.form ?? {};
  const settings = /** @type {Record<string, unknown>} */ (form.settings ?? {});
  const value = form[name] ?? settings[name] ?? settingOf(name, card)?.default ?? null;
  const { choices } = ruleOf(name, bounds, card);
  if (choices) return choices.some(([choice]) => choice === value) ? value : choices[0]?.[0] ?? null;
  return value;
}

/**
 * The settings that are chosen, by name; null while one is not valid.
 * @param {LessonCard} card
 * @param {number} number
 * @returns {Record<string, unknown> | null}
 */
export function chosenSettings(card, number) {
  const chosen = Object.entries(card.may ?? {}).map(([name, bounds]) => [name, valueOf(name, bounds, card, number)]);
  return chosen.some(([, value]) => value === undefined) ? null : Object.fromEntries(chosen);
}

/** @param {string} name @param {Partial<Bounds>} bounds @param {LessonCard} card @param {number} number */
function valueOf(name, bounds, card, number) {
  // A card's form has values as they were typed.
  const chosen = drafts.value[`${number} ${name}`] ?? initialOf(name, bounds, card);
  const rule = ruleOf(name, bounds, card);
  return rule.choices ? chosen : parseNumber(String(chosen), rule.limits, rule.isWhole).value;
}

/** Settings in words: "α 0.3, 500 steps". @type {(given: Record<string, any>, card: LessonCard) => string} */
export const givenInWords = (given, card) => Object.entries(given).map(([name, value]) => {
  const setting = settingOf(name, card);
  const title = namesOf(name).find(([choice]) => choice === value)?.[1];
  return title ?? `${setting?.symbol ?? setting?.title.toLowerCase() ?? name}\u00a0${decimal(String(value))}`;
}).join(", ");

/** A setting by its symbol or title, and one of its values in words. @param {string} name @param {LessonCard} card */
export function settingInWords(name, card) {
  const setting = settingOf(name, card);
  const titles = new Map(namesOf(name));
  return {
    title: setting?.symbol ?? setting?.title ?? sentence(options.value?.titles[name] ?? name),
    valueInWords: (/** @type {unknown} */ value) => titles.get(String(value)) ?? String(value),
  };
}

/** @param {{ card: LessonCard, number: number, isDisabled: boolean }} props */
export const May = ({ card, number, isDisabled }) => html`
  <fieldset class="may" disabled=${isDisabled}>
    <legend>You may change</legend>
    ${Object.entries(card.may ?? {}).map(([name, bounds]) => html`
      <${Setting} key=${name} name=${name} bounds=${bounds} card=${card} number=${number} />
    `)}
  </fieldset>
`;

/** @param {{ name: string, bounds: Partial<Bounds>, card: LessonCard, number: number }} props */
function Setting({ name, bounds, card, number }) {
  const setting = settingOf(name, card);
  const label = setting ? fullTitle(setting) : sentence(options.value?.titles[name] ?? name);
  const rule = ruleOf(name, bounds, card);
  const draft = drafts.value[`${number} ${name}`] ?? initialOf(name, bounds, card);
  const onValue = (/** @type {any} */ value) => setEntry(drafts, `${number} ${name}`, value);
  if (rule.choices) {
    return html`<div class="may-row"><span>${label}</span>
      <${Segments} label=${label} choices=${rule.choices} value=${draft} onValue=${onValue} /></div>`;
  }
  const { limits, isWhole } = rule;
  const parsed = parseNumber(String(draft ?? ""), limits, isWhole);
  return html`
    <${NumberRow} id=${`may-${name}`} label=${label} limits=${limits} isWhole=${isWhole} text=${draft} parsed=${parsed}
      words=${sentence(rangeOf(limits))} onText=${onValue} />
  `;
}
