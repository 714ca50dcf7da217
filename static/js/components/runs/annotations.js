// Annotations of a run: its name, tags and notes, each changed in its place.
import { signal } from "@preact/signals";
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { annotate } from "../../actions.js";
import { filters, setFilters } from "../../run-list.js";
import { folded } from "../../runs.js";
import { isOperator } from "../../selectors.js";
import { served } from "../../store.js";
import { html, Icon } from "../elements.js";

/** @import { Changed, Run } from "../../types.js" */
/** @import { ComponentChildren } from "preact" */

/** Field being changed: the id of a run and the field's name; null if none is. */
const edited = signal(/** @type {{ id: string, field: string } | null} */ (null));

/**
 * Change a field of a run in its place.
 * @param {Run} run
 * @param {"name" | "tags" | "notes"} field
 */
export const edit = (run, field) => (edited.value = { id: run.id, field });

/** @param {Run} run @param {"name" | "tags" | "notes"} field */
const isEdited = (run, field) => edited.value?.id === run.id && edited.value?.field === field;

/** @param {{ run: Run, title: string, aside: ComponentChildren }} props */
export function Name({ run, title, aside }) {
  if (isEdited(run, "name")) {
    /** @param {string} name */
    const save = (name) => annotate(run, { name });
    return html`<${Editor} label="Name" text=${title} maximum=${served().limits.name[1]} save=${save} />`;
  }
  return html`
    <p class="run-name">
      <b role="heading" aria-level="3">${title}</b>
      ${aside && html`<span class="dim">${aside}</span>`}
      ${isOperator.value && html`
        <button class="quiet square small" aria-label=${`Rename ${title}`} title="Rename"
          onClick=${() => edit(run, "name")}><${Icon} name="edit" /></button>
      `}
    </p>
  `;
}

/** @param {string} text */
const splitTags = (text) => text.split(",").map((tag) => tag.trim()).filter(Boolean);

/** @param {{ run: Run }} props */
export function Tags({ run }) {
  const tags = run.tags ?? [];
  if (isEdited(run, "tags")) {
    /** @param {string} text */
    const save = (text) => annotate(run, { tags: splitTags(text) });
    return html`<${Editor} label="Tags, with commas between" text=${tags.join(", ")} save=${save} />`;
  }
  if (tags.length === 0) return null;
  /** @param {string} tag */
  const isChosen = (tag) => folded(tag) === folded(filters.value.tag);
  return html`
    <p class="tags" role="group" aria-label="Tags">
      ${tags.map((tag) => html`
        <button key=${tag} class="chip" aria-pressed=${isChosen(tag) ? "true" : "false"}
          title=${isChosen(tag) ? "Show runs without it too" : "Show only runs with this tag"}
          onClick=${() => setFilters({ tag: isChosen(tag) ? "" : tag })}>${tag}</button>
      `)}
    </p>
  `;
}

/** @param {{ run: Run }} props */
export function Notes({ run }) {
  const notes = run.notes ?? "";
  if (isEdited(run, "notes")) {
    /** @param {string} text */
    const save = (text) => annotate(run, { notes: text });
    return html`
      <${Editor} label="Notes" text=${notes} maximum=${served().limits.notes[1]} save=${save} isLong />
    `;
  }
  if (!notes) return null;
  const [first, ...others] = notes.split("\n");
  if (others.length === 0) return html`<p class="notes">${notes}</p>`;
  return html`<details class="notes"><summary>${first}</summary><p>${others.join("\n")}</p></details>`;
}

/**
 * A field in the place of what it changes. Enter saves, in notes with Ctrl; Escape leaves all as it was.
 * @param {{ label: string, text: string, maximum: number, save: (text: string) => unknown, isLong?: boolean }} props
 */
function Editor({ label, text, maximum, save, isLong = false }) {
  const [draft, setDraft] = useState(text);
  const field = useRef(/** @type {HTMLInputElement | null} */ (null));
  // Before anything can be typed, which would be selected too.
  useLayoutEffect(() => {
    field.current?.focus();
    field.current?.select();
  }, []);
  const close = () => {
    const row = field.current?.closest(".run");
    edited.value = null;
    // The field has the focus, and goes.
    /** @type {HTMLElement | null | undefined} */
    const menu = row?.querySelector("summary.square");
    requestAnimationFrame(() => menu?.focus());
  };
  /** @param {Event} event */
  const submit = async (event) => {
    event.preventDefault();
    const isSaved = draft === text || (await save(draft));
    // Not if another text is edited by now.
    if (isSaved && field.current) close();
  };
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    if (event.key === "Escape") close();
    else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) submit(event);
  };
  const shared = {
    ref: field, value: draft, "aria-label": label, maxlength: maximum ?? undefined, onKeyDown,
    onInput: (/** @type {Changed} */ { target }) => setDraft(target.value),
  };
  return html`
    <form class="in-place" onSubmit=${submit}>
      ${isLong ? html`<textarea rows="3" ...${shared}></textarea>` : html`<input type="text" ...${shared} />`}
      <button class="secondary compact">Save</button>
      <button type="button" class="quiet compact" onClick=${close}>Cancel</button>
    </form>
  `;
}
