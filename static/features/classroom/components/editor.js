// The editor of a lesson: its title and aims, its cards, and the one that is edited beside how a phone shows it.
import { shortAddress } from "../../../js/format.js";
import { copy } from "../../../js/page.js";
import { lessonFile } from "../api.js";
import { addCard, changeLesson, chosen, draft, moveCard, removeCard } from "../lessons/draft.js";
import { linesOf, numberOf } from "../../../js/parse.js";
import { askForRoom, isBusy, leave, problem, save, saved } from "../lessons/list.js";
import { html, Icon } from "../../../js/components/elements.js";
import { CardEditor } from "./card-editor.js";
import { KnowledgeEditor } from "./knowledge-editor.js";
import { Preview } from "./preview.js";

/** @import { LessonDocument, NewLesson } from "../../../js/types.js" */

export function Editor() {
  const lesson = /** @type {LessonDocument} */ (draft.value);
  return html`
    <section class="panel about-lesson" aria-labelledby="editor-title">
      <div class="list-head">
        <h2 id="editor-title">Edit the lesson</h2>
        <button class="quiet compact" onClick=${leave}>Discard the draft</button>
      </div>
      <label for="lesson-title">Title</label>
      <input id="lesson-title" type="text" value=${lesson.title} maxlength="300"
        onInput=${(/** @type {any} */ { target }) => changeLesson({ title: target.value })} />
      <label for="lesson-aims">Aims, one a line</label>
      <textarea id="lesson-aims" rows="2" value=${(lesson.aims ?? []).join("\n")}
        onChange=${(/** @type {any} */ { target }) => changeLesson({ aims: linesOf(target.value) })}></textarea>
      <div class="number-rules">
        <label>Minutes
          <input type="text" inputmode="numeric" value=${lesson.minutes ?? ""}
            onChange=${(/** @type {any} */ { target }) => changeLesson({ minutes: numberOf(target.value) })} />
        </label>
        <label>Ages
          <input type="text" maxlength="100" placeholder="from 12" value=${lesson.ages ?? ""}
            onChange=${(/** @type {any} */ { target }) => changeLesson({ ages: target.value.trim() || null })} />
        </label>
      </div>
      <${KnowledgeEditor} lesson=${lesson} />
      <${CardList} lesson=${lesson} />
      <div role="alert">${problem.value && html`<p class="problem">${problem}</p>`}</div>
      <button class="primary" aria-disabled=${isBusy.value ? "true" : undefined} onClick=${save}>
        Save the lesson
      </button>
      ${saved.value && html`<${Saved} lesson=${saved.value} />`}
    </section>
    <${CardEditor} key=${chosen.value} />
    <${Preview} />
  `;
}

const CARD_DEEDS = /** @type {[string, string, () => unknown][]} */ ([
  ["Move the card up", "↑", () => moveCard(-1)], ["Move the card down", "↓", () => moveCard(1)],
  ["Remove the card", "✕", removeCard],
]);

/** @param {{ lesson: LessonDocument }} props */
const CardList = ({ lesson }) => html`
  <div class="card-list-head">
    <h3 id="cards-title">Cards</h3>
    ${CARD_DEEDS.map(([label, sign, act]) => html`
      <button key=${label} class="quiet square" aria-label=${label} title=${label} onClick=${act}>${sign}</button>
    `)}
  </div>
  <ol class="card-list" aria-labelledby="cards-title">
    ${lesson.cards.map(({ title, ask, go }, n) => html`
      <li key=${n}>
        <button aria-pressed=${n === chosen.value ? "true" : "false"} onClick=${() => (chosen.value = n)}>
          <span>${n + 1}. ${title || "Untitled card"}</span>
          <span class="dim">${[ask?.kind, go].filter(Boolean).join(" · ")}</span>
        </button>
      </li>
    `)}
  </ol>
  <button class="secondary compact" onClick=${addCard}>Add a card</button>
`;

/** What can be done with a lesson that is stored. @param {{ lesson: NewLesson }} props */
const Saved = ({ lesson }) => html`
  <div class="saved-lesson" role="status">
    ${lesson.qr_code && html`<img src=${lesson.qr_code} alt=${`QR code of ${lesson.link}`} />`}
    <div>
      <p><b>Saved.</b> Its link opens it on this page, where nothing is locked.</p>
      <p class="address">${shortAddress(lesson.link)}</p>
      <div class="row">
        <button class="secondary compact" onClick=${() => copy(lesson.link, "Link copied.")}>
          <${Icon} name="link" />Copy the link
        </button>
        <a class="secondary compact button" href=${lessonFile(lesson.id)} download=""><${Icon} name="import" />YAML</a>
        <button class="secondary compact" onClick=${() => askForRoom(lesson.id)}>Teach…</button>
      </div>
    </div>
  </div>
`;
