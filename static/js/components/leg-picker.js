// A drawn hexapod, forward up, each leg of which is a button.
import { html, pointAt } from "./elements.js";

const FOOT = 37;
const HIP = 13;
const KNEE = 24;

/**
 * @param {object} props
 * @param {number[]} props.azimuths of the legs from forward [°]
 * @param {Map<number, string>} props.states what happened to legs, by their numbers
 * @param {(leg: number) => void} props.onLeg
 * @param {boolean} [props.isDisabled]
 * @param {string} [props.describedBy]
 * @param {(leg: number) => string} props.verbOf what a press does to a leg: "Repair"
 */
export function LegPicker({ azimuths, states, onLeg, isDisabled = false, describedBy, verbOf }) {
  const legs = azimuths.map((azimuth, n) => ({ azimuth, leg: n + 1, state: states.get(n + 1) }));
  return html`
    <div class="leg-picker" role="group" aria-label="Legs, seen from above"
      aria-describedby=${describedBy}>
      <svg viewBox="-50 -50 100 100" aria-hidden="true">
        ${legs.map(({ azimuth, leg, state }) => html`
          <path key=${leg} class=${`drawn-leg ${classOf(state)}`}
            d=${`M${pointAt(azimuth, HIP)} L${pointAt(azimuth, KNEE)} L${pointAt(azimuth, FOOT)}`} />
        `)}
        <circle class="body" r=${HIP} /><path class="forward" d="M0-8 6 2H-6z" />
      </svg>
      ${legs.map(({ azimuth, leg, state }) => {
        const [x, y] = pointAt(azimuth, FOOT).map((part) => `${50 + Number(part)}%`);
        return html`
          <button key=${leg} type="button" style=${{ left: x, top: y }} aria-pressed=${state ? "true" : "false"}
            aria-disabled=${isDisabled ? "true" : undefined} title=${`${verbOf(leg)} leg ${leg}`}
            aria-label=${`Leg ${leg}${state ? `, ${state}` : ""}`} onClick=${() => !isDisabled && onLeg(leg)}>
            ${leg}
          </button>
        `;
      })}
    </div>
  `;
}

/** A leg is drawn by the last thing that happened to it. @param {string | undefined} state */
export const classOf = (state) => (state ? state.split(" ").at(-1) : "");
