// The page of a visitor: what is left of the allowance, which runs are theirs, and the picture of their robot. It is
// loaded there alone.
import { batch, computed, effect, untracked } from "@preact/signals";
import { call } from "../../js/api.js";
import { page } from "../../js/page-state.js";
import { openReplay, playback, setReplaySpeed } from "../../js/player.js";
import { followRuns } from "../../js/runs.js";
import { isActive, isKnown, ownRuns, runOf, trainingIds } from "../../js/selectors.js";
import { connection } from "../../js/store.js";
import { allowance, followed, isVisitor, visitorRuns } from "./feature.js";

/** @import { Run } from "../../js/types.js" */

/** Steps come back with time, and runs are deleted. */
const REFRESH_MS = 60_000;
/** Several changes are asked about at once. */
const SOON_MS = 250;

async function refresh() {
  try {
    const answer = await call("GET", "allowance");
    batch(() => {
      allowance.value = answer;
      visitorRuns.value = answer.runs;
    });
  } catch {
    // The next change asks again.
  }
}

/** What makes the allowance another one: starts of this page, and the states of the own runs. */
const changes = computed(() =>
  [...ownRuns.value, ...visitorRuns.value.map((id) => `${id} ${runOf(id)?.state}`)].join());

const NEWEST = 10;

let isFollowed = false;

/** Keep what the visitor of a demo may do, for as long as this is the page of one. */
export function followDemo() {
  if (isFollowed) return;
  isFollowed = true;
  followRuns(computed(() => visitorRuns.value.slice(-NEWEST)));
  effect(() => {
    if (!isVisitor.value || connection.value !== "live") return undefined;
    refresh();
    const timer = setInterval(() => document.hidden || refresh(), REFRESH_MS);
    return () => clearInterval(timer);
  });
  effect(() => {
    if (!changes.value || !isVisitor.peek()) return undefined;
    const timer = setTimeout(refresh, SOON_MS);
    return () => clearTimeout(timer);
  });
  effect(showFollowed);
}

// ---- the own robot: its practice as soon as it has a step, then its race

/** A practice is shown in about 15 s, as its steps are much alike: so many of them at real time. */
const PRACTICE_STEPS = 40;
const SPEEDS = [2, 4, 8, 16, 64];
const RACE_SPEED = 2;

/** Id of the run of the followed start that this page has opened; null before the first. @type {string | null} */
let opened = null;
/** Id of the start that it belongs to. @type {string | null} */
let start = null;

/** The runs of a start in the order in which they are shown. @param {Run} run */
const shownInOrder = (run) => [
  ...trainingIds(run).filter((id) => visitorRuns.value.includes(id)).map(runOf).filter(isKnown), run,
];

/** @param {Run} run */
const speedOf = ({ kind, config }) =>
  (kind === "race" ? RACE_SPEED : SPEEDS.find((times) => config.steps <= times * PRACTICE_STEPS) ?? SPEEDS.at(-1) ?? 1);

function showFollowed() {
  const run = runOf(followed.value);
  if (start !== followed.value) [start, opened] = [followed.value, null];
  if (run === null) return;
  if (opened !== null && page.run.value !== opened) {
    followed.value = null; // another run was chosen, or the common stage
    return;
  }
  const isAtEnd = page.run.value === opened && playback.value?.ended;
  if (opened !== null && !isAtEnd) return;
  const runs = shownInOrder(run);
  const next = runs[runs.findIndex(({ id }) => id === opened) + 1];
  if (!isKnown(next)) {
    followed.value = null;
    return;
  }
  if (next.progress.done === 0) {
    if (!isActive(next)) followed.value = null;
    return;
  }
  opened = next.id;
  untracked(() => {
    setReplaySpeed(speedOf(next));
    openReplay(next.id);
  });
}
