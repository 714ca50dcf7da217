// The report's conclusions in prose, written by the server from this run's numbers.
import { html } from "../../html.js";

export const Story = ({ parts }) => parts.length > 0 && html`
  <section class="panel story" aria-label="What this shows">
    ${parts.map(({ heading, text }) => html`
      <h2>${heading}</h2>
      ${text.split("\n\n").map((paragraph) => html`<p>${paragraph}</p>`)}
    `)}
  </section>
`;
