// The own robot of a participant: its picture, how far it is, and what came of it.
import { html, ProgressBar } from "../components/elements.js";
import { metres, whole } from "../format.js";
import { isAway } from "../store.js";
import { givenInWords } from "./may.js";
import { Picture, ReplayBar } from "./picture.js";
import { goesOn, ownEntry, ownRun, room } from "./room.js";

/** @import { Run } from "../types.js" */

export const OwnRobot = () => html`
  <section class="own-robot" aria-label="Your robot">
    <${Picture} source="replay" />
    <${ReplayBar} />
    <${OwnRun} />
  </section>
`;

/** How far the own run is, or what came of it. */
export function OwnRun() {
  const run = ownRun.value;
  if (run === null) return null;
  if (run.state === "queued") return html`<${Queued} run=${run} />`;
  if (goesOn(run)) return html`<${Running} run=${run} />`;
  if (run.state === "finished") return html`<${Finished} run=${run} />`;
  return html`<p class="run-words bad" role="alert">Your robot did not get to its end. Press Go again.</p>`;
}

/** @param {{ run: Run }} props */
const Queued = ({ run }) => html`
  <p class="run-words" role="status">
    ${isAway.value ? html`<span>Last known: your robot waits for its turn.</span>` : html`
      <span><span class="spinner" aria-hidden="true"></span> Your robot waits for its turn.${run.queue_position
        ? ` Place ${run.queue_position} in the queue.` : ""}</span>
    `}
  </p>
`;

/** @param {{ run: Run }} props */
function Running({ run }) {
  const { done, total } = run.progress;
  const now = run.kind === "race" ? "It races" : "It practises";
  const what = isAway.value ? "Last known" : now;
  return html`
    <div class="run-words" role="status">
      <p>${what}: step ${whole(done)} of ${whole(total)}</p>
      <${ProgressBar} label="Progress of your robot" share=${total ? done / total : 0} />
    </div>
  `;
}

/** @param {{ run: Run }} props */
function Finished({ run }) {
  const { distance_m = null, given = {} } = ownEntry.value?.run ?? {};
  return html`
    <div class="own-distance" role="status">
      <b class="num">${metres(distance_m ?? run.result?.distance_m)}</b>
      <span class="dim">${run.kind === "race" ? "your learner at time-out" : "in 50 steps, after its practice"}
        ${Object.keys(given).length > 0 && html`<br />${givenInWords(given, room.value?.shown ?? { text: "" })}`}</span>
    </div>
  `;
}
