// One sentence about the field of the form that is touched.
import { signal } from "@preact/signals";
import { html } from "../../html.js";
import { sentenceFor } from "../setting-help.js";

const touched = signal("seeds");

export const help = (field) => () => (touched.value = field);

export const Help = () => html`<p class="setting-help" aria-hidden="true">${sentenceFor(touched.value)}</p>`;
