// The way from a lane of the board that loses to why.
import { html } from "../../../js/components/elements.js";
import { openExplanation } from "../../../js/workspace.js";
import { isSought } from "../loss.js";
import { chosenLane } from "../steps.js";

/** @import { Standing } from "../../../js/race.js" */

/** @param {{ row: Standing }} props */
export function WhyItLoses({ row }) {
  const explain = () => {
    [chosenLane.value, isSought.value] = [row.lane, true];
    openExplanation();
  };
  return html`
    <button class="link" onClick=${explain}>Why does it lose?<span class="sr-only"> ${row.title}</span></button>
  `;
}
