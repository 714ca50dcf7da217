// The state that was chosen in the table, or in the scene: where it is seen, and how to give it up.
import { ghost, whyNoGhost } from "../posture.js";
import { moveInWords, stateInWords } from "../steps.js";
import { messageOf } from "../../../js/titles.js";
import { html } from "../../../js/components/elements.js";

/** @import { ChosenState } from "../posture.js" */
/** @import { FootCells } from "../../../js/types.js" */

/**
 * @param {object} props
 * @param {import("../posture.js").ChosenState | null} props.chosen
 * @param {import("../../../js/types.js").FootCells} props.grid
 * @param {boolean} props.isRead whether its row is the one that is told above
 * @param {(event: Event) => void} props.onGiveUp
 */
export function ChosenStateNote({ chosen, grid, isRead, onGiveUp }) {
  const isGhost = chosen?.from === "table" && isGhostShown();
  return html`
    <div class="heat-note">
      <p aria-hidden=${isGhost ? "true" : null} class=${chosen ? "" : "dim"}>
        ${isGhost ? `The ghost in the scene stands in ${isRead ? "this" : "the chosen"} state.` : wordsOf(chosen, grid)}
      </p>
      <p class="sr-only" role="status">
        ${isGhost && `The ghost in the scene stands in this state: ${stateInWords(chosen.cells, grid)}.`}
      </p>
      ${chosen && html`
        <button class="secondary compact" onClick=${onGiveUp}>${isGhost ? "Take it away" : "Clear"}</button>
      `}
    </div>
  `;
}

const isGhostShown = () => ghost.value.answer !== null && whyNoGhost.value === null;

/** @param {ChosenState | null} chosen @param {FootCells} grid */
function wordsOf(chosen, grid) {
  if (!chosen) return "A click puts a ghost of the robot into that state, in the scene.";
  if (chosen.from === "scene") return `Clicked in the scene: ${moveInWords(chosen.move, grid)}.`;
  const { error, again } = ghost.value;
  if (whyNoGhost.value) return `${whyNoGhost.value}.`;
  return error && !again ? messageOf(error) : "Loading the ghost…";
}
