// The placeholder of a chart or table without data: a sketch, and a sentence on what will fill it.
import { html } from "../html.js";

const CURVE = html`
  <svg viewBox="0 0 320 110" preserveAspectRatio="none" aria-hidden="true">
    <path class="rule" d="M0 109H320M0 73H320M0 37H320" />
    <path class="sketch" d="M0 108C60 98 80 62 140 50S230 28 320 22" />
  </svg>
`;
const LINES = html`
  <svg viewBox="0 0 320 110" preserveAspectRatio="none" aria-hidden="true">
    <path class="rule" d="M0 109H320M0 73H320M0 37H320" />
    <path class="sketch" d="M0 108 210 20" /><path class="sketch" d="M0 108 230 32" />
    <path class="sketch" d="M0 108H40L48 102H92L100 96H144L152 90H196L204 84H248L256 78H300" />
  </svg>
`;
const CELLS = html`
  <div class="sketch-cells" aria-hidden="true">${Array.from({ length: 15 }, () => html`<i></i>`)}</div>
`;

const SHAPES = { curve: CURVE, lines: LINES, cells: CELLS };

export const Empty = ({ words, shape = "curve" }) => html`
  <div class=${`empty ${shape}`}>
    ${SHAPES[shape]}
    <p>${words}</p>
  </div>
`;
