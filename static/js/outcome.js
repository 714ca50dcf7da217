// What is said aloud, once: how a race ends, what failed, when the server is away.
import { computed, effect, signal } from "@preact/signals";
import { metres } from "./format.js";
import { isDecided, standings } from "./standings.js";
import { connection } from "./store.js";
import { raceInView, shownRun } from "./selectors.js";

/** The text of the page's live region. */
export const announcement = signal("");

/** Who leads, in one sentence; null before anything moves. */
export const headline = computed(() => {
  const rows = standings.value;
  if (!rows?.length) return null;
  const best = Math.max(...rows.map((row) => (isDecided.value ? row.finished_m : row.distance_m) ?? 0));
  if (!isDecided.value && best <= 0) return "On the start line";
  const ahead = rows.filter((row) => row.rank === 1);
  if (ahead.length > 1) {
    return isDecided.value ? `Level at the finish with ${metres(best)}` : "Level";
  }
  const where = isDecided.value ? "leads at the finish with" : "leads with";
  return `${ahead[0].title} ${where} ${metres(best)}`;
});

export function announceOutcomes() {
  const decided = computed(() =>
    isDecided.value && raceInView.value ? `${raceInView.value.id} ${headline.value}` : "",
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
