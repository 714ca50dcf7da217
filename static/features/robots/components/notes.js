// Sentences on a robot from a file, folded.
import { html } from "../../../js/components/elements.js";

/** @param {{ title: string, sentences: string[], isOpen?: boolean }} props */
export const Notes = ({ title, sentences, isOpen = false }) => sentences.length > 0 && html`
  <details class="told" open=${isOpen}>
    <summary>${title}: ${sentences.length}</summary>
    <ul>${sentences.map((sentence) => html`<li key=${sentence}>${sentence}</li>`)}</ul>
  </details>
`;
