// An explained step: the move, its reason, and the update of the values, as the rule with its numbers.
import { agentOf } from "../../../js/settings.js";
import { count } from "../../../js/format.js";
import { comparedNumber, fineMillimetres, moveInWords, ruleNumber, stateInWords } from "../steps.js";
import { percent, shareOf, valueColours } from "../../../js/scale.js";
import { isAtLeast } from "../../../js/workspace.js";
import { html } from "../../../js/components/elements.js";

/** @import { Belief, Explanation, FootCells, Move, ValueUpdate } from "../../../js/types.js" */

/** Products are not broken over two lines. @param {string} text */
const unbroken = (text) => text.replaceAll(" · ", "\u00a0·\u00a0");

/** Moves that are ranked, for those who study and for all others. */
const MAX_MOVES = { study: 6, other: 4 };
const SHORTEST_BAR = 0.02;

/**
 * `isFull`: with where its feet were, and the update of its values as the rule with its numbers.
 * @param {{ told: Explanation, isFull: boolean }} props
 */
export const ExplainedStep = ({ told, isFull }) => html`
  <div class="told">
    ${isFull && html`<${Happened} told=${told} />`}
    <${Choice} told=${told} />
    ${isFull && html`<${Update} told=${told} />`}
  </div>
`;

/** @param {{ told: Explanation }} props */
function Happened({ told }) {
  const { reward_m } = told;
  const visits = triesOf(told, told.action);
  const before = visits ? `, which it had tried ${times(visits)} before` : ", for the first time";
  const tried = visits === null ? "" : before;
  const went = reward_m < 0 ? "back" : "forward";
  return html`
    <p>
      <b>${agentOf(told.agent).title} moved ${moveInWords(told.action, told)}</b>${tried}. That brought it
      ${" "}<b>${fineMillimetres(Math.abs(reward_m))} ${went}</b>.
      <span class="dim told-state">Before the step: ${stateInWords(told.observation, told)}.</span>
    </p>
  `;
}

/**
 * Number of trials of a move there; null where they are not counted.
 * @param {Explanation} explanation
 * @param {Move} other
 */
const triesOf = ({ visits }, [pair, cell]) => visits?.[pair]?.[cell] ?? null;

/** @param {number} visits */
const times = (visits) => (visits === 1 ? "once" : count(visits, "time"));

// ---- why this move

/** @param {{ told: Explanation }} props */
function Choice({ told }) {
  const { choice, search, unexplained } = told;
  if (search) return html`<${Search} told=${told} />`;
  if (!choice) {
    return html`
      <section>
        <h3>Why this move</h3>
        <p class="dim">${sentenceOf(unexplained ?? "Its agent does not explain it")}</p>
      </section>
    `;
  }
  return html`
    <section>
      <h3>Why this move</h3>
      ${choice.sentences.map((sentence) => html`<p>${sentence}</p>`)}
      <${Scores} told=${told} />
    </section>
  `;
}

/** @param {string} text */
const sentenceOf = (text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!]$/.test(text) ? "" : "."}`;

/** @param {{ told: Explanation }} props */
function Search({ told }) {
  const { sentences, futures, compares } = /** @type {NonNullable<Explanation["search"]>} */ (told.search);
  const rows = futures.map(({ action, return_m, reward_m, steps, sequences }) => ({
    move: action, score: return_m,
    note: `${fineMillimetres(reward_m)} at once; ${count(sequences, "sequence")} of ${count(steps, "step")}`,
  }));
  return html`
    <section>
      <h3>Why this move</h3>
      ${sentences.map((sentence) => html`<p>${sentence}</p>`)}
      <${Ranking} told=${told} caption=${compares} rows=${rows} />
    </section>
  `;
}

/** The moves with the highest scores, and the one that was made. @param {{ told: Explanation }} props */
function Scores({ told }) {
  const { scores, criterion } = /** @type {NonNullable<Explanation["choice"]>} */ (told.choice);
  const rows = scores.flatMap((row, pair) => row.map((score, cell) => ({
    move: [pair, cell], score, note: triesOf(told, [pair, cell]) === 0 ? "never tried" : "",
  })));
  return html`<${Ranking} told=${told} caption=${criterion} rows=${rows.filter(({ score }) => score !== null)} />`;
}

/** @typedef {{ move: Move, score: number, note: string }} RankedMove */

/** @param {{ told: Explanation, caption: string, rows: RankedMove[] }} props */
function Ranking({ told, caption, rows }) {
  const all = rows.toSorted((a, b) => b.score - a.score);
  /** @param {{ move: Move }} move */
  const isMade = ({ move }) => move[0] === told.action[0] && move[1] === told.action[1];
  const first = all.slice(0, isAtLeast("study") ? MAX_MOVES.study : MAX_MOVES.other);
  const shown = first.some(isMade) ? first : [...first.slice(0, -1), ...all.filter(isMade)];
  const [high, low] = [all[0].score, all[all.length - 1].score];
  return html`
    <table class="scores">
      <caption class="dim">${sentenceOf(caption)}</caption>
      <tbody>
        ${shown.map((action) => html`
          <tr class=${isMade(action) ? "made" : ""}>
            <th scope="row">
              ${moveInWords(action.move, told)}${isMade(action) && html`<span class="sr-only">, made</span>`}
              ${action.note && html`<span class="dim note">${action.note}</span>`}
            </th>
            <td class="score-bar" aria-hidden="true"><i style=${barOf(action.score, low, high)}></i></td>
            <td>${fineMillimetres(action.score)}</td>
          </tr>
        `)}
      </tbody>
    </table>
    ${all.length > shown.length && html`<p class="dim">and ${count(all.length - shown.length, "other move")}.</p>`}
  `;
}

/** @param {number} score @param {number} low @param {number} high */
const barOf = (score, low, high) => ({
  width: percent(Math.max(SHORTEST_BAR, shareOf(score, low, high))),
  background: valueColours(score, low, high).background,
});

// ---- the update

/** @param {{ told: Explanation }} props */
function Update({ told }) {
  const { update } = told;
  if (!update && !told.choice) return null;
  if (!update) {
    return html`<section><h3>Update</h3><p class="dim">Nothing: it does not learn here.</p></section>`;
  }
  return html`
    <section>
      <h3>Update</h3>
      <p>${update.summary}</p>
      ${update.direct && html`<${Rule} update=${update.direct} stored=${update.stored} />`}
      ${update.beliefs.length > 0 && html`<${Beliefs} beliefs=${update.beliefs} />`}
      ${update.others.count > 0 && html`<${Others} others=${update.others} grid=${told} />`}
    </section>
  `;
}

/** @param {{ update: ValueUpdate, stored: number | null }} props */
function Rule({ update, stored }) {
  const { rule, numbers, terms, before, after, is_exact } = update;
  return html`
    <div class="rule">
      <p class="formula"><span class="dim">new value =</span> ${unbroken(rule)}</p>
      <p class="formula"><span class="dim">=</span> ${unbroken(numbers)}</p>
      <p class="formula"><span class="dim">=</span> <b title=${`${after}`}>${comparedNumber(after, before)}</b>
        <span class="dim">, before ${comparedNumber(before, after)}</span></p>
      <dl class="terms">
        ${terms.map(({ symbol, value, meaning }) => html`
          <div>
            <dt>${symbol} = <span title=${`${value}`}>${ruleNumber(value)}</span></dt>
            <dd class="dim">${meaning}</dd>
          </div>
        `)}
      </dl>
      <p class="dim">${is_exact
        ? "Computed again from these numbers, it is the stored value to the last bit."
        : "Computed again from these numbers, it is not the stored value."}
        ${stored !== null && stored !== after && ` Planning changed it further, to ${comparedNumber(stored, after)}.`}
      </p>
    </div>
  `;
}

/** @param {number} value @param {number | null} deviation @param {string} unit */
const withDeviation = (value, deviation, unit) => {
  const text = unit === "m" ? fineMillimetres(value) : ruleNumber(value);
  return deviation === null ? text : `${text} ± ${fineMillimetres(deviation)}`;
};

/** @param {{ beliefs: Belief[] }} props */
const Beliefs = ({ beliefs }) => html`
  <table class="beliefs">
    <caption class="dim">Its model of this step</caption>
    <thead><tr><td></td><th scope="col">before</th><th scope="col">after</th></tr></thead>
    <tbody>
      ${beliefs.map(({ name, unit, before, after, deviation_before, deviation_after }) => html`
        <tr>
          <th scope="row">${name}</th>
          <td>${withDeviation(before, deviation_before, unit)}</td>
          <td>${withDeviation(after, deviation_after, unit)}</td>
        </tr>
      `)}
    </tbody>
  </table>
`;

/** @param {{ others: NonNullable<Explanation["update"]>["others"], grid: FootCells }} props */
const Others = ({ others, grid }) => html`
  <details class="fold">
    <summary>${count(others.count, "further update")} of ${count(others.values_changed, "value")}</summary>
    <ul class="others">
      ${others.largest.map((update) => html`
        <li>
          <span>${update.move}</span> <span class="dim">where ${stateInWords(update.observation, grid)}</span>
          <p class="formula">${unbroken(update.numbers)} = <b>${comparedNumber(update.after, update.before)}</b></p>
        </li>
      `)}
    </ul>
    ${others.largest.length < others.count && html`<p class="dim">The largest changes are shown.</p>`}
  </details>
`;
