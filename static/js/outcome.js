// Announcements for screen readers, each made once: results, failures, a lost connection.
import { computed, effect, signal } from "@preact/signals";
import { metres } from "./format.js";
import { isTimedOut, standings } from "./standings.js";
import { connection } from "./store.js";
import { raceInView, shownRun } from "./selectors.js";

/** The text of the page's live region. */
export const announcement = signal("");

/** The leader in one sentence; null before the race. */
export const headline = computed(() => {
  const rows = standings.value;
  if (!rows?.length) return null;
  const best = Math.max(...rows.map((row) => (isTimedOut.value ? row.finished_m : row.distance_m) ?? 0));
  if (!isTimedOut.value && best <= 0) return "On the start line";
  const ahead = rows.filter((row) => row.rank === 1);
  if (ahead.length > 1) return isTimedOut.value ? `Level at time-out with ${metres(best)}` : "Level";
  const verb = isTimedOut.value ? "leads at time-out with" : "leads with";
  return `${ahead[0].title} ${verb} ${metres(best)}`;
});

export function announceOutcomes() {
  const decided = computed(() =>
    isTimedOut.value && raceInView.value ? `${raceInView.value.id} ${headline.value}` : "",
  );
  effect(() => {
    const [, ...words] = decided.value.split(" ");
    if (words.length) announcement.value = words.join(" ");
  });
  effect(() => {
    const run = shownRun.value;
    if (run?.state === "failed") announcement.value = `The ${run.kind} failed: ${run.error ?? ""}`;
  });
  effect(() => {
    if (connection.value === "reconnecting") announcement.value = "Connection lost, reconnecting";
  });
}
