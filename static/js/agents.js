// The agents that the server offers, with the settings that each declares.
import { computed } from "@preact/signals";
import { options } from "./store.js";

/** @import { Agent, SettingOption, SettingValue } from "./types.js" */

/** For an agent that a run names and the server no longer has. */
const REMOVED_AGENT = {
  description: "", color: "#888888", learns: false, needs_practice: false, settings: {}, live_settings: {},
};

/** @type {(name: string) => Agent} */
export const agentOf = (name) =>
  options.value?.agents.find((agent) => agent.name === name) ?? { name, title: name, ...REMOVED_AGENT };

/** @param {string} name */
export const learns = (name) => agentOf(name).learns;

/** The agents that learn. */
export const learners = computed(() => (options.value?.agents ?? []).filter((agent) => agent.learns));

/**
 * The settings of some agents by name, each as the first agent that has it declares it.
 * @param {string[]} names
 * @returns {Record<string, SettingOption>}
 */
export function settingsOf(names) {
  const each = names.map((name) => agentOf(name).settings);
  // The first pass gives the order, the second lets the first agent's declarations win.
  return Object.assign({}, ...each, ...each.reverse());
}

/**
 * The settings that an agent shows first: those that may change while it learns, those with which such a one
 * begins, and the first that it declares. Settings of one symbol are values of one quantity: the second ends
 * what the first begins, and a live setting beside them replaces both while it learns.
 * @typedef {object} MainSetting
 * @property {string} name
 * @property {SettingOption} setting
 * @property {string | null} live the live setting that acts on its quantity
 * @property {string | null} end the setting that its quantity ends with
 */

/** @type {(symbol: string | null, entries: [string, SettingOption][]) => string[]} */
const namesOfSymbol = (symbol, entries) =>
  symbol === null ? [] : entries.filter(([, setting]) => setting.symbol === symbol).map(([name]) => name);

/**
 * @param {string} agent
 * @returns {MainSetting[]}
 */
export function mainSettings(agent) {
  const { settings, live_settings } = agentOf(agent);
  const own = Object.entries(settings);
  const liveOnly = Object.entries(live_settings).filter(([name]) => !(name in settings));
  return own.flatMap(([name, setting], number) => {
    /** @type {(live: string | null, end: string | null) => MainSetting[]} */
    const main = (live, end) => [{ name, setting, live, end }];
    if (name in live_settings) return main(name, null);
    const [first, end = null] = namesOfSymbol(setting.symbol, own);
    const [live = null] = namesOfSymbol(setting.symbol, liveOnly);
    if (live !== null && first === name) return main(live, end);
    return number === 0 ? main(null, null) : [];
  });
}

/**
 * The settings that `mainSettings` leaves for further down.
 * @param {string} agent
 */
export function furtherSettings(agent) {
  const main = mainSettings(agent).map(({ name }) => name);
  return Object.entries(agentOf(agent).settings).filter(([name]) => !main.includes(name));
}

/**
 * The values of a run's main settings in short: "α 0.3". Without those that cannot change while it learns.
 * @param {string} agent
 * @param {{ [name: string]: any }} values
 */
export const ratesInWords = (agent, values) =>
  mainSettings(agent)
    .filter(({ name, live }) => live === name && values[name] !== undefined)
    .map(({ name, setting }) => `${setting.symbol ?? setting.title}\u00a0${values[name]}`);

/**
 * The value of an agent's live setting that no setting of its name begins: where its quantity begins.
 * @param {string} agent
 * @param {string} name
 * @param {{ [name: string]: any }} values
 * @returns {SettingValue}
 */
export function beginningOf(agent, name, values) {
  const { settings, live_settings } = agentOf(agent);
  const [first] = namesOfSymbol(live_settings[name].symbol, Object.entries(settings));
  return values[name] ?? values[first ?? ""] ?? null;
}
