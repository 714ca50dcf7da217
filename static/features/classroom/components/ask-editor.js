// The question of the card that is edited.
import { changeCard } from "../lessons/draft.js";
import { KINDS } from "../room/questions.js";
import { html, Segments } from "../../../js/components/elements.js";

/** @import { Ask, LessonCard } from "../../../js/types.js" */

const CHOICES = /** @type {[Ask["kind"] | null, string][]} */ (
  [[null, "None"], ...Object.entries(KINDS).map(([kind, { title }]) => [kind, title])]);

/** A question of a kind, with the words of the one before. @type {(kind: Ask["kind"] | null, before: any) => any} */
const ofKind = (kind, before) =>
  (kind === null ? null : { kind, text: before?.text ?? "", ...KINDS[kind].fieldsOf?.(before) });

/** @param {{ card: LessonCard }} props */
export function AskEditor({ card }) {
  const ask = /** @type {any} */ (card.ask ?? null);
  const Editor = ask && KINDS[/** @type {Ask["kind"]} */ (ask.kind)].Editor;
  const change = (/** @type {Partial<Ask>} */ changes) => changeCard({ ask: { ...ask, ...changes } });
  return html`
    <fieldset class="ask-editor">
      <legend>Question</legend>
      <${Segments} label="Kind of the question" choices=${CHOICES} value=${ask?.kind ?? null}
        onValue=${(/** @type {any} */ kind) => changeCard({ ask: ofKind(kind, ask) })} />
      ${ask && html`
        <label for="ask-text">The question, in Markdown</label>
        <textarea id="ask-text" rows="2" value=${ask.text}
          onInput=${(/** @type {any} */ { target }) => change({ text: target.value })}></textarea>
      `}
      ${Editor && html`<${Editor} ask=${ask} change=${change} />`}
    </fieldset>
  `;
}
