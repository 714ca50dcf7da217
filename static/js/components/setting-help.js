// The help sentence of a setting: visible for the one in use, for screen readers at each.
import { signal } from "@preact/signals";
import { form } from "../form.js";
import { html } from "../html.js";
import { options } from "../store.js";

/** The field whose help is visible. */
const helpField = signal("gait");

export const helpFor = (field) => options.value?.help[field] ?? "";
export const showHelp = (field) => () => (helpField.value = field);

/** The sentence that a field's `aria-describedby` names. */
export const Description = ({ field, id = field }) =>
  html`<span class="sr-only" id=${`help-${id}`}>${helpFor(field)}</span>`;

/** The help of the field in use; of the gait, the description of the one that is chosen. */
export function SettingHelp() {
  const gait = options.value?.gaits.find(({ name }) => name === form.value.gait);
  const words = (helpField.value === "gait" && gait?.description) || helpFor(helpField.value);
  return html`<p class="setting-help" aria-hidden="true">${words}</p>`;
}
