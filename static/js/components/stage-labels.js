// Labels over the stage: the run, the speed, the lanes that think, the colours of the foot grid.
import { html } from "../html.js";
import { times, whole } from "../format.js";
import { raceScene, standings } from "../standings.js";
import { scene, stage } from "../store.js";

export function StageLabels() {
  const thinking = (raceScene.value && standings.value?.filter((row) => row.isThinking)) || [];
  return html`
    <div class="labels">
      <${SceneChips} />
      <div class="chips">
        ${thinking.map((row) => html`
          <p class="chip thinker" style=${{ "--agent": row.color }} key=${row.lane}>
            <span class="swatch"></span>${row.title} is thinking: ${whole(row.futures)} of ${whole(row.futuresTotal)}
          </p>
        `)}
      </div>
      ${scene.value?.knowledge && html`
        <p class="chip legend" aria-label="Colours of the foot grid: dark is worth less, light is worth more">
          worth less<span class="ramp" aria-hidden="true"></span>more
        </p>
      `}
    </div>
  `;
}

function SceneChips() {
  const now = scene.value;
  return html`
    <div class="chips">
      <p class="chip strong">${now?.label || "On the start line"}</p>
      ${now?.phase === "photo-finish" && html`<p class="chip accent">Photo finish</p>`}
      ${now?.phase === "waiting" && html`<p class="chip">Waiting for a robot that still thinks</p>`}
      ${now?.replay && html`<p class="chip">Replay</p>`}
      <${SpeedChip} now=${now} />
    </div>
  `;
}

function SpeedChip({ now }) {
  if (stage.value?.playing === false && now?.kind !== "idle") return html`<p class="chip">Paused</p>`;
  if (!now || now.kind === "idle" || !(now.shown_speed > 0)) return null;
  return html`<p class="chip num" title="Times real time">${times(now.shown_speed)}</p>`;
}
