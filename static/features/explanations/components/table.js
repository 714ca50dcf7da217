// The whole table of the learner, before the step that is looked at.
import { useEffect } from "preact/hooks";
import { whole } from "../../../js/format.js";
import { chooseState, chosenState, giveUpState } from "../posture.js";
import {
  explanation, firstState, isFollowing, moment, stateIndex, table, tableMoment,
} from "../steps.js";
import { html } from "../../../js/components/elements.js";
import { Heatmap } from "./heatmap.js";
import { Landings } from "./landings.js";
import { Navigator, Trouble, useMoment, Waiting } from "./navigator.js";
import { SideBySide } from "./side-by-side.js";

/** @import { Moment } from "../steps.js" */
/** @import { StateTable } from "../../../js/types.js" */

export function Table() {
  useMoment();
  const at = moment.value;
  if (!at) return html`<p class="dim">When a learner is on the stage, the values of all its states are shown here.</p>`;
  return html`
    <div class="table-tab">
      <${Navigator} at=${at} />
      <${SideBySide} />
      <${WholeTable} at=${at} />
    </div>
  `;
}

/** @param {{ at: Moment }} props */
function WholeTable({ at }) {
  const { answer, error, again } = table.value;
  const wanted = tableMoment.value;
  const isShown = wanted && answer && (again || !error);
  return html`
    <section class="steps-part" aria-labelledby="table-title">
      <h3 id="table-title">The whole table <${TableTime} wanted=${wanted} /></h3>
      ${!wanted && html`<p class="dim">This lane has no table of a training.</p>`}
      <${Trouble} error=${error} again=${again} />
      ${isShown && html`<${TableOfStates} at=${at} shown=${answer} />`}
      ${wanted && !answer && !error && html`<${Waiting} />`}
    </section>
  `;
}

/** @param {{ wanted: typeof tableMoment.value }} props */
const TableTime = ({ wanted }) => wanted && html`
  <span class="dim">
    ${wanted.step === null ? "at the end of its practice" : `before step ${whole(wanted.step + 1)}`}
  </span>
`;

/** @param {{ at: Moment, shown: StateTable }} props */
function TableOfStates({ at, shown }) {
  const { answer } = explanation.value;
  const seen = answer?.run_id === at.run_id ? answer : null;
  const chosen = chosenState.value;
  const cells = chosen?.cells ?? seen?.observation;
  const index = cells ? stateIndex(cells, shown.cell_names.length) : null;
  const rows = shown.values.length;
  useEffect(() => {
    // Of a large table the part is shown in which the state is.
    const isOutside = index !== null && (index < shown.first || index >= shown.first + rows);
    if (isOutside && isFollowing.value) firstState.value = Math.floor(index / rows) * rows;
  }, [index, shown.states]);
  return html`
    ${shown.states > rows && html`<${Parts} shown=${shown} />`}
    ${shown.landings && html`
      <${Landings} shown=${shown} seen=${seen} />
      <h4>The same values by states and moves</h4>
    `}
    <${Heatmap} shown=${shown} cells=${seen?.observation ?? null} move=${seen?.action ?? null}
      chosen=${chosen} onChoose=${chooseState} onGiveUp=${giveUpState} />
  `;
}

/** @param {{ shown: StateTable }} props */
function Parts({ shown }) {
  const rows = shown.values.length;
  const end = shown.first + rows;
  /** @param {number} first */
  const to = (first) => () => {
    firstState.value = Math.max(0, first);
  };
  return html`
    <div class="row">
      <button class="secondary compact" disabled=${shown.first === 0} onClick=${to(shown.first - rows)}>‹</button>
      <span class="dim">States ${whole(shown.first + 1)} to ${whole(end)} of ${whole(shown.states)}</span>
      <button class="secondary compact" disabled=${end >= shown.states} onClick=${to(end)}>›</button>
    </div>
  `;
}
