// Every seed of a setting: its distance, and the run that repeats it here.
import { useEffect, useRef } from "preact/hooks";
import { pending } from "../../../js/actions.js";
import { chosenRun } from "../runs.js";
import {
  chosen, followTrials, hasReplay, isOpen, namesOf, problemOf, repeatable, runTrial, seedsOf,
} from "../seeds.js";
import { count, metres } from "../../../js/format.js";
import { isOperator } from "../../../js/selectors.js";
import { html } from "../../../js/components/elements.js";
import { Problem } from "../../../js/components/foot.js";

/** @import { Changed, Run, Setting, Summary, Toggled } from "../../../js/types.js" */

/** A trial, and the run here that repeats it. @typedef {NonNullable<ReturnType<typeof seedsOf>>[number]} SeedRow */

/** @param {{ summary: Summary }} props */
export function Seeds({ summary }) {
  const settings = repeatable(summary);
  if (settings.length === 0) return null;
  return html`
    <section class="panel seeds" id="seeds" aria-labelledby="seeds-title">
      <details open=${isOpen.value} onToggle=${(/** @type {Toggled} */ { target }) => (isOpen.value = target.open)}>
        <summary><h2 id="seeds-title">One seed, run here</h2></summary>
        ${isOpen.value && html`
          <${Chosen} settings=${settings} parameters=${summary.parameters} />
        `}
      </details>
    </section>
  `;
}

/** @param {{ settings: Setting[], parameters: string[] }} props */
function Chosen({ settings, parameters }) {
  const run = chosenRun.value;
  useEffect(() => followTrials(() => chosenRun.value), []);
  const { setting, distance_m } = chosen.value;
  const first = settings.find(({ role }) => role === "learner") ?? settings[0];
  const { key } = settings.find((other) => other.key === setting) ?? first;
  const names = namesOf(settings, parameters);
  const seeds = run && seedsOf(run.id, key);
  const problem = run && problemOf(run.id);
  /** @param {Changed} event */
  const choose = ({ target }) => {
    chosen.value = { setting: target.value, distance_m: null };
  };
  return html`
    <p class="dim">
      A trial is repeated as a run of its own, to the last bit: with its learning curve, its table and its replay.
      A click on a dot above comes here too.
    </p>
    <label class="choice">
      <span>Setting</span>
      <select onChange=${choose}>
        ${settings.map((option) => html`
          <option value=${option.key} selected=${option.key === key}>${names.get(option.key)}</option>
        `)}
      </select>
    </label>
    <${Problem} at="trials" />
    <div role="alert">${problem && html`<p class="problem">${problem}</p>`}</div>
    ${seeds && html`<${Table} experiment=${run} seeds=${seeds} distance_m=${distance_m} />`}
    ${!seeds && !problem && html`
      <p role="status"><span class="spinner" aria-hidden="true"></span> Loading the trials…</p>
    `}
  `;
}

/** @param {{ experiment: Run, seeds: SeedRow[], distance_m: number | null }} props */
function Table({ experiment, seeds, distance_m }) {
  if (seeds.length === 0) return html`<p class="dim">No trial has finished yet.</p>`;
  return html`
    <div class="scroller seed-list" tabindex="0" role="region" aria-label=${count(seeds.length, "seed")}>
      <table class="facts-table">
        <thead><tr><th scope="col">Seed</th><th scope="col">Distance</th><th scope="col">Run</th></tr></thead>
        <tbody>
          ${seeds.map((seed) => html`
            <${Seed} key=${seed.key} experiment=${experiment} seed=${seed} isChosen=${seed.distance_m === distance_m} />
          `)}
        </tbody>
      </table>
    </div>
  `;
}

/** @param {{ experiment: Run, seed: SeedRow, isChosen: boolean }} props */
function Seed({ experiment, seed, isChosen }) {
  const { key, number, distance_m, run } = seed;
  const row = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => {
    if (isChosen) row.current?.scrollIntoView({ block: "nearest" });
  }, [isChosen]);
  return html`
    <tr ref=${row} class=${isChosen ? "chosen" : ""} aria-current=${isChosen ? "true" : undefined}>
      <th scope="row" class="num">#${number}</th>
      <td class="num">${metres(distance_m)}</td>
      <td>
        <span class="row-actions">
          ${run && hasReplay(run) && html`<a href=${`?run=${encodeURIComponent(run.id)}`}>Replay</a>`}
          ${run && html`<a href=${`#runs?search=${encodeURIComponent(run.id)}`}>${run.state}</a>`}
          ${isOperator.value && html`
            <button class="secondary compact" disabled=${pending.value.trials}
              onClick=${() => runTrial(experiment, key)}>
              ${run ? "Run it again" : "Run this seed here"}
            </button>
          `}
        </span>
      </td>
    </tr>
  `;
}
