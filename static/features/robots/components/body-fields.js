// The numbers of a body: of the chosen leg, of all legs at once, or of the torso.
import {
  body, boxTorso, chosenLeg, first, followerOf, impossibleAt, isMirrored, part, shownFields, shownIn, slideTo,
  typeIn, valuesOf,
} from "../body-editor.js";
import { extentOf, isBox } from "../body.js";
import { shareOf } from "../../../js/scale.js";
import { html, Mistake, Segments } from "../../../js/components/elements.js";
import { NumberInput } from "../../../js/components/fields.js";

/** @import { Body } from "../body.js" */
/** @import { Changed, SettingOption } from "../../../js/types.js" */

const STEP_M = 0.001;
const HALF_TURN_DEG = 180;

export function BodyFields() {
  const words = part.value === "leg" ? impossibleAt(chosenLeg.value) : "";
  return html`
    <${Segments} label="What to change" value=${part.value} onValue=${(/** @type {any} */ name) => (part.value = name)}
      choices=${[["leg", `Leg ${chosenLeg.value}`], ["all", "All legs"], ["torso", "Torso"]]} />
    ${words && html`<p class="mistake" role="alert">${words}</p>`}
    ${part.value === "leg" && html`<p class="sentence">${followerInWords()}</p>`}
    <div class="sliders">
      ${shownFields().map(([field, setting]) => html`
        <${Row} key=${`${part.value} ${field}`} field=${field} setting=${setting} />
      `)}
    </div>
    ${part.value === "torso" && body.value && !isBox(body.value) && html`
      <button class="link" onClick=${boxTorso}>Make it a box</button>
    `}
  `;
}

/** Which leg follows the chosen one. */
function followerInWords() {
  const follower = followerOf(chosenLeg.value);
  if (!isMirrored.value) return "It changes alone.";
  if (follower === null) return "It has no mirror image: it changes alone.";
  if (follower === chosenLeg.value) return "It stands on the axis, and stays there.";
  return `Leg ${follower} follows, mirrored.`;
}

/** The ends of a slider: as far as the picture goes at first; the text field takes what the server does. */
/** @param {SettingOption} setting */
function endsOf({ unit, minimum, maximum }) {
  if (unit === "°") return { min: -HALF_TURN_DEG, max: HALF_TURN_DEG, step: 1 };
  const extent = extentOf(/** @type {Body} */ (first.value));
  return { min: Math.max(minimum ?? -extent, -extent), max: Math.min(maximum ?? extent, extent), step: STEP_M };
}

/** @param {{ field: string, setting: SettingOption }} props */
function Row({ field, setting }) {
  const { title, unit, help } = setting;
  const { min, max, step } = endsOf(setting);
  const { text, mistake } = shownIn(field);
  const values = valuesOf(field);
  const [value = min] = values;
  const reached = Math.min(Math.max(value ?? min, min), max);
  const listed = values.map((number) => Number(number?.toFixed(3))).join(", ");
  const differ = values.length > 1 ? `They differ: ${listed}. ` : "";
  const id = `body-${field}`;
  return html`
    <div class="slider">
      <label for=${`${id}-slide`}>${title}</label>
      <input type="range" id=${`${id}-slide`} min=${min} max=${max} step=${step} value=${reached}
        style=${{ "--share": `${100 * shareOf(reached, min, max)}%` }} aria-describedby=${`${id}-help`}
        onInput=${(/** @type {Changed} */ { target }) => slideTo(field, Number(target.value))} />
      <${NumberInput} setting=${setting} value=${values.length > 1 ? null : value} text=${text} step=${step}
        isWrong=${mistake !== null} label=${`${title}, as a number`}
        onText=${(/** @type {string} */ typed) => typeIn(field, typed)}
        attributes=${{
          id, "aria-invalid": mistake ? "true" : undefined,
          "aria-describedby": mistake ? `${id}-mistake ${id}-help` : `${id}-help`,
        }} />
      <span class="unit">${unit}</span>
      <${Mistake} id=${`${id}-mistake`}>${mistake}<//>
      <p class=${differ ? "sentence" : "sr-only"} id=${`${id}-help`}>${differ}${help}</p>
    </div>
  `;
}
