// The clock of a race: with the time that a robot takes to decide, or without it.
import { t } from "../../../js/format.js";
import { html, Segments } from "../../../js/components/elements.js";

/** @import { Clock } from "../../../js/types.js" */

const CHOICES = /** @type {[Clock, string][]} */ ([["paper", t("Paper clock")], ["free", t("No clock")]]);

/** In a word, as the projector says it. @param {string | undefined} clock */
export const clockInWords = (clock) => (clock === "free" ? t("no clock: thinking takes no time") : null);

/** @param {{ clock: Clock, onClock: (clock: Clock) => unknown }} props */
export const ClockChoice = ({ clock, onClock }) => html`
  <${Segments} label="Clock of the race" choices=${CHOICES} value=${clock} onValue=${onClock} />
`;
