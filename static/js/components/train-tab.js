// The tab of the next training and race: their settings, and how far the learner walks by now.
import { practiseAtPaceOfPicture } from "../live-changes.js";
import { whole } from "../format.js";
import { steering } from "../on-stage.js";
import { html } from "./elements.js";
import { Restricted } from "./fields.js";
import { LearningChart } from "./run-charts.js";
import { TrainSettings } from "./settings.js";

export function TrainTab() {
  return html`
    <div class="train-tab">
      <${Restricted} />
      <${TrainSettings} />
      <${Steering} />
      <${LearningChart} />
    </div>
  `;
}

/** What a live setting acts on while the computation is ahead of the picture: its next step, or the next training. */
function Steering() {
  const state = steering.value;
  if (state === null) return null;
  const isOver = state === "computed";
  const words = isOver
    ? html`<b>Acts on the next training:</b> this one is computed to its end; the picture is still on its way.`
    : html`<b>Acts from step ${whole(state.step)}</b>, which is computed next${seenStep(state)}.`;
  return html`
    <div class="steering" role="note">
      <p>${words}</p>
      <button class="link" onClick=${practiseAtPaceOfPicture}>
        ${isOver ? "Let the next one practise" : "Practise on"} at the pace of the picture, to steer it
      </button>
    </div>
  `;
}

/** @param {{ shown: number | null }} state */
const seenStep = ({ shown }) =>
  (shown === null ? "; it is not on the stage" : `; the picture shows step ${whole(shown)}`);
