// Two settings compared: difference with its interval, chance, further seeds, every seed and performance profiles; and
// figures of them for a paper.
import { useEffect, useMemo, useState } from "preact/hooks";
import { metres, withGroupedDigits } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";
import { messageOf } from "../../../js/titles.js";
import { Chart } from "../../../js/components/charts.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html, Segments } from "../../../js/components/elements.js";
import { comparable, firstPair, profileChart } from "../profiles.js";
import { namesOf } from "../seeds.js";

/** @import { RequestError } from "../../../js/api.js" */
/** @import { Changed, Setting, SettingComparison, Summary } from "../../../js/types.js" */

/** Compares two settings by their keys. @typedef {(a: string, b: string) => Promise<SettingComparison>} Compare */
/**
 * Saves a figure of settings for a paper: its kind, and the columns of a page that it fills.
 * @typedef {(kind: string, columns: string, settings: string[]) => Promise<unknown>} SaveFigure
 */

/**
 * `first`: the keys of the two that are compared at first. `saveFigure`: null where there is no server.
 * @param {{ summary: Summary, compare: Compare, first?: string[] | null, saveFigure?: SaveFigure | null }} props
 */
export function TwoSettings({ summary, compare, first = null, saveFigure = null }) {
  const settings = useMemo(() => comparable(summary), [summary]);
  const [chosen, setChosen] = useState(/** @type {[string, string] | null} */ (null));
  if (settings.length < 2) return null;
  const isThere = (/** @type {string} */ key) => settings.some((setting) => setting.key === key);
  const [a, b] = chosen?.every(isThere) ? chosen : first ?? firstPair(settings);
  const names = namesOf(settings, summary.parameters);
  const pair = /** @type {[Setting, Setting]} */ ([a, b].map((key) => settings.find((one) => one.key === key)));
  return html`
    <section class="panel two-settings" aria-labelledby="two-settings">
      <h2 id="two-settings">Two settings compared</h2>
      <div class="pair-choice">
        <${Choice} label="First" settings=${settings} names=${names} value=${a} other=${b}
          onKey=${(/** @type {string} */ key) => setChosen([key, b])} />
        <${Choice} label="Second" settings=${settings} names=${names} value=${b} other=${a}
          onKey=${(/** @type {string} */ key) => setChosen([a, key])} />
      </div>
      <${Outcome} a=${a} b=${b} summary=${summary} compare=${compare} />
      <div class="pair-figures">
        <${Seeds} pair=${pair} names=${namesOf(pair, summary.parameters)} />
        <${Profiles} pair=${pair} summary=${summary} />
      </div>
      ${saveFigure && html`<${PaperFigures} keys=${[a, b]} saveFigure=${saveFigure} />`}
    </section>
  `;
}

/**
 * @param {{
 *   label: string, settings: Setting[], names: Map<string, string>, value: string, other: string,
 *   onKey: (key: string) => void
 * }} props
 */
const Choice = ({ label, settings, names, value, other, onKey }) => html`
  <label class="choice"><span>${label}</span>
    <select onChange=${(/** @type {Changed} */ { target }) => onKey(target.value)}>
      ${settings.map(({ key }) => html`
        <option value=${key} selected=${key === value} disabled=${key === other}>${names.get(key)}</option>
      `)}
    </select>
  </label>
`;

/** @param {{ a: string, b: string, summary: Summary, compare: Compare }} props */
function Outcome({ a, b, summary, compare }) {
  const [answer, setAnswer] = useState(/** @type {{ of: string, compared?: SettingComparison, problem?: string }} */ ({
    of: "",
  }));
  const pair = `${a} ${b}`;
  useEffect(() => {
    let isWanted = true;
    compare(a, b).then(
      (compared) => isWanted && setAnswer({ of: pair, compared }),
      (/** @type {RequestError} */ error) => isWanted && setAnswer({ of: pair, problem: messageOf(error) }),
    );
    return () => {
      isWanted = false;
    };
  }, [pair, summary]);
  const { compared, problem } = answer.of === pair ? answer : {};
  return html`
    <div class="pair-outcome" aria-live="polite">
      ${!compared && html`<p class="dim">${problem ?? "Computing the intervals."}</p>`}
      ${compared && html`
        <p class="pair-gist">${withGroupedDigits(compared.words.outcome)}</p>
        <p class="dim">${withGroupedDigits(
          [compared.words.chance, compared.words.further, compared.words.seeds].filter(Boolean).join(" "))}</p>
      `}
    </div>
  `;
}

/** Every seed of both on one axis. @param {{ pair: [Setting, Setting], names: Map<string, string> }} props */
function Seeds({ pair, names }) {
  const points = pair.flatMap(({ total }) => total?.points_m ?? []);
  const low = -largest(points.map((point) => -point), 0);
  const high = 1.03 * largest(points, 1e-9);
  return html`
    <div class="pair-seeds">
      ${pair.map(({ key, agent, total }) => html`
        <p>${names.get(key)}</p>
        <${DotStrip} label=${`${names.get(key)}: every seed, typically ${metres(total?.iqm_m ?? NaN)}`}
          points=${total?.points_m ?? []} low=${low} high=${high} color=${agentOf(agent).color} axis=${metres}
          typical=${total && { iqm: total.iqm_m, low: total.low_m, high: total.high_m }} />
      `)}
      <p class="axis-title dim">
        Distance in 50 steps, m: a dot for each seed; interquartile mean with its 95 % interval
      </p>
    </div>
  `;
}

/** @param {{ pair: [Setting, Setting], summary: Summary }} props */
function Profiles({ pair, summary }) {
  const names = namesOf(pair, summary.parameters);
  /** @type {[string, string]} */
  const both = [names.get(pair[0].key) ?? "", names.get(pair[1].key) ?? ""];
  const chart = useMemo(() => profileChart(pair, both, summary), [summary, pair[0].key, pair[1].key]);
  return html`
    <figure class="profiles">
      <figcaption>
        <b>Performance profiles</b>
        ${chart.lines.some(({ low }) => low) && html`<span class="dim">Band: 95 % interval of the share</span>`}
      </figcaption>
      <p class="strip-key">
        ${chart.lines.map(({ name, color, dash = [] }) => html`
          <span style=${{ "--agent": color }}>
            <svg class="profile-key" width="28" height="8" aria-hidden="true">
              <line x1="0" x2="28" y1="4" y2="4" stroke-dasharray=${dash.join(" ") || undefined} />
            </svg>${name}
          </span>
        `)}
      </p>
      <${Chart} name="the performance profiles" ...${chart} />
    </figure>
  `;
}

// ---- figures for a paper

/** @type {[string, string, string][]} */
const FIGURES = [
  ["comparison", "Seeds and difference", "of these two"],
  ["profile", "Performance profiles", "of these two"],
  ["seeds", "Every seed", "of all settings"],
];
/** @type {[string, string][]} */
const COLUMNS = [["1", "One column, 85\u00a0mm"], ["2", "Two columns, 178\u00a0mm"]];

/** @param {{ keys: string[], saveFigure: SaveFigure }} props */
function PaperFigures({ keys, saveFigure }) {
  const [columns, setColumns] = useState("1");
  const [{ busy, problem }, setState] = useState({ busy: "", problem: "" });
  /** @param {string} kind */
  const save = (kind) => {
    setState({ busy: kind, problem: "" });
    saveFigure(kind, columns, kind === "seeds" ? [] : keys).then(
      () => setState({ busy: "", problem: "" }),
      (/** @type {RequestError} */ error) => setState({ busy: "", problem: messageOf(error) }),
    );
  };
  return html`
    <details class="more paper-figures">
      <summary>Figure for a paper</summary>
      <p class="dim small-words">PDF, SVG and PNG in one file, with caption, data and the command that repeats it.</p>
      <div class="paper-tools">
        <${Segments} label="Width" choices=${COLUMNS} value=${columns} onValue=${setColumns} />
        ${FIGURES.map(([kind, title, of]) => html`
          <button class="secondary compact" disabled=${busy !== ""} onClick=${() => save(kind)}>
            ${busy === kind ? "Drawing…" : `${title} ${of}`}
          </button>
        `)}
      </div>
      ${problem && html`<p class="problem" role="alert">${problem}</p>`}
    </details>
  `;
}
