// What-if: distances of kinematic robots that practise with these settings, and with the defaults.
import { useEffect } from "preact/hooks";
import { form, mistakes, isReadOnly } from "../../js/form.js";
import { listed, metres, whole } from "../../js/format.js";
import { mayStart } from "../../js/selectors.js";
import { agentOf, kindOf, learns, sliderOf } from "../../js/settings.js";
import {
  applyDraft, differences, discardDraft, discardUntried, triable, triedValue, tryValue, untried,
} from "./draft.js";
import {
  answer, error, evaluateSettings, followWhatIf, isComputing, isCurrent, isTooLong, mostSteps, seeds,
} from "./what-if.js";
import { messageOf } from "../../js/titles.js";
import { DotStrip } from "../../js/components/dot-strip.js";
import { html } from "../../js/components/elements.js";
import { PRACTICE } from "../../js/components/settings.js";
import { closable, Restricted, SettingRow, Slider } from "../../js/components/fields.js";

/** @import { SettingOption, SettingValue, WhatIfAnswer, WhatIfHalf } from "../../js/types.js" */

const HEADROOM = 1.06;

/** It computes beside the race, and changes nothing on the stage, and nothing of the next run unless asked to. */
export function WhatIf() {
  useEffect(followWhatIf, []);
  if (!form.value.lanes.some(learns)) {
    return html`<p class="dim">No learner is in the race: add one in Train, and its settings can be tried here.</p>`;
  }
  return html`
    <section class="what-if" aria-label="What if">
      <${Restricted} />
      <fieldset class="settings" aria-label="Settings to try">
        <div class="sliders">
          ${Object.entries(triable.value).map(([field, setting]) => html`
            <${Tried} key=${`${form.value.agent} ${field}`} field=${field} setting=${setting} />
          `)}
        </div>
      </fieldset>
      <${Draft} />
      <h3>${seeds.value} ideal robots: distance in 50 steps</h3>
      <${Comparison} />
    </section>
  `;
}

/**
 * A setting that is tried: with a slider, if it is a number.
 * @param {{ field: string, setting: SettingOption }} props
 */
function Tried({ field, setting }) {
  const ends = field === "steps" ? PRACTICE : kindOf(setting) === "number" ? sliderOf(setting) : null;
  const rest = {
    setting, value: triedValue(field), isOfForm: false,
    onValue: (/** @type {SettingValue} */ value) => tryValue(field, value),
  };
  return closable(field, ends
    ? html`<${Slider} field=${`tried-${field}`} ...${ends} ...${rest} />`
    : html`<${SettingRow} name=${`tried-${field}`} ...${rest} />`);
}

/** What differs from the next run, and the ways to go on with it. */
function Draft() {
  const all = differences.value;
  const base = mayStart.value ? "next run" : "before";
  return html`
    ${untried.value.length > 0 && html`
      <div class="notice" role="status">
        <p>The link also tries ${listed(untried.value)}, which has no effect.</p>
        <button class="link" onClick=${discardUntried}>Dismiss</button>
      </div>
    `}
    ${all.length > 0 && html`
      <div class="draft" role="group" aria-label="Draft">
        <p role="status">
          ${mayStart.value ? "Not in the next run: " : "Yours alone: "}
          ${all.map(({ field, title, value, next }, number) => html`
            ${number > 0 && ", "}
            <span key=${field}><b>${title} ${value}</b> <span class="dim">(${base} ${next})</span></span>
          `)}
        </p>
        <div class="row">
          ${mayStart.value && html`<button class="secondary compact" onClick=${applyDraft}>Use this</button>`}
          <button class="secondary compact" onClick=${discardDraft}>Discard</button>
        </div>
      </div>
    `}
  `;
}

const hasMistakes = () => Object.keys(mistakes.value).length > 0;

function Comparison() {
  const comparison = answer.value;
  const isOld = isComputing.value || isTooLong.value || hasMistakes() || (comparison && !isCurrent.value);
  const far = comparison && HEADROOM * Math.max(
    comparison.greedy_m, ...comparison.chosen.distances_m, ...comparison.default.distances_m,
  );
  return html`
    <div class=${`trial ${isOld ? "old" : ""}`} aria-busy=${isComputing.value ? "true" : "false"}>
      <${Half} title="These settings" half=${comparison?.chosen} known=${comparison} far=${far} />
      <${Half} title="The defaults" half=${comparison?.default} known=${comparison} far=${far} />
      ${comparison && html`<${Axis} known=${comparison} far=${far} />`}
    </div>
    <${Status} known=${comparison} />
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
