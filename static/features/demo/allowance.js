// What a visitor may still start, and what becomes of it.
import { html } from "../../js/components/elements.js";
import { count, whole } from "../../js/format.js";
import { isAway } from "../../js/store.js";
import { allowance } from "./feature.js";

export function AllowanceLine() {
  if (allowance.value === null) return null;
  const { steps_left, steps_per_hour, hours } = allowance.value;
  // Steps come back with time.
  const left = isAway.value ? "" : `: ${whole(steps_left)} of ${count(steps_per_hour, "step")} an hour left`;
  const after = hours === 24 ? "a day" : count(hours, "hour");
  return html`<p class="dim allowance">A demo${left}. What you make is public, and deleted after ${after}.</p>`;
}
