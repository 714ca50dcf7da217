// The policies of two trainings: the states in which their best moves differ.
import { computed, signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { comparable } from "../../../js/compare.js";
import { askAgain, differencesOf, followTables, haveSameStates, tableOf } from "../policies.js";
import { count, inMillimetres, percentage, whole } from "../../../js/format.js";
import { moveInWords, stateCells, stateInWords } from "../steps.js";
import { html } from "../../../js/components/elements.js";
import { Key } from "../../../js/components/compare/key.js";

/** @import { DifferentState, WholeTable } from "../policies.js" */
/** @import { Changed, FootCells } from "../../../js/types.js" */

const FIRST_ROWS = 12;

/** The two that were chosen; null takes the first two. */
const chosen = signal(/** @type {(string | null)[]} */ ([null, null]));

const trainings = computed(() =>
  comparable.value.filter(({ run }) => run.kind === "training" && run.progress.done > 0));

/** The two trainings whose policies are compared; fewer if there are no two. */
const two = computed(() => {
  const all = trainings.value;
  const [wanted, other] = chosen.value.map((id) => all.find((training) => training.id === id));
  const first = wanted ?? all.find((training) => training !== other);
  const second = other && other !== first ? other : all.find((training) => training !== first);
  return [first, second].filter((training) => training !== undefined);
});

export function Policies() {
  useEffect(() => followTables(() => two.value.map(({ run }) => run)), []);
  return html`
    <section class="panel policies" aria-labelledby="compare-policies">
      <h2 id="compare-policies">Policies</h2>
      ${two.value.length < 2
        ? html`<p class="dim">Two trainings that have begun are needed to compare what they have learned.</p>`
        : html`
          ${trainings.value.length > 2 && html`<${Choice} />`}
          <${Answered} />
        `}
    </section>
  `;
}

function Choice() {
  /** @param {number} number */
  const choose = (number) => (/** @type {Changed} */ { target }) => {
    const ids = two.value.map(({ id }) => id);
    // Choosing the other one exchanges them.
    if (ids[1 - number] === target.value) ids[1 - number] = ids[number];
    ids[number] = target.value;
    chosen.value = ids;
  };
  return html`
    <div class="policy-choice">
      ${two.value.map((training, number) => html`
        <label class="choice">
          <span>${number === 0 ? "Policy of" : "and of"}</span>
          <select onChange=${choose(number)}>
            ${trainings.value.map(({ id, letter, title }) => html`
              <option value=${id} selected=${id === training.id}>${letter}: ${title}</option>
            `)}
          </select>
        </label>
      `)}
    </div>
  `;
}

function Answered() {
  const answers = two.value.map(({ run }) => tableOf(run));
  const problem = answers.map((answer) => answer?.problem).find(Boolean);
  if (problem) {
    return html`
      <div class="compare-none" role="alert">
        <p>${problem}</p>
        <button class="secondary compact" onClick=${askAgain}>Try again</button>
      </div>
    `;
  }
  if (answers.some((answer) => answer === null)) {
    return html`<p role="status"><span class="spinner" aria-hidden="true"></span> Building the tables again…</p>`;
  }
  const [first, other] = answers.flatMap((answer) => answer?.table ?? []);
  if (!haveSameStates(first, other)) {
    return html`
      <p class="dim">Their states are not the same: they move other groups of legs, or have another foot grid.</p>
    `;
  }
  return html`<${Differences} tables=${[first, other]} />`;
}

/** @param {{ tables: WholeTable[] }} props */
function Differences({ tables }) {
  const [isAll, setAll] = useState(false);
  const [a, b] = two.value;
  const { different, compared, known } = differencesOf(tables[0], tables[1]);
  const share = known.both ? ` (${percentage(different.length / known.both)})` : "";
  const shown = isAll ? different : different.slice(0, FIRST_ROWS);
  return html`
    <p>
      Both have practised in ${whole(known.both)} of ${count(compared, "state")}; their best moves differ in
      ${" "}<b>${whole(different.length)}</b>${share}.
      ${" "}<span class="dim">
        Only ${a.letter} knows ${whole(known.one)}, only ${b.letter} ${whole(known.other)}.
        ${compared < tables[0].states && ` Of ${whole(tables[0].states)} states only these are compared.`}
      </span>
    </p>
    ${shown.length > 0 && html`<${States} shown=${shown} grid=${tables[0]} />`}
    ${shown.length < different.length && html`
      <button class="secondary compact" onClick=${() => setAll(true)}>Show all ${whole(different.length)}</button>
    `}
  `;
}

/** @param {{ shown: DifferentState[], grid: FootCells }} props */
const States = ({ shown, grid }) => html`
  <div class="scroller" tabindex="0" role="region" aria-label="States in which the best moves differ">
    <table class="side-by-side states">
      <thead>
        <tr>
          <th scope="col">State</th>
          ${two.value.map((training) => html`
            <th scope="col" key=${training.id}><${Key} one=${training} /> best move, its value</th>
          `)}
        </tr>
      </thead>
      <tbody>
        ${shown.map(({ index, bests }) => html`
          <tr key=${index}>
            <th scope="row">${stateInWords(stateCells(index, grid), grid)}</th>
            ${bests.map(({ move, value, visits }) => html`
              <td>
                ${moveInWords(move, grid)}, <b class="num">${value === null ? "–" : inMillimetres(value)}</b>
                ${" "}<span class="dim">${count(visits, "visit")}</span>
              </td>
            `)}
          </tr>
        `)}
      </tbody>
    </table>
  </div>
`;
