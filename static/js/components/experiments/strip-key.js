// The legend of a dot strip.
import { html } from "../../html.js";

const TYPICAL = html`
  <line class="interval" x1="2" x2="18" y1="8" y2="8" /><line class="typical" x1="10" x2="10" y1="3" y2="13" />
`;
const SIGNS = {
  seed: ["one seed", html`<circle class="dot-of-seed" cx="10" cy="8" r="3.5" />`],
  typical: ["interquartile mean, 95 % interval", TYPICAL],
  greedy: ["greedy", html`<line class="mark greedy" x1="10" x2="10" y1="0" y2="16" />`],
  published: ["the paper", html`<path class="mark published" d="M10 2 16 8 10 14 4 8z" />`],
};

const Sign = ({ name }) => html`
  <span><svg class="dots" width="20" height="16" aria-hidden="true">${SIGNS[name][1]}</svg>${SIGNS[name][0]}</span>
`;

export const StripKey = ({ signs = Object.keys(SIGNS), color }) => html`
  <p class="strip-key" style=${color && { "--agent": color }}>${signs.map((name) => html`<${Sign} name=${name} />`)}</p>
`;
