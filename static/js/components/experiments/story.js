// What the reader sees, in words; the numbers are this run's.
import { html } from "../../html.js";

export const Story = ({ parts }) => parts.length > 0 && html`
  <section class="panel story" aria-label="What this shows">
    ${parts.map(({ heading, text }) => html`<h2>${heading}</h2>${text.split("\n\n").map((one) => html`<p>${one}</p>`)}`)}
  </section>
`;
