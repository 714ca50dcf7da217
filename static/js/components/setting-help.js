// The help sentence of a setting: visible for the one in use, for screen readers at each.
import { signal } from "@preact/signals";
import { agentOf } from "../agents.js";
import { form } from "../form.js";
import { html } from "../html.js";
import { options } from "../store.js";

export const helpFor = (field) => options.value?.help[field] ?? "";

/** The field whose help is visible, and its words where the field alone does not tell them. */
const shown = signal({ field: "gait", words: "" });

export const showHelp = (field, words = "") => () => (shown.value = { field, words });

/** The sentence that a field's `aria-describedby` names. */
export const Description = ({ field, id = field, words = helpFor(field) }) =>
  html`<span class="sr-only" id=${`help-${id}`}>${words}</span>`;

/** The help of the field in use; of the gait and the learner, the description of the one that is chosen. */
export function SettingHelp() {
  const { field, words } = shown.value;
  const { gait, agent } = form.value;
  const chosen = {
    gait: options.value?.gaits.find(({ name }) => name === gait)?.description,
    agent: agentOf(agent).description,
  };
  return html`<p class="setting-help" aria-hidden="true">${words || chosen[field] || helpFor(field)}</p>`;
}
