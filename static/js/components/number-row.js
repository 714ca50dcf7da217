// A number in a row: its name, a text field, a slider where both limits are known, and a sentence below.
import { shareOf } from "../scale.js";
import { sliderOf } from "../settings.js";
import { html } from "./elements.js";

/** @import { Parsed } from "../parse.js" */
/** @import { Changed, Limits } from "../types.js" */

/**
 * @param {object} props
 * @param {string} props.id of the text field
 * @param {string} props.label
 * @param {Limits} props.limits
 * @param {boolean} props.isWhole
 * @param {string} props.text as it was typed
 * @param {Parsed<number | null>} props.parsed its value, or why it is none
 * @param {string} props.words below it, while it is valid
 * @param {(text: string) => unknown} props.onText
 */
export function NumberRow({ id, label, limits, isWhole, text, parsed, words, onText }) {
  const slider = sliderOf({ ...limits, is_whole: isWhole });
  const at = parsed.value ?? slider?.min ?? 0;
  const { mistake } = parsed;
  const onInput = (/** @type {Changed} */ { target }) => onText(target.value);
  return html`
    <div class="may-row">
      <label for=${id}>${label}</label>
      <input id=${id} type="text" inputmode=${isWhole ? "numeric" : "decimal"} autocomplete="off" value=${text}
        onInput=${onInput} aria-invalid=${mistake ? "true" : undefined} aria-describedby=${`about-${id}`} />
      ${slider && html`
        <input type="range" min=${slider.min} max=${slider.max} step=${slider.step} value=${at} aria-label=${label}
          style=${{ "--share": `${100 * shareOf(at, slider.min, slider.max)}%` }} onInput=${onInput} />
      `}
      <p id=${`about-${id}`} class=${mistake ? "bad" : "dim"} role=${mistake ? "alert" : undefined}>
        ${mistake ?? words}
      </p>
    </div>
  `;
}
