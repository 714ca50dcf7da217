// The ranking: ranks as far as they can be told apart, distances with their intervals on one axis, and what is being
// judged.
import { useEffect, useRef } from "preact/hooks";
import { html, ProgressBar } from "../../js/components/elements.js";
import { metres } from "../../js/format.js";
import { percent, shareOf, ticks } from "../../js/scale.js";
import { agentOf } from "../../js/settings.js";
import {
  entered, entries, isWhole, nameOfNumber, shownStandings, shownTournament, unranked, withdrawn,
} from "./tournament.js";
import {
  axisOf, entryInWords, failuresInWords, intervalInWords, nameOf, progressInWords, notSeparable, rankInWords,
  spokenRank,
} from "./words.js";

/** @import { TournamentEntry, RankedEntry } from "../../js/types.js" */

/** @typedef {{ low: number, high: number }} Axis [m] */

/** The reference whose distance is a line through all rows. */
const LINE_AGENT = "greedy";

export function Ranking() {
  const { standings, state } = shownTournament();
  const shown = shownStandings.value;
  const isEmpty = standings.length === 0;
  return html`
    <section class="panel ranking-panel" aria-labelledby="ranking-title">
      <h2 id="ranking-title">${state === "ended" ? "Result" : "Ranking"}</h2>
      ${isEmpty
        ? html`<p class="dim">Nothing has been judged on all draws yet. The references are the first.</p>`
        : html`
          <${Table} standings=${shown} />
          ${shown.length < standings.length && html`
            <button class="secondary" onClick=${() => (isWhole.value = true)}>Show all ${standings.length}</button>
          `}
          <p class="dim fine">
            Distance: interquartile mean over all draws with its 95 % interval. A range of ranks, such as 1–3: entries
            whose difference on the same draws may be chance. The dotted line:
            ${" "}${agentOf(LINE_AGENT).title.toLowerCase()}.
          </p>
        `}
      ${unranked.value.length > 0 && html`<${Judging} />`}
      ${withdrawn.value.length > 0 && html`
        <p class="dim">Not judged, since the tournament ended before: ${withdrawn.value.map(nameOf).join(", ")}.</p>
      `}
    </section>
  `;
}

/**
 * @param {object} props
 * @param {RankedEntry[]} props.standings best first
 * @param {boolean} [props.isShort] without what cannot be told apart, for a projector
 */
export function Table({ standings, isShort = false }) {
  const axis = axisOf(shownTournament().standings);
  const reference = shownTournament().standings.find(({ number }) => agentOfReference(number) === LINE_AGENT);
  const line_m = reference?.iqm_m ?? null;
  return html`
    <table class="ranking" role="table" aria-label="Ranking">
      <thead role="rowgroup">
        <tr role="row">
          <th role="columnheader" scope="col">Rank</th>
          <th role="columnheader" scope="col">Entry</th>
          <th role="columnheader" scope="col" class="distance">Distance</th>
          <th role="columnheader" scope="col" class="on-axis">
            <span class="sr-only">95 % interval, on one axis</span><${Numbers} axis=${axis} />
          </th>
          ${!isShort && html`<th role="columnheader" scope="col" class="remarks">Not separable from</th>`}
        </tr>
      </thead>
      <tbody role="rowgroup">
        ${standings.map((standing) => html`
          <${Row} key=${standing.number} standing=${standing} axis=${axis} line_m=${line_m} isShort=${isShort} />
        `)}
      </tbody>
    </table>
  `;
}

/** @param {number} number */
function agentOfReference(number) {
  const { is_reference = false, entry = null } = entries.value.get(number) ?? {};
  return is_reference ? entry?.agent ?? null : null;
}

/** An element that takes the focus once it is the entry that was just made. @param {number} number */
function useFocusOf(number) {
  const element = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => {
    if (entered.value !== number) return;
    element.current?.focus();
    entered.value = null;
  }, [entered.value]);
  return element;
}

/** @param {{ standing: RankedEntry, axis: Axis, line_m: number | null, isShort: boolean }} props */
function Row({ standing, axis, line_m, isShort }) {
  const { number, iqm_m } = standing;
  const entry = entries.value.get(number);
  const element = useFocusOf(number);
  if (!entry) return null;
  return html`
    <tr role="row" ref=${element} tabindex=${entry.is_own ? "-1" : undefined} class=${classOf(entry, isShort)}>
      <td role="cell" class="rank num">
        <span aria-hidden="true">${rankInWords(standing)}</span><span class="sr-only">${spokenRank(standing)}</span>
      </td>
      <th role="rowheader" scope="row" class="who"><${Who} entry=${entry} isShort=${isShort} /></th>
      <td role="cell" class="distance num">
        <b>${metres(iqm_m)}</b> <span class="dim">${intervalInWords(standing)}</span>
      </td>
      <td role="cell" class="on-axis"><${Mark} standing=${standing} axis=${axis} line_m=${line_m} /></td>
      ${!isShort && html`<td role="cell" class="remarks"><${Remarks} standing=${standing} /></td>`}
    </tr>
  `;
}

/** On a projector nothing is anybody's own. @type {(entry: TournamentEntry, isShort?: boolean) => string} */
const classOf = ({ is_own, is_reference }, isShort = false) =>
  [is_own && !isShort ? "own" : "", is_reference ? "reference" : ""].filter(Boolean).join(" ");

/** @param {{ entry: TournamentEntry, isShort?: boolean }} props */
function Who({ entry, isShort = false }) {
  const { is_own, is_reference } = entry;
  const what = entry.entry && !isShort ? entryInWords(entry.entry, shownTournament().rules) : "";
  const words = is_reference ? "reference" : what;
  return html`
    <span class="name" title=${nameOf(entry)}>${nameOf(entry)}</span>
    ${is_own && !isShort && html` <span class="tag">yours</span>`}
    ${words && html`<span class="dim what">${words}</span>`}
  `;
}

/** @param {{ standing: RankedEntry }} props */
function Remarks({ standing }) {
  const failed = failuresInWords(standing, shownTournament().rules.draws);
  const names = notSeparable(standing, nameOfNumber);
  return html`
    ${names
      ? html`<span><span class="repeated">not separable from </span>${names}</span>`
      : html`<span class="dim">separable from all</span>`}
    ${failed && html`<span class="failed">${failed} draws</span>`}
  `;
}

// ---- the axis

const NUMBERS = 4;

/** @param {{ axis: Axis }} props */
const Numbers = ({ axis: { low, high } }) => html`
  <svg class="axis-numbers" width="100%" height="1.2em" aria-hidden="true">
    ${ticks(high, NUMBERS, low).map((value) => html`
      <text key=${value} class="axis-number" x=${percent(shareOf(value, low, high))} y="1em"
        text-anchor="middle">${metres(value)}</text>
    `)}
  </svg>
`;

/** The interval with the mean, on the axis of all. */
/** @param {{ standing: RankedEntry, axis: Axis, line_m: number | null }} props */
function Mark({ standing, axis: { low, high }, line_m }) {
  const { iqm_m, low_m, high_m } = standing;
  const at = (/** @type {number} */ value) => percent(shareOf(value, low, high));
  return html`
    <svg class="interval-mark" width="100%" role="img"
      aria-label=${`${metres(iqm_m)}, 95 % interval ${intervalInWords(standing)} m`}>
      ${ticks(high, NUMBERS, low).map((value) => html`
        <line key=${value} class="grid" x1=${at(value)} x2=${at(value)} y1="0" y2="100%" />
      `)}
      ${line_m !== null && html`<line class="reference-line" x1=${at(line_m)} x2=${at(line_m)} y1="0" y2="100%" />`}
      <line class="interval" x1=${at(low_m)} x2=${at(high_m)} y1="50%" y2="50%" />
      <circle class="mean" cx=${at(iqm_m)} cy="50%" />
    </svg>
  `;
}

// ---- what is not ranked yet

const Judging = () => html`
  <h3 id="judging-title">Being judged</h3>
  <ul class="judging" aria-labelledby="judging-title">
    ${unranked.value.map((entry) => html`<${Open} key=${entry.number} entry=${entry} />`)}
  </ul>
`;

/** @param {{ entry: TournamentEntry }} props */
function Open({ entry }) {
  const { number, is_own, judged, of } = entry;
  const element = useFocusOf(number);
  return html`
    <li ref=${element} tabindex=${is_own ? "-1" : undefined} class=${classOf(entry)}>
      <p class="who"><${Who} entry=${entry} /></p>
      <p class="dim num">${progressInWords(entry)}</p>
      <${ProgressBar} label=${`${nameOf(entry)}: ${progressInWords(entry)}`} share=${judged / of} />
    </li>
  `;
}
