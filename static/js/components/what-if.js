// What-if: distances of kinematic robots that practise with these settings, and with the defaults.
import { canStart, continueTraining, practiseMore } from "../actions.js";
import { form, mistakes, validSteps, isReadOnly } from "../form.js";
import { count, metres, whole } from "../format.js";
import { page } from "../page-state.js";
import { matchingTable } from "../on-stage.js";
import { isOperator } from "../selectors.js";
import { agentOf, learns } from "../settings.js";
import {
  answer, error, evaluateSettings, isComputing, isCurrent, isPanelOpen, isTooLong, mostSteps, seeds,
} from "../what-if.js";
import { messageOf } from "../titles.js";
import { DotStrip } from "./dot-strip.js";
import { html } from "./elements.js";

/** @import { WhatIfAnswer, WhatIfHalf } from "../types.js" */

const HEADROOM = 1.06;

/** Folded on a phone, and while a run needs the room, unless it was opened. */
export function WhatIf() {
  const isOpen = isPanelOpen.value;
  if (!form.value.lanes.some(learns)) return null;
  /** @param {MouseEvent} event */
  const onClick = (event) => {
    event.preventDefault();
    page.whatIf.value = isOpen ? "closed" : "open";
  };
  return html`
    <section class="panel what-if" aria-labelledby="what-if-title">
      <details open=${isOpen}>
        <summary onClick=${onClick}><h2 id="what-if-title">What if?</h2><span class="dim">${teaser()}</span></summary>
        ${isOpen && html`<${Comparison} onContinue=${() => (page.whatIf.value = "open")} />`}
      </details>
    </section>
  `;
}

const teaser = () => {
  const steps = validSteps();
  return `${seeds.value} ideal robots practise${steps === null ? "" : ` ${count(steps, "step")}`}`;
};

const hasMistakes = () => Object.keys(mistakes.value).length > 0;

/** @param {{ onContinue: (() => unknown) | null }} props */
function Comparison({ onContinue }) {
  const known = answer.value;
  const isOld = isComputing.value || isTooLong.value || hasMistakes() || (known && !isCurrent.value);
  const far = known && HEADROOM * Math.max(known.greedy_m, ...known.chosen.distances_m, ...known.default.distances_m);
  return html`
    <div class=${`trial ${isOld ? "old" : ""}`} aria-busy=${isComputing.value ? "true" : "false"}>
      <${Half} title="These settings" half=${known?.chosen} known=${known} far=${far} />
      <${Half} title="The defaults" half=${known?.default} known=${known} far=${far} />
      ${known && html`<${Axis} known=${known} far=${far} />`}
    </div>
    <${Status} known=${known} />
    ${isOperator.value && html`<${Continue} onContinue=${onContinue} />`}
  `;
}

/** @param {{ title: string, half: WhatIfHalf, known: WhatIfAnswer, far: number }} props */
function Half({ title, half, known, far }) {
  if (!half) {
    return html`<div class="tried"><p><span>${title}</span></p><div class="no-dots" aria-hidden="true"></div></div>`;
  }
  const walkers = Math.round(half.walkers * known.seeds);
  const marks = [{ value: known.greedy_m, kind: "greedy" }, { value: known.greedy_m / 2, kind: "half" }];
  const typically = `typically ${metres(half.iqm_m)}`;
  return html`
    <div class="tried">
      <p>
        <span>${title}</span><span class="num"><b>${walkers} of ${known.seeds}</b> walk · ${typically}</span>
      </p>
      <${DotStrip} label=${captionOf(title, half, known)} points=${half.distances_m} high=${far}
        typical=${{ iqm: half.iqm_m }} marks=${marks} color=${agentOf(form.value.agent).color} />
    </div>
  `;
}

/** @param {string} title @param {WhatIfHalf} other @param {WhatIfAnswer} known */
function captionOf(title, { distances_m, iqm_m, walkers }, { seeds: tried, greedy_m }) {
  const [low, high] = [Math.min(...distances_m), Math.max(...distances_m)];
  return [
    `${title}: ${Math.round(walkers * tried)} of ${tried} walk.`,
    `They get from ${metres(low)} to ${metres(high)}, typically ${metres(iqm_m)}; greedy gets ${metres(greedy_m)}.`,
  ].join(" ");
}

/** @param {{ known: WhatIfAnswer, far: number }} props */
const Axis = ({ known, far }) => html`
  <p class="tried-axis dim" aria-hidden="true">
    <span>0 m</span>
    <span style=${{ left: `${(50 * known.greedy_m) / far}%` }}>half</span>
    <span class="greedy" style=${{ "--at": `${(100 * known.greedy_m) / far}%` }}>greedy ${metres(known.greedy_m)}</span>
  </p>
`;

/**
 * State of the answer: a hint for reading it, that one is computed, or why there is none; always two lines high.
 * @param {{ known: WhatIfAnswer | null }} props
 */
function Status({ known }) {
  if (hasMistakes()) {
    return html`<p class="what-if-words" role="status">Settings that are not valid are not tried.</p>`;
  }
  if (isTooLong.value) {
    const words = `${whole(mostSteps.value)} steps at most: more take too long.`;
    return html`<p class="what-if-words" role="status">${words}</p>`;
  }
  if (error.value && !isComputing.value) {
    return html`
      <p class="what-if-words bad" role="alert">
        <span>${messageOf(error.value)}</span> <button class="link" onClick=${evaluateSettings}>Try again</button>
      </p>
    `;
  }
  if (isComputing.value) {
    return html`
      <p class="what-if-words" role="status">
        <span class="spinner" aria-hidden="true"></span>${seeds.value} robots practise…
      </p>
    `;
  }
  if (!known || !isCurrent.value) return html`<${Request} isFirst=${!known} />`;
  const words = "Ideal (no slip). A robot walks if it gets at least half as far as greedy.";
  return html`<p class="what-if-words dim" role="status">${words}</p>`;
}

/** By whether the sliders are read only. */
const FIRST_WORDS = { false: "Move a slider: each seed becomes a dot.", true: "Each seed becomes a dot." };

/** @param {{ isFirst: boolean }} props */
const Request = ({ isFirst }) => html`
  <p class="what-if-words dim">
    <span>${isFirst ? FIRST_WORDS[`${isReadOnly.value}`] : "The settings have changed."}</span>
    <button class="link" onClick=${evaluateSettings}>Try ${isFirst ? "the settings as they are" : "these"}</button>
  </p>
`;

/**
 * Continue the training of the matching table with these rates; the panel stays open and keeps the focus.
 * @param {{ onContinue: (() => unknown) | null }} props
 */
function Continue({ onContinue }) {
  const table = matchingTable.value;
  if (!table) return null;
  const onClick = () => {
    if (!canStart.value) return;
    onContinue?.();
    continueTraining(table);
  };
  return html`
    <div class="row">
      <button class="secondary" aria-disabled=${canStart.value ? undefined : "true"} onClick=${onClick}
        title="Continues the newest table that fits with these settings, and starts no race">
        ${practiseMore()}, don’t race
      </button>
    </div>
  `;
}
