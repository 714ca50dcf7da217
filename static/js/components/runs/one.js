// What came of one run, and its settings.
import { settingRows } from "../../compare.js";
import { metres } from "../../format.js";
import { bestPointOf } from "../../run-details.js";
import { commonInWords, fieldsOf } from "../../run-settings.js";
import { greedyOf, ranked, shareOf, unrankedInWords, winnerOf } from "../../run-words.js";
import { distanceOf } from "../../runs.js";
import { agentOf, laneTitle } from "../../settings.js";
import { bestKnown } from "../../store.js";
import { curveOf } from "../../training.js";
import { html } from "../elements.js";
import { CurvesChart } from "../compare/curves.js";

/** @import { Run } from "../../types.js" */

/** @param {{ run: Run }} props */
export function OneCurve({ run }) {
  const curve = curveOf(run);
  const { title, color } = agentOf(run.config.agent);
  return html`
    <section class="chart" aria-label="Learning curve">
      <h3>Distance in 50 steps <span class="dim">against practice</span></h3>
      ${curve.points.length > 1
        ? html`<${CurvesChart} greedy=${greedyOf(run)}
            curves=${[{ id: run.id, name: title, label: metres(curve.points.at(-1)?.distance_m), color, curve }]} />`
        : html`<p class="dim">It has not been evaluated${run.config.evaluate_every ? " yet" : ""}.</p>`}
    </section>
  `;
}

/** @param {{ run: Run }} props */
export function TrainingResult({ run }) {
  const best = bestPointOf(run);
  const best_m = run.result?.best_known_m ?? bestKnown.value[run.id] ?? null;
  /** @type {[string, string | null][]} */
  const figures = [
    ["Distance", run.result ? metres(distanceOf(run)) : null],
    ["Best, at step", best && `${metres(best.distance_m)}, ${best.step}`],
    ["Share of Greedy", shareOf(run)],
    ["Best known", best_m === null ? null : metres(best_m)],
  ];
  return html`
    <dl class="figures">
      ${figures.filter(([, value]) => value).map(([title, value]) => html`
        <div key=${title}><dt class="dim">${title}</dt><dd>${value}</dd></div>
      `)}
    </dl>
  `;
}

/** @param {{ run: Run }} props */
export function RaceResult({ run }) {
  const lanes = ranked(run);
  if (lanes.length === 0) {
    return html`<p class="dim">${run.config.lanes.map(laneTitle).join(", ")}: without a result so far.</p>`;
  }
  const most = Math.max(...lanes.map((lane) => lane.finished_distance_m ?? 0), 1e-9);
  return html`
    <table class="results lanes">
      <caption class="sr-only">Lanes under the paper clock</caption>
      <thead><tr><th scope="col">Lane</th><th scope="col"><span class="sr-only">Bar</span></th>
        <th scope="col">At time-out</th><th scope="col">In all</th></tr></thead>
      <tbody>
        ${lanes.map(({ number, lane, rank, finished_distance_m: reached }) => html`
          <tr key=${number} class=${rank === 1 && winnerOf(run) ? "best" : ""}
            style=${{ "--agent": agentOf(lane.agent).color }}>
            <th scope="row"><span class="swatch"></span> ${laneTitle(run.config.lanes[number] ?? lane)}</th>
            <td class="bar-cell"><i style=${{ width: `${(100 * Math.max(0, reached ?? 0)) / most}%` }}></i></td>
            <td>${metres(reached)}</td><td>${metres(lane.total_distance_m)}</td>
          </tr>
        `)}
      </tbody>
    </table>
    <p class="dim fine">${winnerOf(run) ? "Ranked by the paper clock." : unrankedInWords(run)}</p>
  `;
}

/** In a line, and each when it is unfolded. @param {{ run: Run }} props */
export function Settings({ run }) {
  return html`
    <details class="run-settings">
      <summary><b>Settings</b> <span class="dim">${commonInWords([fieldsOf(run)], []).join(" · ")}</span></summary>
      <dl>
        ${settingRows([run]).map(({ name, title, cells: [value] }) => html`
          <div key=${name}><dt class="dim">${title}</dt><dd>${value}</dd></div>
        `)}
      </dl>
    </details>
  `;
}
