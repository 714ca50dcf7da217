// What is known of the form's robot and gait before anything runs, below their choice.
import { useEffect } from "preact/hooks";
import { isReadOnly } from "../form.js";
import { followPreview, inWords, moveLeg, objections, preview, takeBetter } from "../preview.js";
import { html } from "./elements.js";

/** @import { Preview } from "../types.js" */

/**
 * `hasPlan`: with a drawing of the robot from above. `isEdited`: its legs are buttons that move to another group.
 * @param {{ hasPlan: boolean, isEdited: boolean }} props
 */
export function Beforehand({ hasPlan, isEdited }) {
  useEffect(followPreview, []);
  const { answer, error, again } = preview.value;
  if (error && !again) return html`<p class="mistake" role="alert">${error.message}</p>`;
  if (!answer) return html`<p class="dim">Asking how it would stand…</p>`;
  const { better } = answer;
  return html`
    <div class="beforehand" role="group" aria-label="Known before it walks">
      ${isEdited ? html`<${Groups} known=${answer} />` : hasPlan && html`<${Plan} known=${answer} />`}
      <div>
        ${isEdited && html`<p><b>Groups</b> A press on a leg moves it to the next group.</p>`}
        <p class="dim">${inWords(answer)}</p>
        ${objections(answer).map((objection) => html`<p class="notice" role="status">${objection}</p>`)}
        ${better && html`
          <button class="link" onClick=${() => takeBetter(answer)}>Take groups with which it stands</button>
        `}
      </div>
    </div>
  `;
}

/** @param {{ known: Preview }} props */
function Groups({ known }) {
  const { legs } = known;
  const farthest = Math.max(...legs.flatMap(({ home_m }) => home_m.map(Math.abs)));
  /** @param {number} share */
  const place = (share) => `${50 + (REACH * share) / farthest}%`;
  return html`
    <div class="group-picker" role="group" aria-label="Groups of legs">
      <svg viewBox="-50 -50 100 100" aria-hidden="true">
        ${legs.map(({ leg, group, home_m: [right, forward] }) => html`
          <path key=${leg} class=${`pair-${(group % 6) + 1}`}
            d=${`M0 0L${(REACH * right) / farthest} ${(-REACH * forward) / farthest}`} />
        `)}
        <ellipse class="body" rx="9" ry="12" />
        <path class="forward" d="M0 -7 4 1.5 H-4z" />
      </svg>
      ${legs.map(({ leg, group, home_m: [right, forward] }) => html`
        <button key=${leg} class=${`pair-${(group % 6) + 1}`} style=${{ left: place(right), top: place(-forward) }}
          aria-label=${`Leg ${leg}, in group ${group + 1}: move it to the next`} disabled=${isReadOnly.value}
          onClick=${() => moveLeg(known, leg)}>${leg}</button>
      `)}
    </div>
  `;
}

/** Of 50 from the middle to the edge. */
const REACH = 40;

/** From the middle of the drawing to its edge. */
const EDGE = 29;
const FOOT = 3.2;
/** Where a leg begins, of the way from the middle to its foot: across and along. */
const HIP = [0.3, 0.55];

/** The robot from above, forward up, with its feet at home; legs of a group have one colour. */
/** @param {{ known: Preview }} props */
function Plan({ known: { legs } }) {
  const farthest = Math.max(...legs.flatMap(({ home_m }) => home_m.map(Math.abs)));
  const scale = (EDGE - FOOT - 1) / farthest;
  return html`
    <svg class="glyph" viewBox="-29 -29 58 58" aria-hidden="true">
      ${legs.map(({ leg, group, home_m: [right, forward] }) => {
        const [x, y] = [scale * right, -scale * forward];
        return html`
          <g class=${`pair pair-${(group % 6) + 1}`} key=${leg}>
            <path class="leg" d=${`M${HIP[0] * x} ${HIP[1] * y}L${x} ${y}`} />
            <circle class="foot" cx=${x} cy=${y} r=${FOOT} />
          </g>
        `;
      })}
      <ellipse class="body" rx="8" ry="9" />
      <path class="forward" d="M0 -5.2 3.6 1.2 H-3.6z" />
    </svg>
  `;
}
