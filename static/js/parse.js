// Reads what a person typed or a link says: numbers, lists and choices, or the reason why it is none of them; and
// keeps the texts of a form's fields. Spaces, semicolons and decimal commas are accepted where only one reading of the
// text is valid.
import { batch, signal } from "@preact/signals";
import { kindOf, mistakeIn, rangeOf } from "./settings.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Limits, SettingOption, SettingValue } from "./types.js" */

/**
 * The value of a text, or the reason why it is not valid.
 * @template Value
 * @typedef {{ value: Value, mistake?: undefined } | { value?: undefined, mistake: string }} Parsed
 */

const LONGEST_QUOTE = 40;

/** @param {string} text */
export const quoted = (text) => `“${text.length > LONGEST_QUOTE ? `${text.slice(0, LONGEST_QUOTE)}…` : text}”`;

// ---- one number

const GROUPED_BY_SPACES = /^[+-]?\d{1,3}([ \u00a0\u2009\u202f]\d{3})+([.,]\d+)?$/;
const WITH_POINT = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const WITH_DECIMAL_COMMA = /^[+-]?\d*,\d+(e[+-]?\d+)?$/i;
const GROUPED_BY_COMMAS = /^[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d+)?$/;
const GROUPED_BY_POINTS = /^[+-]?[1-9]\d{0,2}(\.\d{3})+$/;

/**
 * The numbers that a text can mean: "1,000" is one with decimals, or a thousand.
 * @param {string} text
 * @param {boolean} isWhole
 */
function readingsOf(text, isWhole) {
  const signed = text.trim().replace(/^[\u2212\u2013]/, "-");
  const plain = GROUPED_BY_SPACES.test(signed) ? signed.replace(/[ \u00a0\u2009\u202f]/g, "") : signed;
  const readings = [];
  if (WITH_POINT.test(plain)) readings.push(plain);
  if (WITH_DECIMAL_COMMA.test(plain)) readings.push(plain.replace(",", "."));
  if (GROUPED_BY_COMMAS.test(plain)) readings.push(plain.replaceAll(",", ""));
  if (isWhole && GROUPED_BY_POINTS.test(plain)) readings.push(plain.replaceAll(".", ""));
  return [...new Set(readings.map(Number))];
}

/** @type {(text: string, limits: Limits, isWhole: boolean) => number[]} */
const validReadings = (text, limits, isWhole) =>
  readingsOf(text, isWhole).filter((value) => mistakeIn(value, limits, isWhole) === null);

/** @type {(text: string, meanings: string[]) => { mistake: string }} */
const ambiguous = (text, meanings) =>
  ({ mistake: `${quoted(text.trim())} can mean ${meanings.join(" or ")}: enter one of these` });

/**
 * @param {string} text
 * @param {Limits} limits
 * @param {boolean} isWhole
 * @returns {Parsed<number>}
 */
export function parseNumber(text, limits, isWhole) {
  const valid = validReadings(text, limits, isWhole);
  if (valid.length > 1) return ambiguous(text, valid.map(String));
  if (valid.length === 1) return { value: valid[0] };
  const [first = NaN] = readingsOf(text, isWhole);
  return { mistake: mistakeIn(first, limits, isWhole) ?? "" };
}

// ---- lists

/** Ways to divide a list into its entries. @param {string} text */
function divisionsOf(text) {
  const trimmed = text.trim();
  // Beside semicolons, a comma or a space belongs to a number.
  if (trimmed.includes(";")) return [trimmed.split(";")];
  const byCommasAndSpaces = trimmed.split(/[ \t\r\n]*,[ \t\r\n]*|[ \t\r\n]+/);
  const withDecimalCommas = trimmed.split(/[ \t\r\n]+,[ \t\r\n]*|,[ \t\r\n]+|[ \t\r\n]+/);
  const withGroupedDigits = trimmed.split(/[ \t\r\n]*,[ \t\r\n]*/);
  return [byCommasAndSpaces, withDecimalCommas, withGroupedDigits];
}

/**
 * The lists that a text can mean, entries that are there twice included.
 * @template Value
 * @param {string[][]} divisions
 * @param {(entry: string) => Value[]} readingsOfEntry those that are valid
 * @returns {Value[][]}
 */
function listReadings(divisions, readingsOfEntry) {
  /** @type {Map<string, Value[]>} */
  const byFirst = new Map();
  for (const entries of divisions) {
    const readings = entries.map((entry) => readingsOfEntry(entry.trim()));
    if (readings.every((valid) => valid.length > 0)) {
      // Of entries with several meanings, two lists are enough to tell that the list has several.
      for (const list of [readings.map((valid) => valid[0]), readings.map((valid) => valid[valid.length - 1])]) {
        byFirst.set(list.join(";"), list);
      }
    }
  }
  return [...byFirst.values()];
}

/** @param {unknown[]} list */
const hasTwice = (list) => new Set(list).size < list.length;

/**
 * @template Value
 * @param {string} text
 * @param {Value[][]} lists that the text can mean
 * @returns {Parsed<Value[]> | null} null if there is none
 */
function theOnlyOne(text, lists) {
  const valid = lists.filter((list) => !hasTwice(list));
  if (valid.length > 1) return ambiguous(text, valid.map((list) => `“${list.join("; ")}”`));
  if (valid.length === 1) return { value: valid[0] };
  return lists.length ? { mistake: "Enter each value once" } : null;
}

/**
 * The numbers of a list, or why it is none.
 * @param {string} text
 * @param {Limits} limits of each number
 * @param {boolean} isWhole
 * @returns {Parsed<number[]>}
 */
export function parseNumbers(text, limits, isWhole) {
  const divisions = divisionsOf(text);
  const reading = theOnlyOne(text, listReadings(divisions, (entry) => validReadings(entry, limits, isWhole)));
  if (reading) return reading;
  const range = rangeOf(limits);
  const numbers = divisions[0].map((entry) => readingsOf(entry, isWhole)[0] ?? NaN);
  if (!numbers.every(Number.isFinite)) {
    const kind = isWhole ? "whole numbers" : "numbers";
    return { mistake: `Enter ${kind} separated by commas, semicolons or spaces${range && `, each ${range}`}` };
  }
  if (isWhole && !numbers.every(Number.isInteger)) {
    return { mistake: `Enter whole numbers${range && `, each ${range}`}` };
  }
  return { mistake: range ? `Each must be ${range}` : mistakeIn(NaN, limits, isWhole) ?? "" };
}

/**
 * The values of a list, or why it is none.
 * @param {string} text
 * @param {SettingOption} setting
 * @returns {Parsed<SettingValue[]>}
 */
export function parseValues(text, setting) {
  if (kindOf(setting) === "number") return parseNumbers(text, setting, setting.is_whole);
  const byCommas = text.split(/[,;]/);
  const divisions = setting.choices.length ? [byCommas, text.trim().split(/[,;\s]+/)] : [byCommas];
  const lists = listReadings(divisions, (entry) => {
    const { value, mistake } = parseSetting(entry, setting);
    return mistake === undefined && entry !== "" ? [value] : [];
  });
  return theOnlyOne(text, lists) ?? { mistake: `Each must be ${setting.valid}` };
}

// ---- a setting, a choice, a name

/**
 * A value of a setting; of an optional one an empty text is none.
 * @param {string} text
 * @param {SettingOption} setting
 * @returns {Parsed<SettingValue>}
 */
export function parseSetting(text, setting) {
  const kind = kindOf(setting);
  if (kind === "number") {
    const isLeftOut = text.trim() === "" && setting.default === null;
    return isLeftOut ? { value: null } : parseNumber(text, setting, setting.is_whole);
  }
  if (kind === "switch") {
    return ["true", "false"].includes(text) ? { value: text === "true" } : refused(text, setting);
  }
  if (setting.choices.includes(text)) return { value: text };
  if (kind === "choice" && text === "" && setting.default === null) return { value: null };
  if (!setting.is_number) return setting.choices.length ? refused(text, setting) : { value: text };
  const parsed = parseNumber(text, setting, setting.is_whole);
  return parsed.mistake === undefined ? parsed : refused(text, setting);
}

/** @type {(text: string, setting: SettingOption) => { mistake: string }} */
const refused = (text, { valid }) => ({ mistake: `${quoted(text)} is not valid: it must be ${valid}` });

/**
 * One of several names.
 * @param {string} text
 * @param {string[]} names
 * @returns {Parsed<string>}
 */
export const parseChoice = (text, names) =>
  names.includes(text) ? { value: text } : { mistake: `${quoted(text)} is not offered: choose one of these` };

/**
 * Several of several names, with commas between.
 * @param {string} text
 * @param {string[]} names
 * @param {Limits} limits of their number
 * @returns {Parsed<string[]>}
 */
export function parseChoices(text, names, limits) {
  const chosen = text.split(",").map((name) => name.trim()).filter(Boolean);
  const unknown = chosen.find((name) => !names.includes(name));
  if (unknown !== undefined) return { mistake: `${quoted(unknown)} is not offered: choose among these` };
  if (mistakeIn(chosen.length, limits, true)) return { mistake: `Choose ${rangeOf(limits)} of these` };
  return { value: chosen };
}

/**
 * A choice that may also be an object with its parts, which a link has as JSON.
 * @param {string} text
 * @param {string[]} names
 * @returns {Parsed<string | Record<string, unknown>>}
 */
export function parseChoiceOrParts(text, names) {
  if (!text.startsWith("{")) return parseChoice(text, names);
  try {
    return { value: JSON.parse(text) };
  } catch {
    return { mistake: `${quoted(text)} cannot be read: choose one of these` };
  }
}

/**
 * @param {string} text
 * @param {Limits} limits of its length
 * @returns {Parsed<string>}
 */
export const parseName = (text, { maximum }) =>
  maximum !== null && text.trim().length > maximum
    ? { mistake: `Enter at most ${maximum} characters; this has ${text.trim().length}` }
    : { value: text };

/** @param {() => Signal<URLSearchParams>} ofForm the texts */
export function makeTexts(ofForm) {
  /** Field → a text that is not valid, and the last valid one. @type {Signal<Record<string, (string | null)[]>>} */
  const before = signal({});
  const lastValid = (/** @type {string} */ field, /** @type {string | null} */ text) => {
    const [wrong, last = null] = before.value[field] ?? [];
    return wrong === text ? last : null;
  };

  /** Replace the texts of fields; none leaves a field at its default. @param {Record<string, string[]>} changes */
  const set = (changes) => {
    const remaining = [...ofForm().peek()].filter(([field]) => !(field in changes));
    const added = Object.entries(changes).flatMap(([field, texts]) => texts.map((text) => [field, text]));
    ofForm().value = new URLSearchParams([...remaining, ...added]);
  };

  return {
    set,

    /**
     * The value of a field: that of its text, or while it is not valid of the last valid one, or else the default.
     * @template Value
     * @param {string} field
     * @param {(text: string) => Parsed<any>} parse
     * @param {Value} byDefault
     * @returns {Value}
     */
    valueOf(field, parse, byDefault) {
      const typed = ofForm().value.get(field);
      for (const text of typed === null ? [] : [typed, lastValid(field, typed)]) {
        const { value, mistake } = text === null ? { mistake: "" } : parse(text);
        if (mistake === undefined) return value;
      }
      return byDefault;
    },

    /** Keep a text that is not valid; the field keeps its value. @type {(field: string, text: string) => void} */
    keep: (field, text) => batch(() => {
      const typed = ofForm().peek().get(field);
      before.value = { ...before.peek(), [field]: [text, lastValid(field, typed) ?? typed] };
      set({ [field]: [text] });
    }),
  };
}

/** The lines of a text that are not empty. @param {string} text */
export const linesOf = (text) => text.split("\n").map((line) => line.trim()).filter(Boolean);

/** A typed number; null where there is none. @param {string} text */
export const numberOf = (text) => {
  const value = Number(text.replace(",", "."));
  return text.trim() && Number.isFinite(value) ? value : null;
};
