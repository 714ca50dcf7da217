// What one sees right now, over the picture: the run, the speed, who thinks, what colours mean.
import { html } from "../html.js";
import { times, whole } from "../format.js";
import { raceScene, standings } from "../standings.js";
import { scene, stage } from "../store.js";


export function StageLabels() {
  const now = scene.value;
  const thinkers = (raceScene.value && standings.value?.filter((row) => row.isThinking)) || [];
  const isPaused = stage.value?.playing === false && now?.kind !== "idle";
  return html`
    <div class="labels">
      <div class="chips">
        <p class="chip strong">${now?.label || "On the start line"}</p>
        ${now?.phase === "photo-finish" && html`<p class="chip accent">Photo finish</p>`}
        ${now?.phase === "waiting" && html`<p class="chip">Waiting for a robot that still thinks</p>`}
        ${now?.replay && html`<p class="chip">Replay</p>`}
        ${isPaused
          ? html`<p class="chip">Paused</p>`
          : now?.shown_speed > 0 && now.kind !== "idle" && html`<p class="chip num" title="How much faster than real time this is shown">${times(now.shown_speed)}</p>`}
      </div>
      <div class="chips">
        ${thinkers.map((row) => html`
          <p class="chip thinker" style=${{ "--agent": row.color }} key=${row.lane}>
            <span class="swatch"></span>${row.title} is thinking: ${whole(row.futures)} of ${whole(row.futuresTotal)}
          </p>
        `)}
      </div>
      ${now?.knowledge && html`
        <p class="chip legend" aria-label="Colours of the foot grid: dark is worth less, light is worth more">
          worth less<span class="ramp" aria-hidden="true"></span>more
        </p>
      `}
    </div>
  `;
}
