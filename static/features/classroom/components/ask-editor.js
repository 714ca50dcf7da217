// The question of the card that is edited.
import { changeCard, linesOf, numberOf } from "../lessons/draft.js";
import { html, Segments } from "../../../js/components/elements.js";

/** @import { Ask, LessonCard } from "../../../js/types.js" */

const KINDS = /** @type {[Ask["kind"] | null, string][]} */ (
  [[null, "None"], ["choice", "Choice"], ["number", "Number"], ["point", "Point"], ["curve", "Curve"]]);

/** A question of a kind, with the words of the one before. @type {(kind: Ask["kind"] | null, before: any) => any} */
function ofKind(kind, before) {
  if (kind === null) return null;
  const text = before?.text ?? "";
  if (kind === "choice") return { kind, text, choices: before?.choices ?? [] };
  return kind === "number" ? { kind, text, unit: "m" } : { kind, text };
}

/** @param {{ card: LessonCard }} props */
export function AskEditor({ card }) {
  const ask = /** @type {any} */ (card.ask ?? null);
  const change = (/** @type {Partial<Ask>} */ changes) => changeCard({ ask: { ...ask, ...changes } });
  return html`
    <fieldset class="ask-editor">
      <legend>Question</legend>
      <${Segments} label="Kind of the question" choices=${KINDS} value=${ask?.kind ?? null}
        onValue=${(/** @type {any} */ kind) => changeCard({ ask: ofKind(kind, ask) })} />
      ${ask && html`
        <label for="ask-text">The question, in Markdown</label>
        <textarea id="ask-text" rows="2" value=${ask.text}
          onInput=${(/** @type {any} */ { target }) => change({ text: target.value })}></textarea>
      `}
      ${ask?.kind === "choice" && html`
        <label for="ask-choices">Answers to choose from, one a line; the name of an agent stands for its win</label>
        <textarea id="ask-choices" rows="3" value=${(ask.choices ?? []).join("\n")}
          onChange=${(/** @type {any} */ { target }) => change({ choices: linesOf(target.value) })}></textarea>
      `}
      ${ask?.kind === "number" && html`<${NumberRules} ask=${ask} change=${change} />`}
    </fieldset>
  `;
}

/** @param {{ ask: Ask, change: (changes: Partial<Ask>) => unknown }} props */
const NumberRules = ({ ask, change }) => html`
  <div class="number-rules">
    ${[["minimum", "Least"], ["maximum", "Most"]].map(([name, title]) => html`
      <label key=${name}>${title}
        <input type="text" inputmode="decimal" value=${/** @type {any} */ (ask)[name] ?? ""}
          onChange=${(/** @type {any} */ { target }) => change({ [name]: numberOf(target.value) })} />
      </label>
    `)}
    <label>Unit
      <input type="text" maxlength="20" value=${ask.unit ?? ""}
        onChange=${(/** @type {any} */ { target }) => change({ unit: target.value.trim() || null })} />
    </label>
  </div>
`;
