// Experiments: what the core asks of them at any time. Their view, and what follows them, is loaded when it is opened,
// or while one is at work.
import { effect, signal, untracked } from "@preact/signals";
import { addressOf } from "../../js/api.js";
import { worldTitle } from "../../js/disturbances.js";
import { count, duration, whole } from "../../js/format.js";
import { page } from "../../js/page-state.js";
import { customRobotInWords, presetOf, storedName } from "../../js/robots.js";
import { everyRun, isActive } from "../../js/selectors.js";
import { optionNamed, options } from "../../js/settings.js";
import { connection, setEntry } from "../../js/store.js";
import { fieldTitle, observationTitle, rewardInWords, simulatorTitle } from "../../js/titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Feature, Run } from "../../js/types.js" */

/** Run id → number of trials in that experiment's newest summary. @type {Signal<Record<string, number>>} */
export const summarised = signal({});

// ---- an experiment in words

/** @param {Run} run */
export const runTitle = ({ name, config: { experiment } }) =>
  name || options.value?.experiments?.find((kind) => kind.name === experiment)?.title || experiment;

/** @param {string} name */
const settingTitle = (name) => (options.value?.settings[name]?.title ?? name).toLowerCase();


/** Fields of an experiment's config that are told apart from what it sweeps. */
const TOLD_APART = ["agents", "gaits", "observations", "robots", "worlds"];

/**
 * The worlds in which agents are compared; none where there is only the first, in which nothing happens.
 * @param {Run["config"]} config
 */
const worldsIn = ({ worlds = [] }) =>
  worlds.some((/** @type {string} */ world) => world !== options.value?.worlds[0].name) ? worlds.map(worldTitle) : [];

/**
 * The settings that a sweep varies: "α 0.1, 0.3".
 * @param {Run["config"]} config
 */
const sweptIn = (config) =>
  Object.entries({ ...config, ...config.settings }).flatMap(([name, values]) =>
    Array.isArray(values) && values.length > 1 && !TOLD_APART.includes(name)
      ? [`${fieldTitle(name)} ${values.join(", ")}`]
      : []);

/**
 * An experiment's swept values, seeds and places in one line.
 * @param {Run} run
 */
const describe = ({ config }) => {
  const robots = (config.robots ?? []).map((robot) =>
    customRobotInWords(robot) ?? storedName(robot) ?? presetOf(robot) ?? "own robot");
  const observations = (config.observations ?? []).map(observationTitle);
  return [
    ...(optionNamed(options.value?.experiments, config.experiment)?.takes_settings ? sweptIn(config) : []),
    worldsIn(config).join(", "),
    count(config.seeds, "seed"), `from seed ${config.seed}`, observations.join(" and "), robots.join(" and "),
    config.tolerance ? `${settingTitle("tolerance")} ${config.tolerance}` : "",
    config.reward === "track" ? rewardInWords(config.reward) : "", simulatorTitle(config.simulator),
  ].filter(Boolean).join(" · ");
};

// ---- the pace: trials per second, and the time that is left

/**
 * Trials a second, as the estimate of the remaining time implies; null before there is one.
 * @param {Run} run
 */
const rateOf = ({ eta_s, progress: { done, total } }) =>
  eta_s && eta_s > 0 && done > 0 ? (total - done) / eta_s : null;

/**
 * Progress in words: "412 of 1008 trials", "9.8 a second, 1 min left".
 * @param {Run} run
 */
export function paceOf(run) {
  const { done, total } = run.progress;
  const share = total ? done / total : 0;
  const label = `${whole(done)} of ${count(total, "trial")}`;
  const rate = run.state === "running" ? rateOf(run) : null;
  if (rate === null) return { share, label, left: "" };
  const shown = rate < 10 ? rate.toFixed(1) : whole(rate);
  return { share, label, left: `${shown} a second, ${duration(run.eta_s ?? 0)} left` };
}

// ---- what the core asks

/** @type {(id: string, rest: string) => string} */
const fileOf = (id, rest) => addressOf(`experiments/${encodeURIComponent(id)}/${rest}`);

/** @type {Partial<Feature>} */
export default {
  kinds: {
    experiment: {
      plural: "Experiments",
      unit: "Trials",
      titleOf: runTitle,
      describe,
      paceOf,
      stateOf: (id) => ({ view: "experiments", report: id }),
      downloads: ({ id }) => [
        ["Every trial (CSV)", fileOf(id, "trials?format=csv")], ["Summary (JSON)", fileOf(id, "summary")],
      ],
    },
  },
  events: { summary: ({ run_id, done }) => setEntry(summarised, run_id, done) },
  follow: () => effect(() => {
    const isAtWork = everyRun.value.some((run) => run.kind === "experiment" && isActive(run));
    if ((!isAtWork && page.view.value !== "experiments") || connection.value !== "live" || !options.value) return;
    import("./follow.js").then(({ follow }) => untracked(follow), () => {});
  }),
};
