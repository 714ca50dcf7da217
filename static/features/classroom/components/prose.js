// A text of a lesson's card.
import { html } from "../../../js/components/elements.js";

/** The server makes it of Markdown, without HTML of the author's. @param {{ text: string }} props */
export const Prose = ({ text }) => html`<div class="prose" dangerouslySetInnerHTML=${{ __html: text }}></div>`;
