// Starts a race of trained runs against each other, or says why they cannot race.
import { pending } from "../../actions.js";
import { isOperator } from "../../selectors.js";
import { conditionsOfRace, obstacle, raceThem } from "../../table-race.js";
import { html, Problem } from "../elements.js";

/** @import { Run } from "../../types.js" */

/** @param {{ runs: Run[] }} props */
export function RaceThem({ runs }) {
  if (!isOperator.value || runs.length < 2) return null;
  const problem = obstacle(runs);
  return html`
    <span class="race-them">
      <button class="secondary compact" disabled=${pending.value["table race"]}
        aria-disabled=${problem ? "true" : undefined} aria-describedby="race-them-words"
        onClick=${() => problem || raceThem(runs)}>Race these</button>
      <span class="dim" id="race-them-words">${problem ?? conditionsOfRace(runs)}</span>
      <${Problem} at="table race" />
    </span>
  `;
}
