// The runs that are selected: their curves together, what they differ in and what came of it, and what can be done.
import { COLOURS, MAX_COMPARED } from "../../compare.js";
import { count, metres } from "../../format.js";
import { addressOf } from "../../page-state.js";
import { bestPointOf, commonGreedy, isTraining, MAX_CURVES, subjects } from "../../run-details.js";
import { fieldsOf, titleOfSweep, variedIn } from "../../run-settings.js";
import { commonFacts, fieldsOfAll, namesAmong, resultInWords, shareOf } from "../../run-words.js";
import { distanceOf } from "../../runs.js";
import { isWalk } from "../../selectors.js";
import { curveOf } from "../../training.js";
import { html } from "../elements.js";
import { Slot } from "../../features.js";
import { CurvesChart } from "../compare/curves.js";
import { RaceThem } from "../compare/race-them.js";
import { SelectionActions } from "./selection.js";

/** @import { AnyRun } from "../../runs.js" */
/** @import { Run } from "../../types.js" */

/** A run, its name among the others, its colour. @typedef {{ run: AnyRun, name: string, color: string }} Named */

export function Several() {
  const all = subjects.value;
  const names = namesAmong(all);
  const named = all.map((run, n) => ({ run, name: names[n], color: COLOURS[n % COLOURS.length] }));
  return html`
    <header class="details-head">
      <h2>${titleOf(all)}</h2>
      <p class="dim details-facts">${commonFacts(all).join(" · ")}</p>
    </header>
    <div class="details-body">
      <${Curves} named=${named} />
      <${Results} named=${named} />
      <${Notes} named=${named} />
      <${SelectionActions} />
    </div>
    <${Foot} all=${all} />
  `;
}

/** "Sweep of α, 3 runs" @param {AnyRun[]} all */
function titleOf(all) {
  const varied = variedIn(fieldsOfAll(all));
  const runs = count(all.length, "run");
  return varied.length === 1 ? `${titleOfSweep(/** @type {Run} */ (all[0]), varied)}, ${runs}` : runs;
}

/** Longer names would lie over the lines: then the colours of the table tell which is which. */
const MAX_LABEL = 18;

/** @param {{ named: Named[] }} props */
function Curves({ named }) {
  const trainings = named.filter(({ run }) => isTraining(run));
  const first = trainings.slice(0, MAX_CURVES);
  const isShort = first.every(({ name }) => name.length <= MAX_LABEL);
  const curves = first.map(({ run, name, color }) =>
    ({ id: run.id, name, label: isShort ? name : "", color, curve: curveOf(/** @type {Run} */ (run)) }));
  const shown = curves.filter(({ curve }) => curve.points.length > 1);
  if (shown.length === 0) return null;
  return html`
    <section class="chart" aria-label="Learning curves">
      <h3>Distance in 50 steps <span class="dim">against practice</span></h3>
      <${CurvesChart} curves=${shown} greedy=${commonGreedy(shown.map(({ curve }) => curve.run))} />
      ${trainings.length > MAX_CURVES && html`<p class="dim fine">The first ${MAX_CURVES} of ${trainings.length}.</p>`}
    </section>
  `;
}

/** @param {{ named: Named[] }} props */
function Results({ named }) {
  const walks = named.filter(({ run }) => !("damaged" in run));
  const isPractice = walks.every(({ run }) => isTraining(run));
  const distances = walks.map(({ run }) => distanceOf(run) ?? -Infinity);
  const most = Math.max(...distances);
  return html`
    <table class="results">
      <caption class="sr-only">What came of the selected runs</caption>
      <thead>
        <tr>
          <th scope="col">${isPractice ? "Differs" : "Run"}</th><th scope="col">Distance</th>
          ${isPractice && html`<th scope="col">Best, at step</th><th scope="col">Share of Greedy</th>`}
        </tr>
      </thead>
      <tbody>
        ${named.map(({ run, name, color }) => html`
          <tr key=${run.id} style=${{ "--agent": color }} class=${distanceOf(run) === most ? "best" : ""}>
            <th scope="row">${isTraining(run) && html`<span class="swatch"></span>`} ${name}</th>
            <td>${resultInWords(run) || "–"}</td>
            ${isPractice && html`<${Practice} run=${run} />`}
          </tr>
        `)}
      </tbody>
    </table>
    ${isPractice && hasOneSeedEach(walks) && html`
      <p class="dim fine">One seed each: a difference of a few centimetres may be chance.</p>
    `}
  `;
}

/** @param {{ run: Run }} props */
function Practice({ run }) {
  const best = bestPointOf(run);
  return html`
    <td>${best ? `${metres(best.distance_m)}, ${best.step}` : "–"}</td>
    <td>${shareOf(run) ?? "–"}</td>
  `;
}

/** Whether no settings were practised with several seeds. @param {Named[]} walks */
function hasOneSeedEach(walks) {
  const all = walks.map(({ run }) => fieldsOf(/** @type {Run} */ (run)));
  return !variedIn(all).includes("seed");
}

/** @param {{ named: Named[] }} props */
function Notes({ named }) {
  const noted = named.filter(({ run }) => "notes" in run && run.notes);
  return noted.length > 0 && html`
    <section class="kept-notes" aria-label="Notes">
      <h3>Notes</h3>
      ${noted.map(({ run, name }) => html`
        <p class="notes" key=${run.id}><b>${name}: </b>${"notes" in run && run.notes}</p>
      `)}
    </section>
  `;
}

/** @param {{ all: AnyRun[] }} props */
function Foot({ all }) {
  return html`
    <footer class="details-foot">
      <div class="row">
        <${CompareThem} all=${all} />
        <${Slot} name="actions on runs" runs=${all} />
      </div>
      <${RaceThem} runs=${all} />
    </footer>
  `;
}

/** @param {{ all: AnyRun[] }} props */
function CompareThem({ all }) {
  const ids = all.filter((run) => !("damaged" in run) && isWalk(run)).map(({ id }) => id);
  if (ids.length < 2) return null;
  if (ids.length > MAX_COMPARED) return html`<span class="dim">Up to ${MAX_COMPARED} runs compare.</span>`;
  return html`
    <a class="secondary button" href=${addressOf({ view: "compare", compared: ids })}>Compare ${ids.length}</a>
  `;
}
