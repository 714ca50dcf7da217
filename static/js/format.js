// Texts, numbers, times and lists for people, in the language that the page's HTML says.
import { SAME_MOMENT_S } from "./replay-frames.js";

/** @import { Translation } from "./translation.js" */

const { lang = "" } = document.documentElement;
/** Of the page's language; null in English, which is what the code has. @type {Translation | null} */
export const translation = lang && lang !== "en"
  ? await (await import("./translation.js")).translationTo(lang, t) : null;

/**
 * What the server names, as agents and worlds, in the page's language.
 * @template Answer
 * @param {Answer} answer
 * @returns {Answer}
 */
export const inWords = (answer) => translation?.answer(answer) ?? answer;
/** A sentence of the server, in the page's language. @param {string} text */
export const said = (text) => translation?.said(text) ?? text;
/** The name of a run: what a person has typed stays. @param {{ name: string, is_named: boolean }} run */
export const nameOf = ({ name, is_named }) => (is_named ? name : translation?.name(name) ?? name);
/** The name of the run in the picture, with how far it is. @param {string} text */
export const labelInWords = (text) => translation?.label(text) ?? text;
/** An address of this server, in the page's language. @param {string} address */
export const inLanguage = (address) =>
  (translation ? `${address}${address.includes("?") ? "&" : "?"}lang=${lang}` : address);
/** Tells the server the page's language, for the links that it makes. */
/** @type {Record<string, string>} */
export const languageHeader = translation ? { "Page-Language": lang } : {};
/** For dates; by default the browser's. */
const locale = translation ? lang : [];

/**
 * A text in the page's language, with its values: `{name}` is one, a number as `whole` has it; `{steps|step|steps}` is
 * the first text where the value is one, else the second.
 * @param {string} text in English
 * @param {Record<string, string | number>} [values]
 */
export function t(text, values = {}) {
  return (translation?.messages[text] ?? text).replace(
    /\{(\w+)(?:\|([^|}]*)\|([^}]*))?\}/g, (_, name, first, second) => {
      const value = values[name];
      if (second === undefined) return typeof value === "number" ? whole(value) : value;
      return (translation ? translation.plurals.select(Number(value)) === "one" : value === 1) ? first : second;
    });
}

const MINUS = "\u2212";
const NO_BREAK = "\u00a0";
/** Thin, and never broken: between groups of digits, and between a number and its sign. */
export const THIN_SPACE = "\u202f";
const MISSING = "–";
/** Below, digits are not grouped. */
const SMALLEST_GROUPED = 10_000;

/** @typedef {number | null | undefined} Optional a number that may not be known */

/**
 * @param {Optional} value
 * @returns {value is number}
 */
const isNumber = (value) => typeof value === "number" && !Number.isNaN(value);

/** A number as its digits have it: "0.5", in German "0,5". @param {number | string} number */
export const decimal = (number) => String(number).replace(".", translation?.mark ?? ".");

/** A number with so many decimals: "0.38", in German "0,38". @param {number} value @param {number} digits */
export const fixed = (value, digits) => decimal(value.toFixed(digits));

/**
 * Metres to the centimetre: "0.38 m".
 * @param {Optional} value
 */
export function metres(value) {
  if (!isNumber(value)) return MISSING;
  const rounded = Math.round(value * 100) / 100;
  return `${rounded < 0 ? MINUS : ""}${fixed(Math.abs(rounded), 2)}${NO_BREAK}m`;
}

const MIN_CM = 0.01;

/**
 * How far apart two distances are: "3 cm", "4 mm", "under 1 mm".
 * @param {number} value [m], not negative
 */
export function distanceApart(value) {
  if (value >= MIN_CM) return `${Math.round(100 * value)}${NO_BREAK}cm`;
  const rounded = Math.round(1000 * value);
  return rounded < 1 ? t("under 1\u00a0mm") : `${rounded}${NO_BREAK}mm`;
}

/**
 * Metres as whole millimetres without the unit: "52".
 * @param {number} value
 */
export function millimetres(value) {
  const rounded = Math.round(value * 1000);
  return `${rounded < 0 ? MINUS : ""}${Math.abs(rounded)}`;
}

/**
 * A step or a value to a tenth of a millimetre, as the server's sentences have it, without the unit: "24.4".
 * @param {number} value [m]
 */
export function tenths(value) {
  const text = fixed(Math.abs(1000 * value), 1);
  return value < 0 && /[1-9]/.test(text) ? MINUS + text : text;
}

/** The same with its unit: "24.4 mm". @param {number} value [m] */
export const inMillimetres = (value) => `${tenths(value)}${NO_BREAK}mm`;

/**
 * The duration of one decision: "<1 ms", "12 ms", "1.4 s".
 * @param {Optional} seconds
 */
export function decision(seconds) {
  if (!isNumber(seconds)) return MISSING;
  const ms = seconds * 1000;
  if (ms < 1) return "<1 ms";
  return ms < 1000 ? `${Math.round(ms)} ms` : `${fixed(ms / 1000, 1)} s`;
}

const UNDER_1_S = t("under 1 s");

/**
 * A duration: "4 s", "2 min", "1 h 5 min".
 * @param {number} seconds
 */
export function duration(seconds) {
  if (seconds < 1) return UNDER_1_S;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 90) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** An estimated duration: "about 4 s", "under 1 s". @param {number} seconds */
export const aboutDuration = (seconds) =>
  (duration(seconds) === UNDER_1_S ? UNDER_1_S : t("about {duration}", { duration: duration(seconds) }));

/**
 * A moment of a race or practice, as on the time bar: "1:05".
 * @param {number} seconds
 */
export function clockTime(seconds) {
  const rounded = Math.max(0, Math.floor(seconds + SAME_MOMENT_S));
  return `${Math.floor(rounded / 60)}:${String(rounded % 60).padStart(2, "0")}`;
}

/**
 * A whole number, its digits grouped from five on: "7800", "12 500".
 * @param {Optional} value
 */
export function whole(value) {
  if (!isNumber(value)) return MISSING;
  const digits = String(Math.round(value));
  return Math.abs(value) < SMALLEST_GROUPED ? digits : digits.replace(/\B(?=(\d{3})+$)/g, THIN_SPACE);
}

/** A text in which numbers as "2,000" are grouped as all others are. @param {string} text */
export const withGroupedDigits = (text) =>
  text.replace(/(?<![\d.,])\d{1,3}(,\d{3})+(?![\d,])/g, (digits) => whole(Number(digits.replaceAll(",", ""))));

/**
 * A share from 0 to 1: "42 %".
 * @param {number} share
 */
export const percentage = (share) => `${String(Math.round(100 * share)).replace("-", MINUS)} %`;

/**
 * A number with its noun: "500 steps", "1 step".
 * @param {number} number
 * @param {string} noun
 */
export const count = (number, noun) => t(`{number} {number|${noun}|${noun}s}`, { number });

/**
 * A factor: "×2", "×0.25".
 * @param {number} factor
 */
export const times = (factor) => `×${decimal(Number(factor.toPrecision(2)))}`;

/**
 * How long ago a moment was: "2 min ago"; from an hour on, the local time and day.
 * @param {string} iso
 */
export function ago(iso, now = Date.now()) {
  const then = Date.parse(iso);
  const seconds = (now - then) / 1000;
  if (seconds < 60) return t("just now");
  if (seconds < 3600) return t("{minutes} min ago", { minutes: Math.floor(seconds / 60) });
  const day = new Date(then);
  const time = day.toLocaleTimeString(locale, { hour: "2-digit", minute: "2-digit" });
  if (new Date(now).toDateString() === day.toDateString()) return t("today, {time}", { time });
  return `${day.toLocaleDateString(locale, { day: "numeric", month: "short" })}, ${time}`;
}

/**
 * A moment where there is little room: "17:14" today, else "24 Nov".
 * @param {string} iso
 */
export function shortTime(iso, now = Date.now()) {
  const then = new Date(iso);
  return new Date(now).toDateString() === then.toDateString()
    ? then.toLocaleTimeString(locale, { hour: "2-digit", minute: "2-digit", hourCycle: "h23" })
    : then.toLocaleDateString(locale, { day: "numeric", month: "short" });
}

/**
 * Text with a capital first letter; a Greek one is a symbol, and stays as it is.
 * @param {string} text
 */
export const sentence = (text) => text.replace(/^\p{Script=Latin}/u, (first) => first.toUpperCase());

/**
 * Items as a list in words: "a", "a and b", "a, b and c".
 * @param {string[]} items
 */
export const listed = (items) => translation?.listed(items) ??
  (items.length < 2 ? items.join("") : `${items.slice(0, -1).join(", ")} and ${items.at(-1)}`);

/** A room's code in two groups, as it is read and typed: "ABCD EFGH". @param {string} code */
export const codeInGroups = (code) =>
  `${code.slice(0, code.length / 2)}${NO_BREAK}${code.slice(code.length / 2)}`;

/** An address as a person types it. @param {string} address */
export const shortAddress = (address) => address.replace(/^https?:\/\//, "");
