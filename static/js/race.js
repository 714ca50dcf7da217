// The race in view at the moment that is shown: its timeline and its standings.
import { computed, signal } from "@preact/signals";
import { askForNewest, getTimeline, isLasting } from "./api.js";
import { clock, originalRace, raceInView, raceScene } from "./on-stage.js";
import { distanceAt, distanceOf, isTimedOutIn, rowsOf } from "./narrative/moment.js";
import { SAME_MOMENT_S } from "./replay-frames.js";
import { modelOfLane } from "./selectors.js";
import { learns } from "./settings.js";
import { connection, options } from "./store.js";
import { messageOf } from "./titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { Row } from "./narrative/moment.js" */
/** @import { Run, Timeline, TimelinePoint } from "./types.js" */

// ---- the timeline under the chosen clock, which grows while the race is simulated

const PAUSE_MS = 350;

/** @type {Signal<Timeline | null>} */
const newest = signal(null);

/** The timeline of the race in view, null while it is not known. */
export const timeline = computed(() => {
  const race = raceInView.value;
  const raceTimeline = newest.value;
  return race && raceTimeline?.id === race.id && raceTimeline.clock === clock.value ? raceTimeline : null;
});

/** The error of the last request, which was for a race and a clock. @type {Signal<[string, RequestError] | null>} */
const refused = signal(null);

/** Why the timeline cannot be had, or not any more; null where it can be, or will be once the server answers again. */
export const timelineProblem = computed(() => {
  const [of, error] = refused.value ?? [];
  const isAbout = of === `${raceInView.value?.id} ${clock.value}`;
  return error && isAbout && isLasting(error) ? messageOf(error) : null;
});

/** The race time that is shown [s]; null before the stage shows the race. */
export const shownTime = computed(() => raceScene.value?.time_s ?? null);

/**
 * A lane's path up to a race time, ending in an interpolated point where that is between two.
 * @param {TimelinePoint[]} points
 * @param {number} time
 * @returns {TimelinePoint[]}
 */
export function clipped(points, time) {
  const before = points.filter(([t]) => t <= time + SAME_MOMENT_S);
  if (!before.length) return [[0, 0]];
  return before.length < points.length ? [...before, [time, distanceAt(points, time)]] : before;
}

/** Request the timeline whenever it has grown. */
export const followTimeline = () => askForNewest({
  key: () => {
    const race = raceInView.value;
    if (!race?.progress.done || connection.value !== "live") return "";
    return [race.id, clock.value, race.state, race.progress.done].join(" ");
  },
  ask: async (key) => {
    const [id, shown] = key.split(" ");
    try {
      newest.value = { ...await getTimeline(id, shown), id };
      refused.value = null;
    } catch (error) {
      refused.value = [`${id} ${shown}`, /** @type {RequestError} */ (error)];
      throw error;
    }
  },
  pause_ms: () => PAUSE_MS,
});

// ---- the standings at the moment that is shown, and nothing later

/** What is known of the race in view at that moment, for what is said of it. */
export const knownRace = computed(() => ({
  race: raceInView.value, scene: raceScene.value, timeline: timeline.value, clock: clock.value,
  agents: options.value?.agents ?? [],
}));

/** Whether the show of the race has ended: at its last step, or with its photo finish. */
export const isOver = computed(() => raceScene.value?.ended ?? false);

/** Whether the moment that is shown is after time-out: the first lane has used its steps. */
export const isTimedOut = computed(() => isTimedOutIn(raceScene.value));

/** @typedef {ReturnType<typeof withSettings>} Standing a row of the board */

/** One row per lane, the leader first; null before the race. */
export const standings = computed(() => rowsOf(knownRace.value)?.map(withSettings) ?? null);

/** A row with what the lane plans with, and what it did in the race from which this one branches off. */
/** @param {Row} row */
const withSettings = (row) => {
  const race = /** @type {Run} */ (raceInView.value);
  return { ...row, plans_with: modelOfLane(race, race.config.lanes[row.lane]), original: originalOf(row.lane) };
};

/**
 * How far a lane came in the race from which this one branches off; null without one.
 * @param {number} number
 */
function originalOf(number) {
  const result = originalRace.value?.result?.lanes?.[number];
  const timed = result?.clocks?.[clock.value];
  return result && timed ? { finished_m: timed.finished_distance_m, total_m: result.total_distance_m } : null;
}

/**
 * Whether a lane is a learner that is behind another one, once the show has come to where they are compared.
 * @param {number} number
 */
export function isLoser(number) {
  const rows = standings.value ?? [];
  const row = rows.find(({ lane }) => lane === number);
  if (!row || !row.made || !learns(row.agent) || !(isTimedOut.value || isOver.value)) return false;
  return rows.some((other) => distanceOf(other) > distanceOf(row));
}
