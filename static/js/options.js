// What the server offers: agents, gaits, robots, settings and their limits. A page without a server has it in itself.
import { signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */
/** @import { Options } from "./types.js" */

/** Null until the server has answered. @type {Signal<Options | null>} */
export const options = signal(null);
/** The options, for code that runs only once they are known: components, and what they call. */
export const served = () => /** @type {Options} */ (options.value);
