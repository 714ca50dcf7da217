// The help sentence of the field in use.
import { signal } from "@preact/signals";
import { html } from "../../html.js";
import { helpFor } from "../setting-help.js";

const helpField = signal("seeds");

export const help = (field) => () => (helpField.value = field);

export const Help = () => html`<p class="setting-help" aria-hidden="true">${helpFor(helpField.value)}</p>`;
