// The race that can be raced on from one of its steps, as a new one with disturbances.
import { computed } from "@preact/signals";
import { raceInView, raceScene, work } from "./on-stage.js";

/** The race that can be raced on from one of its steps: it is in view, and computed to its end. */
export const openRace = computed(() => {
  const race = raceInView.value;
  return race?.state === "finished" && raceScene.value !== null && !work.value ? race : null;
});

/** Whether the picture of a race plays, so that its step changes. */
export const isMoving = computed(() => Boolean(raceScene.value?.playing && !raceScene.value.ended));

/** The race that can be raced on from what is shown: its picture is paused, or at its end. */
export const heldRace = computed(() => (isMoving.value ? null : openRace.value));
