// An explained step: the move, its reason, and the update of the values, as the rule with its numbers.
import { count, inMillimetres, t } from "../../../js/format.js";
import { colourScale, comparedNumber, moveInWords, ruleNumber, stateInWords } from "../steps.js";
import { percent, shareOf, valueColours } from "../../../js/scale.js";
import { isAtLeast } from "../../../js/workspace.js";
import { html } from "../../../js/components/elements.js";

/** @import { Belief, Explanation, FootCells, Move, ValueUpdate } from "../../../js/types.js" */

/** Products are not broken over two lines. @param {string} text */
const unbroken = (text) => text.replaceAll(" · ", "\u00a0·\u00a0");

/** Moves that are ranked, for those who study and for all others. */
const MAX_MOVES = { study: 6, other: 4 };
const SHORTEST_BAR = 0.02;

/** Why its move was made and what it missed, each in a sentence. @param {{ told: Explanation }} props */
export const Reasons = ({ told: { why, missed, unexplained } }) => html`
  <section class="reasons">
    <h3>Why this move</h3>
    <p class=${why ? "" : "dim"}>${why ?? sentenceOf(unexplained ?? t("Its agent does not explain it"))}</p>
    ${missed && html`<h3>What it missed</h3><p>${missed}</p>`}
  </section>
`;

/**
 * `isFull`: with where its feet were, and the update of its values as the rule with its numbers. `isRanked`: with the
 * scores of the moves, where no other view has them.
 * @param {{ told: Explanation, isFull: boolean, isRanked: boolean }} props
 */
export const ExplainedStep = ({ told, isFull, isRanked }) => html`
  <div class="told">
    ${isFull && html`<p class="dim told-state">Before the step: ${stateInWords(told.observation, told)}.</p>`}
    ${told.search ? html`<${Futures} told=${told} />` : isRanked && told.choice && html`<${Scores} told=${told} />`}
    ${isFull && html`<${Update} told=${told} />`}
  </div>
`;

/**
 * Number of trials of a move there; null where they are not counted.
 * @param {Explanation} explanation
 * @param {Move} other
 */
const triesOf = ({ visits }, [pair, cell]) => visits?.[pair]?.[cell] ?? null;

/** @param {string} text */
const sentenceOf = (text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!]$/.test(text) ? "" : "."}`;

/** What a search compared: no values that were learned, and in no colours of these. */
/** @param {{ told: Explanation }} props */
function Futures({ told }) {
  const { futures, compares } = /** @type {NonNullable<Explanation["search"]>} */ (told.search);
  const rows = futures.map(({ action, return_m, reward_m, steps, sequences }) => ({
    move: action, score: return_m,
    note: t("{reward} at once; {sequences} {sequences|sequence|sequences} of {steps} {steps|step|steps}", {
      reward: inMillimetres(reward_m), sequences, steps,
    }),
  }));
  return html`<${Ranking} told=${told} caption=${compares} rows=${rows} colour=${null} />`;
}

/** The moves with the highest scores, and the one that was made. @param {{ told: Explanation }} props */
function Scores({ told }) {
  const { scores, criterion } = /** @type {NonNullable<Explanation["choice"]>} */ (told.choice);
  const rows = scores.flatMap((row, pair) => row.map((score, cell) => ({
    move: [pair, cell], score, note: triesOf(told, [pair, cell]) === 0 ? t("never tried") : "",
  })));
  const scored = rows.filter(({ score }) => score !== null);
  const values = scored.map(({ score }) => Number(score));
  const scale = colourScale({ low: Math.min(0, ...values), high: Math.max(...values) });
  return html`<${Ranking} told=${told} caption=${criterion} rows=${scored} colour=${scale} />`;
}

/** @typedef {{ move: Move, score: number, note: string }} RankedMove */

/**
 * `colour`: the scale of values whose colours the bars have; null for none.
 * @param {{
 *   told: Explanation, caption: string, rows: RankedMove[], colour: { low: number, high: number } | null
 * }} props
 */
function Ranking({ told, caption, rows, colour }) {
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
            <td class="score-bar" aria-hidden="true"><i style=${barOf(action.score, low, high, colour)}></i></td>
            <td>${inMillimetres(action.score)}</td>
          </tr>
        `)}
      </tbody>
    </table>
    ${all.length > shown.length && html`<p class="dim">${furtherMoves(all.length - shown.length)}</p>`}
  `;
}

const furtherMoves = (/** @type {number} */ moves) => t("and {moves} other {moves|move|moves}.", { moves });

/** @type {(score: number, low: number, high: number, colour: { low: number, high: number } | null) => object} */
const barOf = (score, low, high, colour) => ({
  width: percent(Math.max(SHORTEST_BAR, shareOf(score, low, high))),
  background: colour ? valueColours(score, colour.low, colour.high).background : "var(--dim)",
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
        ? t("Computed again from these numbers, it is the stored value to the last bit.")
        : t("Computed again from these numbers, it is not the stored value.")}
        ${stored !== null && stored !== after && ` ${t("Planning changed it further, to {value}.", {
          value: comparedNumber(stored, after),
        })}`}
      </p>
    </div>
  `;
}

/** @param {number} value @param {number | null} deviation @param {string} unit */
const withDeviation = (value, deviation, unit) => {
  const text = unit === "m" ? inMillimetres(value) : ruleNumber(value);
  return deviation === null ? text : `${text} ± ${inMillimetres(deviation)}`;
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
