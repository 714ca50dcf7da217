// What people say of a run: its name, tags and notes, each changed in its place.
import { signal } from "@preact/signals";
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { annotate } from "../../actions.js";
import { openDetails } from "../../run-details.js";
import { filters, setFilters } from "../../run-list.js";
import { folded } from "../../runs.js";
import { mayChange } from "../../selectors.js";
import { served } from "../../store.js";
import { html, Icon } from "../elements.js";

/** @import { Changed, Run } from "../../types.js" */

/** @typedef {"name" | "tags" | "notes"} AnnotatedField */

/** Field being changed: the id of a run and the field's name; null if none is. */
const edited = signal(/** @type {{ id: string, field: string } | null} */ (null));

/** Change a field of a run where it stands. @param {Run} run @param {AnnotatedField} field */
export const editHere = (run, field) => (edited.value = { id: run.id, field });

/** Change a field of a run, among its details. @param {Run} run @param {AnnotatedField} field */
export function edit(run, field) {
  openDetails(run.id);
  editHere(run, field);
}

/** @param {Run} run @param {AnnotatedField} field */
export const isEdited = (run, field) => edited.value?.id === run.id && edited.value?.field === field;

/** @type {Record<AnnotatedField, string>} */
const VERBS = { name: "Rename", tags: "Change the tags", notes: "Change the notes" };

/** @param {{ run: Run, field: AnnotatedField }} props */
const EditButton = ({ run, field }) => mayChange(run) && html`
  <button class="quiet square small" id=${`edit-${field}`} aria-label=${VERBS[field]} title=${VERBS[field]}
    onClick=${() => edit(run, field)}><${Icon} name="edit" /></button>
`;

/** `title`: what stands there while it is not changed. @param {{ run: Run, title: string }} props */
export function Name({ run, title }) {
  if (isEdited(run, "name")) return html`<${EditorOf} run=${run} field="name" />`;
  return html`<h2>${title}</h2><${EditButton} run=${run} field="name" />`;
}

/** @param {{ run: Run }} props */
export function Tags({ run }) {
  const tags = run.tags ?? [];
  if (isEdited(run, "tags")) return html`<${EditorOf} run=${run} field="tags" />`;
  if (tags.length === 0) return html`<${Invitation} run=${run} field="tags" words="Add tags" />`;
  /** @param {string} tag */
  const isChosen = (tag) => folded(tag) === folded(filters.value.tag);
  return html`
    <div class="tags" role="group" aria-label="Tags">
      ${tags.map((tag) => html`
        <button key=${tag} class="tag-chip" aria-pressed=${isChosen(tag) ? "true" : "false"}
          title=${isChosen(tag) ? "Show runs without it too" : "Show only runs with this tag"}
          onClick=${() => setFilters({ tag: isChosen(tag) ? "" : tag })}>${tag}</button>
      `)}
      <${EditButton} run=${run} field="tags" />
    </div>
  `;
}

/** @param {{ run: Run, field: AnnotatedField, words: string }} props */
const Invitation = ({ run, field, words }) => mayChange(run) && html`
  <button class="secondary compact add" id=${`edit-${field}`} onClick=${() => edit(run, field)}>${words}</button>
`;

/** @param {{ run: Run }} props */
export function Notes({ run }) {
  const notes = run.notes ?? "";
  if (isEdited(run, "notes")) return html`<${EditorOf} run=${run} field="notes" />`;
  if (!notes) return html`<${Invitation} run=${run} field="notes" words="Add notes" />`;
  return html`
    <div class="kept-notes">
      <h3>Notes <${EditButton} run=${run} field="notes" /></h3>
      <p class="notes">${notes}</p>
    </div>
  `;
}

/** @param {string} text */
const splitTags = (text) => text.split(",").map((tag) => tag.trim()).filter(Boolean);

/**
 * The editor of a field. `opener`: the id of what has the focus after it.
 * @param {{ run: Run, field: AnnotatedField, opener?: string }} props
 */
export function EditorOf({ run, field, opener = `edit-${field}` }) {
  const { name, tags = [], notes = "" } = run;
  const of = {
    name: { label: "Name", text: name, read: String },
    tags: { label: "Tags, with commas between", text: tags.join(", "), read: splitTags },
    notes: { label: "Notes", text: notes ?? "", read: String },
  }[field];
  const [, maximum] = field === "tags" ? [] : served().limits[field];
  /** @param {string} text */
  const save = (text) => annotate(run, { [field]: of.read(text) });
  return html`
    <${Editor} label=${of.label} text=${of.text} maximum=${maximum} save=${save} isLong=${field === "notes"}
      opener=${opener} />
  `;
}

/**
 * A field in the place of what it changes. Enter saves, in notes with Ctrl; Escape leaves all as it was.
 * @param {object} props
 * @param {string} props.label
 * @param {string} props.text
 * @param {number | null} [props.maximum]
 * @param {(text: string) => unknown} props.save
 * @param {boolean} props.isLong
 * @param {string} props.opener
 */
function Editor({ label, text, maximum, save, isLong, opener }) {
  const [draft, setDraft] = useState(text);
  const input = useRef(/** @type {any} */ (null));
  // Before anything can be typed, which would be selected too.
  useLayoutEffect(() => {
    input.current?.focus();
    input.current?.select();
  }, []);
  const close = () => {
    edited.value = null;
    // The field has the focus, and goes.
    requestAnimationFrame(() => document.getElementById(opener)?.focus());
  };
  /** @param {Event} event */
  const submit = async (event) => {
    event.preventDefault();
    const isSaved = draft === text || (await save(draft));
    // Not if another text is edited by now.
    if (isSaved && input.current) close();
  };
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    if (event.key === "Escape") close();
    else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) submit(event);
  };
  const shared = {
    ref: input, value: draft, "aria-label": label, maxlength: maximum ?? undefined, onKeyDown,
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
