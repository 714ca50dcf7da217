// Beside the settings: what thirty robots make of them, against thirty at the defaults.
import { useEffect, useState } from "preact/hooks";
import { canStart, continueWith } from "../actions.js";
import { form } from "../form.js";
import { count, metres, whole } from "../format.js";
import { html } from "../html.js";
import { isNarrow } from "../page.js";
import { agentOf, isOperator, learns, tableInHand, work } from "../selectors.js";
import {
  answer, error, isCurrent, isTooLong, isTrying, isWatched, MOST_STEPS, tryOut,
} from "../what-if.js";
import { DotStrip } from "./dot-strip.js";

const SEEDS = 30;

/** Folded by itself on a phone, and while something runs, whose place this is then. */
export function WhatIf() {
  const [wish, setWish] = useState(null);
  const isOpen = wish ?? (!isNarrow.value && !work.value);
  useEffect(() => {
    isWatched.value = isOpen && isOperator.value;
  }, [isOpen, isOperator.value]);
  if (!isOperator.value || !form.value.lanes.some(learns)) return null;
  const onClick = (event) => {
    event.preventDefault();
    setWish(!isOpen);
  };
  return html`
    <section class="panel what-if" aria-labelledby="what-if-title">
      <details open=${isOpen}>
        <summary onClick=${onClick}><h2 id="what-if-title">What if?</h2><span class="dim">${teaser()}</span></summary>
        ${isOpen && html`<${Trial} onGoOn=${() => setWish(true)} />`}
      </details>
    </section>
  `;
}

const teaser = () => `${SEEDS} ideal robots practise ${count(form.value.steps, "step")}`;

function Trial({ onGoOn }) {
  const known = answer.value;
  const isOld = isTrying.value || isTooLong.value || (known && !isCurrent.value);
  const far = known && 1.06 * Math.max(known.greedy_m, ...known.chosen.distances_m, ...known.default.distances_m);
  return html`
    <div class=${`trial ${isOld ? "old" : ""}`} aria-busy=${isTrying.value ? "true" : "false"}>
      <${Strip} title="These settings" tried=${known?.chosen} known=${known} far=${far} />
      <${Strip} title="The defaults" tried=${known?.default} known=${known} far=${far} />
      ${known && html`<${Axis} known=${known} far=${far} />`}
    </div>
    <${Words} known=${known} />
    <${Continue} onGoOn=${onGoOn} />
  `;
}

function Strip({ title, tried, known, far }) {
  if (!tried) return html`<div class="tried"><p><span>${title}</span></p><div class="no-dots" aria-hidden="true"></div></div>`;
  const walkers = Math.round(tried.walkers * known.seeds);
  const low = Math.min(...tried.distances_m);
  const high = Math.max(...tried.distances_m);
  const label = `${title}: ${walkers} of ${known.seeds} walk. They get from ${metres(low)} to ${metres(high)}, typically ${metres(tried.iqm_m)}; greedy gets ${metres(known.greedy_m)}.`;
  const marks = [{ value: known.greedy_m, kind: "greedy" }, { value: known.greedy_m / 2, kind: "half" }];
  return html`
    <div class="tried">
      <p><span>${title}</span><span class="num"><b>${walkers} of ${known.seeds}</b> walk · typically ${metres(tried.iqm_m)}</span></p>
      <${DotStrip} label=${label} points=${tried.distances_m} high=${far} typical=${{ iqm: tried.iqm_m }}
        marks=${marks} color=${agentOf("q-learning").color} />
    </div>
  `;
}

const Axis = ({ known, far }) => html`
  <p class="tried-axis dim" aria-hidden="true">
    <span>0</span>
    <span style=${{ left: `${(50 * known.greedy_m) / far}%` }}>half</span>
    <span style=${{ left: `${(100 * known.greedy_m) / far}%` }}>greedy</span>
  </p>
`;

/** What one sees, what is being done, or why nothing is: always the same two lines of room. */
function Words({ known }) {
  if (isTooLong.value) return html`<p class="what-if-words" role="status">${whole(MOST_STEPS)} steps at most: more would keep you waiting.</p>`;
  if (error.value && !isTrying.value) {
    return html`
      <p class="what-if-words bad" role="alert">
        <span>${error.value.message}</span> <button class="link" onClick=${tryOut}>Try again</button>
      </p>
    `;
  }
  if (isTrying.value) return html`<p class="what-if-words" role="status"><span class="spinner" aria-hidden="true"></span>${SEEDS} robots practise…</p>`;
  if (!known || !isCurrent.value) {
    return html`
      <p class="what-if-words dim">
        <span>${known ? "The settings have changed." : "Move a slider, and each seed becomes a dot."}</span>
        <button class="link" onClick=${tryOut}>Try ${known ? "these" : "the settings as they are"}</button>
      </p>
    `;
  }
  return html`<p class="what-if-words dim" role="status">Without slip. One walks if it gets at least half as far as greedy.</p>`;
}

/** Go on with what has been learned, at the rates that were found here; the panel stays, and the focus. */
function Continue({ onGoOn }) {
  const table = tableInHand.value;
  if (!table) return null;
  const goOn = () => {
    if (!canStart.value) return;
    onGoOn();
    continueWith(table);
  };
  return html`
    <div class="row">
      <button class="secondary" aria-disabled=${canStart.value ? undefined : "true"} onClick=${goOn}
        title=${`Practises ${count(form.value.steps, "step")} more from the table in hand`}>
        Continue with these settings
      </button>
    </div>
  `;
}
