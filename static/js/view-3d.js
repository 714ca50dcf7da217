// The 3D view of this page, for what only this page draws in it, and what is clicked there.
import { signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */
/** @import { Message } from "./replay-frames.js" */

/**
 * A cell of a foot grid: its scene node, and its number there; and the run that was shown.
 * @typedef {{ node: string, instance: number, run_id: string | null }} Click
 */

/** Draws viser's messages: a new function for each scene that the view begins; null before. */
export const drawHere = signal(/** @type {((messages: Message[]) => void) | null} */ (null));
/** The last click on a foot grid, until it is answered. @type {Signal<Click | null>} */
export const clickedCell = signal(null);
