// The card that is edited as a participant's phone shows it.
import { chosen, chosenCard, draft } from "../lessons/draft.js";
import { paragraphs } from "../lessons/markdown.js";
import { May } from "../room/allowed-settings.js";
import { Answer, KINDS } from "../room/questions.js";
import { useEffect } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { withStyle } from "../../../js/features.js";

/** @import { Block, Inline } from "../lessons/markdown.js" */

export function Preview() {
  const card = chosenCard.value;
  useEffect(() => { withStyle("style/card.css", Promise.resolve()); }, []);
  if (card === null) return null;
  const isAsked = card.ask && (KINDS[card.ask.kind].isComplete?.(card.ask) ?? true);
  return html`
    <section class="preview" aria-labelledby="preview-title">
      <h2 id="preview-title" class="dim">As a phone shows it</h2>
      <div class="phone-frame">
        <p class="dim">Card ${chosen.value + 1} of ${draft.value?.cards.length}</p>
        ${card.title && html`<h3>${card.title}</h3>`}
        <${Text} text=${card.text} />
        ${isAsked && html`
          <div class="question">
            <${Text} text=${card.ask?.text ?? ""} />
            <${Answer} card=${card} number=${`preview ${chosen.value}`} locked=${undefined} />
          </div>
        `}
        ${Object.keys(card.may ?? {}).length > 0 && html`
          <${May} card=${card} number=${`preview ${chosen.value}`} isDisabled=${false} />
        `}
        ${(card.ask || card.go) && html`
          <p class="preview-button" aria-hidden="true">${buttonOf(Boolean(card.ask), Boolean(card.go))}</p>
        `}
      </div>
    </section>
  `;
}

/** @type {(isAsked: boolean, goes: boolean) => string} */
const buttonOf = (isAsked, goes) => {
  if (!isAsked) return "Go";
  return goes ? "Lock my prediction, and go" : "Lock my prediction";
};

/** A text as the server will render it, near enough to judge it. @param {{ text: string }} props */
const Text = ({ text }) => html`<div class="prose">${paragraphs(text).map((block, n) => drawn(block, n))}</div>`;

/** @param {Block} block @param {number} key */
function drawn({ kind, parts, items }, key) {
  if (kind === "list") {
    return html`<ul key=${key}>${items.map((item, n) => html`<li key=${n}>${inline(item)}</li>`)}</ul>`;
  }
  return html`<p key=${key}>${inline(parts)}</p>`;
}

/** @param {Inline[]} parts */
const inline = (parts) => parts.map(({ kind, text }, n) => {
  if (kind === "strong") return html`<strong key=${n}>${text}</strong>`;
  if (kind === "em") return html`<em key=${n}>${text}</em>`;
  return kind === "code" ? html`<code key=${n}>${text}</code>` : text;
});
