// What a tournament's page says: its state and rules, ranks, what can be told apart, and the entries that are left.
import { worldTitle } from "../../js/disturbances.js";
import { count, listed, metres, shortTime, whole } from "../../js/format.js";
import { largest } from "../../js/scale.js";
import { agentOf, settingInWords } from "../../js/settings.js";
import { gaitTitle, observationTitle, rewardInWords, robotTitle, simulatorTitle } from "../../js/titles.js";

/** @import { OwnEntries, Tournament, TournamentEntry, RankedEntry } from "../../js/types.js" */

/** Steps that an entry walks on each draw, as in every race. */
const RACE_STEPS = 50;
const TO = "–";

// ---- the tournament

/** @param {Tournament["rules"]} rules */
export function rulesInWords({ steps, draws, worlds, transitions }) {
  const where = worlds.map((world) => worldTitle(world).toLowerCase()).join(", ");
  return `Each entry practises at most ${count(steps, "step")}, then walks ${RACE_STEPS}, ` +
    `on ${count(draws, "secret seed")} in ${where}. ` +
    `A search simulates at most ${count(transitions, "transition")} on each.`;
}

/** On which robot all walk, and how: "Stiff · Left-right, opposite · MuJoCo physics · foot grid 3 × 3". */
/** @param {Omit<Tournament["rules"], "steps" | "draws" | "worlds" | "robots" | "tables" | "transitions">} walk */
export function walkInWords({ gait, robot, simulator, divisions, grid_side_m, tolerance, reward }) {
  const grid = `foot grid ${divisions} × ${divisions} on ${Math.round(1000 * grid_side_m)}\u00a0mm`;
  return [
    robotTitle(robot), gaitTitle(gait), simulatorTitle(simulator), grid,
    tolerance > 0 ? `build tolerance ${tolerance}` : "",
    reward === "track" ? rewardInWords(reward) : "",
  ].filter(Boolean).join(" · ");
}

/** What else may enter; empty where nothing else may. @param {Tournament["rules"]} rules */
export const choicesInWords = ({ robot, robots, tables }) => [
  robots.length ? `Creatures that may enter: ${listed([robot, ...robots].map(robotTitle))}.` : "",
  tables ? "Tables that were trained before may enter, too." : "",
].filter(Boolean).join(" ");

// ---- entries

/** "12 entries". @param {number} number */
export const entriesInWords = (number) => (number === 1 ? "1 entry" : `${whole(number)} entries`);

/** The name of an entry; one whose name is hidden has its number. @param {TournamentEntry} entry */
export const nameOf = ({ number, name, is_reference, entry }) =>
  (is_reference && entry ? agentOf(entry.agent).title : name ?? `Entry ${number}`);

/**
 * What has been entered, with the settings that are not the agent's defaults: "Q-learning, α 0.5, 300 steps".
 * @param {NonNullable<TournamentEntry["entry"]>} entry
 * @param {Tournament["rules"]} rules
 */
export function entryInWords({ agent, settings = {}, steps, observation, robot, table }, rules) {
  const chosenAgent = agentOf(agent);
  const changed = Object.entries(settings).filter(([name, value]) =>
    name in chosenAgent.settings && value !== chosenAgent.settings[name].default);
  return [
    chosenAgent.title, ...changed.map(([name, value]) => settingInWords(chosenAgent.settings[name], value)),
    ...(table ? ["a trained table"] : []),
    ...(steps !== null && steps !== undefined && steps < rules.steps ? [count(steps, "step")] : []),
    ...(observation && observation !== "measured" ? [observationTitle(observation)] : []),
    ...(robot ? [robotTitle(robot)] : []),
  ].join(", ");
}

/** @param {TournamentEntry} entry */
export const progressInWords = ({ state, judged, of }) =>
  (state === "waiting" ? "waits to be judged" : `${judged} of ${count(of, "draw")}`);

// ---- the ranking

/** "1", or "1–3" where ranks cannot be told apart. */
/** @param {Pick<RankedEntry, "best_rank" | "worst_rank">} standing */
export const rankInWords = ({ best_rank, worst_rank }) =>
  (best_rank === worst_rank ? `${best_rank}` : `${best_rank}${TO}${worst_rank}`);

/** The same, to be read out. @param {Pick<RankedEntry, "best_rank" | "worst_rank">} standing */
export const spokenRank = ({ best_rank, worst_rank }) =>
  (best_rank === worst_rank ? `Rank ${best_rank}` : `Rank ${best_rank} to ${worst_rank}`);

/** So many names are told; the others are counted. */
const TOLD = 3;
const LONGEST_NAME = 24;

/** A name where there is little room. @param {string} name */
export const shortName = (name) => (name.length > LONGEST_NAME ? `${name.slice(0, LONGEST_NAME).trimEnd()}…` : name);

/**
 * The others that cannot be told apart from an entry: "Greedy, Keen Ant, Shy Hare and 4 others"; empty where all can.
 * @param {Pick<RankedEntry, "not_separable">} standing
 * @param {(number: number) => string} nameOfNumber
 */
export function notSeparable({ not_separable }, nameOfNumber) {
  const names = not_separable.map((number) => shortName(nameOfNumber(number)));
  // "… and 1 other" is no shorter than its name.
  return listed(names.length <= TOLD + 1 ? names : [...names.slice(0, TOLD), `${names.length - TOLD} others`]);
}

/** The 95 % interval, without the unit that stands beside it. @param {RankedEntry} standing */
export const intervalInWords = ({ low_m, high_m }) => `${centimetres(low_m)} to ${centimetres(high_m)}`;

/** @param {number} value [m] */
const centimetres = (value) => metres(value).replace(/\s?m$/, "");

/** "failed on 2 of 20"; empty without failures. @type {(standing: RankedEntry, draws: number) => string} */
export const failuresInWords = ({ failures }, draws) => (failures ? `failed on ${failures} of ${draws}` : "");

const HEADROOM = 1.04;
const LEAST_M = 0.1;

/** The ends of the axis that all entries share [m]. @param {RankedEntry[]} standings */
export const axisOf = (standings) => ({
  low: Math.min(0, ...standings.map(({ low_m }) => low_m)),
  high: HEADROOM * largest(standings.map(({ high_m }) => high_m), LEAST_M),
});

/**
 * As many standings as there is room for: those that are kept in any case, and the best of the others.
 * @param {RankedEntry[]} standings best first
 * @param {(number: number) => boolean} isKept by the number of the entry
 * @param {number} most
 */
export function shortened(standings, isKept, most) {
  if (standings.length <= most) return standings;
  const room = Math.max(0, most - standings.filter(({ number }) => isKept(number)).length);
  const best = standings.filter(({ number }) => !isKept(number)).slice(0, room);
  return standings.filter((standing) => isKept(standing.number) || best.includes(standing));
}

// ---- what may be entered

/**
 * "4 of 6 entries left this hour; the next at 14:20"; empty where there is no limit.
 * @param {Pick<OwnEntries, "left" | "next_at">} own
 * @param {number} perHour
 */
export function entriesLeft({ left, next_at }, perHour, now = Date.now()) {
  if (left === null) return "";
  return `${left === 0 ? "None" : whole(left)} of ${entriesInWords(perHour)} left this hour` +
    `${next_at ? `; the next at ${shortTime(next_at, now)}` : ""}.`;
}
