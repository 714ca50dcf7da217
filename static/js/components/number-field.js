// A number one types: it takes effect as soon as it is one, and says what is wrong until then.
import { useState } from "preact/hooks";
import { refusedFields } from "../actions.js";
import { mistakes, setMistake } from "../form.js";
import { html } from "../html.js";
import { options } from "../store.js";

const LIMITS = {
  steps: [1, 1e7], alpha: [0, 1], gamma: [0, 1], epsilon_start: [0, 1], epsilon_end: [0, 1],
  seed: [0, null], divisions: [2, 8], grid_side_m: [0.005, 10], evaluate_every: [0, 1e7],
  steps_per_episode: [1, 1e7], race_steps: [1, 1e7],
};
const WHOLE = new Set([
  "steps", "seed", "divisions", "evaluate_every", "steps_per_episode", "race_steps",
]);

const limitsOf = (field) =>
  options.value?.limits?.[field] ?? LIMITS[field] ?? [null, null];

/** What is wrong with a number, or null. */
function mistakeIn(field, value) {
  const [low, high] = limitsOf(field);
  const range = high === null ? `at least ${low}` : `from ${low} to ${high.toLocaleString("en")}`;
  if (!Number.isFinite(value)) return `A number, ${range}`;
  if (WHOLE.has(field) && !Number.isInteger(value)) return `A whole number, ${range}`;
  if ((low !== null && value < low) || (high !== null && value > high)) return `It must be ${range}`;
  if (field === "alpha" && value === 0) return "It must be over 0";
  if (field === "gamma" && value === 1) return "It must be under 1";
  return null;
}

const shownAs = (value) => String(Number(value.toPrecision(8)));

/** `label` is for screen readers where no <label> names the field. */
export function NumberField({ field, value, onValue, step = 1, label, isDisabled = false }) {
  const [draft, setDraft] = useState(null);
  const mistake = mistakes.value[field];
  const isRefused = refusedFields.value.includes(field);

  const onInput = ({ target }) => {
    const typed = target.value.trim() === "" ? NaN : Number(target.value);
    const wrong = mistakeIn(field, typed);
    setDraft(target.value);
    setMistake(field, wrong);
    if (!wrong) onValue(typed);
  };
  const onBlur = () => {
    setDraft(null);
    setMistake(field, null);
  };
  return html`
    <span class="number">
      <input type="number" inputmode="decimal" id=${`field-${field}`} value=${draft ?? shownAs(value)}
        step=${step} disabled=${isDisabled} aria-label=${label}
        aria-invalid=${mistake || isRefused ? "true" : undefined}
        aria-describedby=${mistake ? `mistake-${field}` : `help-${field}`}
        onInput=${onInput} onBlur=${onBlur} />
      ${mistake && html`<span class="mistake" role="alert" id=${`mistake-${field}`}>${mistake}</span>`}
    </span>
  `;
}
