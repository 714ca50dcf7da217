// Numbers one types: a count, or a list with commas. What is wrong holds the button back, and is said.
import { useState } from "preact/hooks";
import { refusals } from "../../actions.js";
import { html } from "../../html.js";
import { options } from "../../store.js";
import { sentenceFor } from "../setting-help.js";
import { help } from "./experiment-help.js";
import { mistakes, say, setMistake, values } from "../../experiments/form.js";

const WHOLE = new Set(["steps", "steps_per_episode", "divisions"]);

function Typed({ field, label, text, parse, inputmode = "decimal" }) {
  const [draft, setDraft] = useState(null);
  const mistake = mistakes.value[field];
  const isRefused = refusals("experiment").includes(field);
  const onInput = ({ target }) => {
    setDraft(target.value);
    const { value, wrong } = parse(target.value);
    setMistake(field, wrong ?? null);
    if (!wrong) say(field, value);
  };
  const onBlur = () => {
    setDraft(null);
    setMistake(field, null);
  };
  return html`
    <div class="field" onFocusIn=${help(field)} onPointerEnter=${help(field)}>
      <label for=${`experiment-${field}`}>${label}</label>
      <span class="number">
        <input type="text" inputmode=${inputmode} id=${`experiment-${field}`} value=${draft ?? text}
          aria-invalid=${mistake || isRefused ? "true" : undefined}
          aria-describedby=${mistake ? `wrong-${field}` : `about-${field}`} onInput=${onInput} onBlur=${onBlur} />
        ${mistake && html`<span class="mistake" role="alert" id=${`wrong-${field}`}>${mistake}</span>`}
      </span>
      <span class="sr-only" id=${`about-${field}`}>${sentenceFor(field)}</span>
    </div>
  `;
}

/** A whole number. */
export function CountField({ field, label, low, high = Infinity }) {
  const parse = (typed) => {
    const value = /^\d+$/.test(typed.trim()) ? Number(typed) : NaN;
    const range = high === Infinity ? `at least ${low}` : `from ${low} to ${high.toLocaleString("en")}`;
    return value >= low && value <= high ? { value } : { wrong: `A whole number, ${range}` };
  };
  return html`<${Typed} field=${field} label=${label} text=${String(values.value[field])} parse=${parse} inputmode="numeric" />`;
}

/** One number, or several with commas between. */
export function NumbersField({ field, label }) {
  const [low, high] = options.value?.limits?.[field] ?? [null, null];
  const parse = (typed) => {
    const found = typed.split(",").map((part) => (part.trim() === "" ? NaN : Number(part)));
    if (found.some((one) => !Number.isFinite(one))) return { wrong: "Numbers with commas between" };
    if (WHOLE.has(field) && !found.every(Number.isInteger)) return { wrong: "Whole numbers" };
    if (found.some((one) => (low !== null && one < low) || (high !== null && one > high))) return { wrong: `Each ${high === null ? `at least ${low}` : `from ${low} to ${high}`}` };
    if (new Set(found).size < found.length) return { wrong: "Each number once" };
    return { value: found };
  };
  return html`<${Typed} field=${field} label=${label} text=${values.value[field].join(", ")} parse=${parse} />`;
}
