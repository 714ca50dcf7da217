// Settings as the server declares them: the kind of their control, their names, and values as text.

/** @import { SettingOption, SettingValue } from "./types.js" */

/**
 * The kind of control that a setting needs.
 * @param {SettingOption} setting
 * @returns {"number" | "choice" | "switch" | "text"}
 */
export function kindOf({ is_number, is_boolean, choices }) {
  if (is_boolean) return "switch";
  if (choices.length) return is_number ? "text" : "choice";
  return is_number ? "number" : "text";
}

/**
 * A text as a value of a setting; undefined if it is none. Limits are not checked.
 * @param {string} text
 * @param {SettingOption} setting
 * @returns {SettingValue | undefined}
 */
export function valueOf(text, setting) {
  if (setting.choices.includes(text)) return text;
  if (kindOf(setting) === "switch") return text === "true" || (text === "false" ? false : undefined);
  if (!setting.is_number) return setting.choices.length ? undefined : text;
  return text.trim() === "" || !Number.isFinite(Number(text)) ? undefined : Number(text);
}

/** A slider divides its range in about so many steps. */
const SLIDER_STEPS = 100;

/**
 * The ends and the step of a setting's slider; null without both limits. A limit that is not valid itself is one
 * step beyond the end.
 * @param {SettingOption} setting
 */
export function sliderOf({ minimum, maximum, excludes_minimum, excludes_maximum, is_whole }) {
  if (minimum === null || maximum === null) return null;
  const power = 10 ** Math.floor(Math.log10((maximum - minimum) / SLIDER_STEPS));
  const step = is_whole ? Math.max(1, power) : power;
  return { min: excludes_minimum ? minimum + step : minimum, max: excludes_maximum ? maximum - step : maximum, step };
}

/**
 * What the values of a quantity have in common: "Exploration" of "Exploration, first episode".
 * @param {string} title
 */
export const quantityOf = (title) => title.split(",")[0];

/**
 * A setting's name where there is little room: "α", "ε, first episode".
 * @param {SettingOption} setting
 */
export const shortTitle = ({ title, symbol, unit }) =>
  symbol ? title.replace(quantityOf(title), symbol) : withUnit(title, unit);

/**
 * A setting's name as a label: "Learning rate α", "Foot grid, side (m)".
 * @param {SettingOption} setting
 */
export const fullTitle = ({ title, symbol, unit }) => withUnit(symbol ? `${title} ${symbol}` : title, unit);

/** @type {(title: string, unit: string | null) => string} */
const withUnit = (title, unit) => (unit ? `${title} (${unit})` : title);
