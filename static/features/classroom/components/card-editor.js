// The card that is edited: texts, what it takes of the page, what may be changed, the question, and what Go runs.
import { changeCard, chosenCard, pageAsState } from "../lessons/draft.js";
import { KINDS } from "../room/questions.js";
import { allTabs, tabTitle } from "../../../js/workspace.js";
import { html, Segments } from "../../../js/components/elements.js";
import { AskEditor } from "./ask-editor.js";
import { MayEditor } from "./allowed-editor.js";

/** @import { LessonCard } from "../../../js/types.js" */

const GO = /** @type {[LessonCard["go"], string][]} */ (
  [[null, "Nothing"], ["training", "Training"], ["race", "Race"], ["what-if", "What if"]]);

export function CardEditor() {
  const card = chosenCard.value;
  if (card === null) return null;
  return html`
    <section class="panel card-editor" aria-labelledby="card-editor-title">
      <h2 id="card-editor-title">The card</h2>
      <${Texts} card=${card} />
      <${Taken} card=${card} />
      <fieldset>
        <legend>Panels of the page that are shown</legend>
        <div class="panel-boxes">
          ${allTabs.value.map((tab) => html`
            <label class="check" key=${tab}>
              <input type="checkbox" checked=${card.show?.includes(/** @type {any} */ (tab)) ?? true}
                onChange=${() => changeCard({ show: toggled(card.show ?? null, tab) })} />${tabTitle(tab)}
            </label>
          `)}
        </div>
      </fieldset>
      <${AskEditor} card=${card} />
      <div class="go-choice"><span>Go runs</span>
        <${Segments} label="Go runs" choices=${GO} value=${card.go ?? null}
          onValue=${(/** @type {any} */ go) => changeCard({ go })} /></div>
      <${MayEditor} card=${card} />
      <${Reveal} card=${card} />
    </section>
  `;
}

/** Null stands for all panels. @param {any} show @param {string} tab @returns {any} */
function toggled(show, tab) {
  const shown = show ?? allTabs.peek();
  const now = shown.includes(tab) ? shown.filter((/** @type {string} */ name) => name !== tab) : [...shown, tab];
  return now.length === allTabs.peek().length ? null : allTabs.peek().filter((name) => now.includes(name));
}

/** @param {{ card: LessonCard }} props */
const Texts = ({ card }) => html`
  <label for="card-title">Title of the card</label>
  <input id="card-title" type="text" maxlength="300" value=${card.title ?? ""}
    onInput=${(/** @type {any} */ { target }) => changeCard({ title: target.value })} />
  <label for="card-text">Text, in Markdown</label>
  <textarea id="card-text" rows="5" maxlength="8000" value=${card.text}
    onInput=${(/** @type {any} */ { target }) => changeCard({ text: target.value })}></textarea>
`;

/** What the card opens of the page; the page keeps it while lessons are edited. @param {{ card: LessonCard }} props */
const Taken = ({ card }) => html`
  <div class="taken">
    <p><b>Opens the page</b> <span class="dim">${stateInWords(card.state ?? null)}</span></p>
    <div class="row">
      <button class="secondary compact" onClick=${() => changeCard({ state: pageAsState() })}>
        Take the page as it is
      </button>
      <a class="quiet button" href="#">To the page</a>
      ${card.state && html`<button class="quiet" onClick=${() => changeCard({ state: null })}>Take nothing</button>`}
    </div>
  </div>
`;

/** @param {any} state */
function stateInWords(state) {
  if (!state) return "as it was";
  const { form = {}, ...pageState } = state;
  const words = [...Object.entries(pageState), ...Object.entries(form ?? {})].filter(([, value]) => value !== null)
    .map(([name, value]) => `${name} ${typeof value === "object" ? JSON.stringify(value) : value}`);
  return words.join(", ") || "as it was";
}

/** @param {{ card: LessonCard }} props */
function Reveal({ card }) {
  const { reveal = null } = card;
  /** @type {any} */
  const { text, answer = null } = typeof reveal === "string" ? { text: reveal } : reveal ?? { text: "" };
  const { ask = null } = card;
  const RightAnswer = ask && KINDS[ask.kind].RightAnswer;
  const change = (/** @type {any} */ changes) => changeCard({ reveal: { text, answer, ...changes } });
  return html`
    <label for="card-reveal">Revealed afterwards, in Markdown</label>
    <textarea id="card-reveal" rows="3" maxlength="8000" value=${text ?? ""}
      onInput=${(/** @type {any} */ { target }) => change({ text: target.value })}></textarea>
    ${RightAnswer && html`
      <${RightAnswer} ask=${ask} answer=${answer} change=${(/** @type {any} */ right) => change({ answer: right })} />
    `}
  `;
}
