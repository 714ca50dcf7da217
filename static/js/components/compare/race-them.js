// Starts a race of runs against each other, or says why they cannot race.
import { pending } from "../../actions.js";
import { mayStart } from "../../selectors.js";
import { conditionsOfRace, obstacle, raceThem } from "../../table-race.js";
import { html } from "../elements.js";
import { Problem } from "../foot.js";

/** @import { DamagedRun, Run } from "../../types.js" */

/** @param {{ runs: (Run | DamagedRun)[] }} props */
export function RaceThem({ runs }) {
  if (!mayStart.value || runs.length < 2) return null;
  const problem = obstacle(runs);
  const walks = /** @type {Run[]} */ (runs);
  return html`
    <div class="race-them">
      <p class="dim" id="race-them-words">${problem ?? conditionsOfRace(walks)}</p>
      <button class="primary" disabled=${pending.value["table race"]}
        aria-disabled=${problem ? "true" : undefined} aria-describedby="race-them-words"
        onClick=${() => problem || raceThem(walks)}>Race these ${runs.length}</button>
      <${Problem} at="table race" />
    </div>
  `;
}
