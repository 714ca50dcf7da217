// An experiment in few words: its state, what is the same in all its trials, and what came of it as the server says.
import { count, duration, listed, percentage, sentence, whole, withGroupedDigits } from "../../js/format.js";
import { customRobotInWords, presetOf, storedName } from "../../js/robots.js";
import { served } from "../../js/settings.js";
import { agentTitle, gaitTitle, observationTitle, rewardInWords, simulatorTitle } from "../../js/titles.js";
import { experimentKind } from "./kinds.js";

/** @import { RobotConfig, Run, Summary } from "../../js/types.js" */

/**
 * A state with how far it is: "running, 42 %, 6 min left", "stopped at 60 %".
 * @param {Run} run
 */
export function stateInWords({ state, progress: { done, total }, eta_s }) {
  const share = percentage(total ? done / total : 0);
  if (state === "running") return [share, eta_s ? `${duration(eta_s)} left` : ""].filter(Boolean).join(", ");
  return ["paused", "stopped", "interrupted", "failed"].includes(state) ? `${state} at ${share}` : state;
}

const MAX_NAMES = 3;

/**
 * A few names, or how many there are.
 * @param {string[]} names
 * @param {string} noun
 */
const fewOf = (names, noun) => (names.length > MAX_NAMES ? count(names.length, noun) : listed(names));

/** @param {Run["config"]} config */
function gaitsIn({ gaits = [] }) {
  const all = served().gaits;
  if (all.length > 1 && gaits.length === all.length) return `all ${whole(all.length)} gaits`;
  return fewOf(gaits.map(gaitTitle), "gait");
}

/**
 * What is tried, in a line: "Q-learning, 500 steps of practice, Left-right, opposite, feet measured, 30 seeds".
 * @param {Run["config"]} config
 */
export function configInWords(config) {
  const { agents = [], steps = [], observations = [], robots = [], seeds, seed, tolerance, reward, simulator } = config;
  const robotName = (/** @type {RobotConfig} */ one) =>
    customRobotInWords(one) ?? storedName(one) ?? presetOf(one) ?? "own";
  return sentence([
    fewOf(agents.map(agentTitle), "agent"),
    experimentKind(config.experiment)?.measure !== "blocks" &&
      `${[steps].flat().map(whole).join(", ")} steps of practice`,
    gaitsIn(config), listed(observations.map(observationTitle)), `${listed(robots.map(robotName))} robot`,
    `${count(seeds, "seed")}${seed ? ` from seed ${seed}` : ""}`,
    tolerance ? `built to within ${percentage(tolerance)}` : "", reward === "track" ? rewardInWords(reward) : "",
    simulatorTitle(simulator),
  ].filter(Boolean).join(" · "));
}

// ---- what came of it

/** @type {[string, (number: number) => string][]} */
const VERDICTS = [
  ["holds", (number) => (number === 1 ? "holds" : "hold")],
  ["does not hold", (number) => (number === 1 ? "does not hold" : "do not hold")],
  ["depends", (number) => (number === 1 ? "depends on the case" : "depend on the case")],
  ["not established", (number) => (number === 1 ? "is not established" : "are not established")],
];

/**
 * How many of the paper's claims hold: "Of the paper’s 9 claims 2 do not hold and 7 are not established." Empty of a
 * single one: without its words the number says nothing.
 * @param {{ verdict: string }[]} claims
 */
export function verdictsInWords(claims) {
  if (claims.length < 2) return "";
  const counts = VERDICTS.map(([verdict, words]) => {
    const number = claims.filter((one) => one.verdict === verdict).length;
    return number ? `${number} ${words(number)}` : "";
  });
  return `Of the paper’s ${count(claims.length, "claim")} ${listed(counts.filter(Boolean))}.`;
}

/**
 * What an experiment found, as the server wrote it, else its verdicts; empty where it says nothing yet.
 * @param {Summary | null} summary
 */
export const findingIn = (summary) => withGroupedDigits(summary?.finding || verdictsInWords(summary?.claims ?? []));

/**
 * What came of an experiment in its row of the list, whether its report was opened or not.
 * @param {Run} run
 * @param {Summary | null} summary
 */
export const outcomeOf = ({ result }, summary) =>
  findingIn(summary) || result?.finding || verdictsInWords(result?.claims ?? []);
