// Changes of live settings and pace while a training ran: the values that hold, and the changes in words.
import { count, whole } from "./format.js";
import { agentOf } from "./settings.js";
import { rates } from "./store.js";

/** @import { Rates, Run, RunConfig, SettingValue } from "./types.js" */

/** A setting's new value from a step on. @typedef {{ name: string, value: SettingValue, step: number }} RateChange */

/** A slider that is dragged sends values in a row; those within this share of the training are one change. */
const BURST_SHARE = 0.02;

/**
 * Values that were changed while a run ran, as they hold at its end.
 * @param {Run} run
 * @returns {Rates}
 */
const changedValues = ({ changes = [] }) =>
  Object.fromEntries(changes.flatMap(({ pace = null, settings = {} }) => Object.entries({ ...settings, pace }))
    .filter(([, value]) => value !== null));

/**
 * Pace and live settings of a run that were changed, with what this page has sent and not yet seen confirmed.
 * @param {Run} run
 * @returns {Rates}
 */
export const presentRates = (run) => ({ ...changedValues(run), ...rates.value[run.id] });

/**
 * The config of a run with the values that hold at its end. A live setting that is none of the config, as ε, stands
 * for all settings of its symbol.
 * @param {Run} run
 * @returns {RunConfig}
 */
export function configAtEnd(run) {
  const { settings, live_settings } = agentOf(run.config.agent);
  const { pace: newest, ...changed } = changedValues(run);
  const values = Object.entries(changed).flatMap(([name, value]) => {
    if (name in run.config.settings) return [[name, value]];
    const same = Object.keys(settings).filter((one) => settings[one].symbol === (live_settings[name]?.symbol ?? name));
    return same.map((one) => [one, value]);
  });
  const pace = /** @type {RunConfig["pace"]} */ (newest ?? run.config.pace);
  return { ...run.config, pace, settings: { ...run.config.settings, ...Object.fromEntries(values) } };
}

/**
 * The changes of a run's live settings, those of a slider that was dragged as one.
 * @param {Run} run
 * @param {number} [offset] added to each step
 * @returns {RateChange[]}
 */
export function rateChanges({ changes = [], config }, offset = 0) {
  /** @type {RateChange[]} */
  const found = [];
  for (const { step, settings = {} } of changes) {
    for (const [name, value] of Object.entries(settings)) {
      if (value === null) continue;
      const before = found.findLast((one) => one.name === name);
      const isBurst = before && offset + step - before.step <= BURST_SHARE * config.steps;
      if (isBurst) Object.assign(before, { value, step: offset + step });
      else found.push({ name, value, step: offset + step });
    }
  }
  return found.sort((a, b) => a.step - b.step);
}

/** @type {(agent: string, change: Pick<RateChange, "name" | "value">) => string} */
export function rateInWords(agent, { name, value }) {
  const { symbol, title } = agentOf(agent).live_settings[name] ?? { symbol: null, title: name };
  return `${symbol ?? title}\u00a0${value}`;
}

/**
 * The last change of each setting: "α 0.5 from step 136", with how many there were if more than one.
 * @param {string} agent
 * @param {RateChange[]} changes in the order of their steps
 */
export const changesInWords = (agent, changes) =>
  [...new Set(changes.map(({ name }) => name))].map((name) => {
    const own = changes.filter((one) => one.name === name);
    const last = own[own.length - 1];
    const others = own.length > 1 ? ` (${count(own.length, "change")})` : "";
    return `${rateInWords(agent, last)} from step ${whole(last.step)}${others}`;
  });
