// The question that a room asks before a lesson and after it, to measure what the class gains.
import { html, Segments } from "../../../js/components/elements.js";
import { changeLesson } from "../lessons/draft.js";
import { KINDS } from "../room/questions.js";

/** @import { LessonDocument } from "../../../js/types.js" */

/** Those that have one right answer. */
const CHOICES = /** @type {["choice" | "number" | null, string][]} */ (
  [[null, "None"], ["choice", "Choice"], ["number", "Number"]]);

/** @param {{ lesson: LessonDocument }} props */
export function KnowledgeEditor({ lesson }) {
  const before = /** @type {any} */ (lesson.before ?? null);
  const kind = /** @type {"choice" | "number"} */ (before?.kind);
  const { Editor, RightAnswer } = before ? KINDS[kind] : { Editor: undefined, RightAnswer: undefined };
  const change = (/** @type {any} */ changes) => changeLesson({ before: { ...before, ...changes } });
  const choose = (/** @type {"choice" | "number" | null} */ chosen) => changeLesson({
    before: chosen === null ? null
      : /** @type {any} */ ({ kind: chosen, text: before?.text ?? "", ...KINDS[chosen].fieldsOf?.(before), right: "" }),
    after: null,
  });
  return html`
    <fieldset class="ask-editor">
      <legend>Question before and after</legend>
      <${Segments} label="Kind of the question before and after" choices=${CHOICES} value=${before?.kind ?? null}
        onValue=${choose} />
      ${before && html`
        <label for="before-text">The question, in Markdown</label>
        <textarea id="before-text" rows="2" value=${before.text}
          onInput=${(/** @type {any} */ { target }) => change({ text: target.value })}></textarea>
        <${Editor} ask=${before} change=${change} id="before-choices" />
        <${RightAnswer} ask=${before} answer=${before.right} isNeeded id="before-right"
          change=${(/** @type {any} */ right) => change({ right: right ?? "" })} />
      `}
    </fieldset>
  `;
}
