// What fills the projector: one act at a time, the first of this list that has something to show. A kind of act is a
// module of this folder, which knows nothing of the layout.
import { CHOICE } from "./choice.js";
import { CURVE, POINT } from "./curves.js";
import { DISTANCES } from "./distances.js";
import { GAIN } from "./gain.js";
import { NUMBER } from "./number.js";
import { RUN } from "./run.js";
import { TEACH } from "./teach.js";

/** @import { FunctionComponent } from "preact" */
/** @import { CardResults, Classroom, Gain } from "../../../../js/types.js" */

/**
 * What an act is chosen and drawn from. `isOnItsWay`: whether the stage has a run that is not shown to its end, so that
 * no figure of it may be told. `colors`: of the lanes on the stage. `gain`: of the class, once it is told.
 * `clock`: that of the race on the stage in words, where it is not the usual one.
 * @typedef {{
 *   classroom: Classroom, results: CardResults | null, isRevealed: boolean, isOnItsWay: boolean, colors: string[],
 *   gain: Gain | null, clock: string | null,
 * }} Facts
 */
/**
 * A kind of act. `isOn`: whether it has something to show. `Show` gets the facts, and fills its place.
 * @typedef {object} Act
 * @property {string} name by which the layout knows it
 * @property {(facts: Facts) => boolean} isOn
 * @property {FunctionComponent<Facts>} Show
 */

/** In the order of their claims. @type {Act[]} */
export const ACTS = [TEACH, RUN, GAIN, CHOICE, NUMBER, POINT, CURVE, DISTANCES];

/** What fills the projector; null while the card itself does. @param {Facts} facts */
export const actOf = (facts) => ACTS.find(({ isOn }) => isOn(facts)) ?? null;
