// The view of lessons: those of the server, and the editor of the one that is being made.
import { useEffect } from "preact/hooks";
import { lessonFile } from "../api.js";
import { wantDialog } from "../../../js/features.js";
import {
  askForRoom, edit, importFile, lessonInWords, lessons, problem, refresh, remove, takeRestored,
} from "../lessons/list.js";
import { begin, draft } from "../lessons/draft.js";
import { isOperator } from "../../../js/selectors.js";
import { Deletions } from "../../../js/components/deletions.js";
import { html, Icon } from "../../../js/components/elements.js";
import { Editor } from "./editor.js";

/** @import { ListedLesson } from "../../../js/types.js" */

export function Lessons() {
  useEffect(() => {
    wantDialog("rooms");
    refresh();
  }, []);
  return html`
    <div class=${`lessons ${draft.value ? "editing" : ""}`}>
      ${draft.value && isOperator.value ? html`<${Editor} />` : html`<${List} />`}
    </div>
  `;
}

function List() {
  const all = lessons.value;
  return html`
    <section class="panel lesson-list" aria-labelledby="lessons-title">
      <div class="list-head">
        <h2 id="lessons-title">Lessons</h2>
        ${isOperator.value && html`
          <button class="secondary compact" onClick=${() => begin()}>New lesson</button>
          <${ImportButton} />
        `}
      </div>
      <p class="dim">Cards that a class goes through together in a room, or that a link opens on this page.</p>
      <div role="alert">${problem.value && html`<p class="problem">${problem}</p>`}</div>
      <${Deletions} kind="lessons" take=${takeRestored} />
      ${all === null ? !problem.value && html`<p role="status">Loading the lessons…</p>` : html`
        <ul>${all.map((lesson) => html`<${Row} key=${lesson.id} lesson=${lesson} />`)}</ul>
      `}
    </section>
  `;
}

function ImportButton() {
  const onChange = (/** @type {any} */ { target }) => {
    if (target.files?.[0]) importFile(target.files[0]);
    target.value = "";
  };
  return html`
    <label class="file-button" title="A lesson as a YAML or JSON file">
      <${Icon} name="import" /><span>Import…</span>
      <input class="sr-only" type="file" accept=".yaml,.yml,.json" onChange=${onChange} />
    </label>
  `;
}

/** @param {{ lesson: ListedLesson }} props */
function Row({ lesson }) {
  const { id, title, aims, is_built_in } = lesson;
  return html`
    <li>
      <h3>${title}</h3>
      <p class="dim">${lessonInWords(lesson)}${is_built_in ? " · built in" : " · made here"}</p>
      ${aims.length > 0 && html`<ul class="aims">${aims.map((aim) => html`<li key=${aim}>${aim}</li>`)}</ul>`}
      <div class="lesson-deeds">
        ${isOperator.value && html`
          <button class="secondary compact" onClick=${() => askForRoom(id)} aria-label=${`Teach: ${title}`}>
            Teach…
          </button>
        `}
        <a class="quiet button" href=${`l/${id}`} aria-label=${`Open here: ${title}`}>Open here</a>
        ${isOperator.value && html`
          <button class="quiet" onClick=${() => edit(id)} aria-label=${`Edit a copy: ${title}`}>Edit a copy</button>
        `}
        ${isOperator.value && html`
          <a class="quiet button" href=${`l/${id}/sheet`} target="_blank"
            aria-label=${`Sheet for the teacher: ${title}`}>Sheet</a>
        `}
        <a class="quiet button" href=${lessonFile(id)} download="" aria-label=${`YAML file: ${title}`}>YAML</a>
        ${isOperator.value && !is_built_in && html`
          <button class="quiet" onClick=${() => remove(id, title)} aria-label=${`Delete: ${title}`}>Delete</button>
        `}
      </div>
    </li>
  `;
}
