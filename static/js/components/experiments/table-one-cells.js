// The cells of Table 1: our seeds as a strip under their middle, and what the paper has.
import { count } from "../../format.js";
import { html } from "../../html.js";
import { agentOf } from "../../selectors.js";
import { bare, inUnit, shown } from "../../experiments/units.js";
import { largest } from "../../scale.js";
import { DotStrip } from "../dot-strip.js";

/** `measure`: {ours, paper, high}: the factors of the unit, and where the axis ends. */
export function LearnerCell({ setting, distance, greedy, measure }) {
  const ours = setting[distance];
  const label = `${agentOf(setting.agent).title}, ${count(setting.steps, "step")}`;
  if (!ours || measure.ours === null) return html`<td role="cell" data-label=${label} class="learner empty-cell"><span class="dim">waits for its first seed</span></td>`;
  const inOurs = (metres) => inUnit(metres, measure.ours);
  const printed = inUnit(setting.published?.[`${distance}_m`] ?? null, measure.paper);
  const typical = { iqm: inOurs(ours.iqm_m), low: inOurs(ours.low_m), high: inOurs(ours.high_m) };
  const points = ours.points_m.map(inOurs);
  const line = inOurs(greedy?.[distance]?.mean_m ?? null);
  const marks = [
    line !== null && { value: line, kind: "greedy" },
    printed !== null && { value: printed, kind: "published" },
  ].filter(Boolean);
  const interval = typical.low === null ? "" : `${bare(typical.low)} – ${bare(typical.high)}`;
  const words = [
    `${count(points.length, "seed")} from ${shown(-largest(points.map((one) => -one), -Infinity))} to ${shown(largest(points, -Infinity))}`,
    `typically ${shown(typical.iqm)}${interval && `, 95 % interval ${interval}`}`,
    line !== null && `greedy ${shown(line)}`, printed !== null && `the paper ${shown(printed)}`,
  ].filter(Boolean).join("; ");
  return html`
    <td role="cell" class="learner" data-label=${label}>
      <p class="cell-words num"><b>${shown(typical.iqm)}</b> <span class="dim">${interval}</span></p>
      <${DotStrip} label=${words} points=${points} high=${measure.high} typical=${typical} marks=${marks} color=${agentOf(setting.agent).color} />
      <${Printed} value=${printed} quantile=${setting.published?.[`${distance}_quantile`]} />
    </td>
  `;
}

const Printed = ({ value, quantile }) => value !== null && html`
  <p class="printed dim num">paper ${shown(value)}${quantile !== null && quantile !== undefined && `, above ${Math.round(100 * quantile)} % of seeds`}</p>
`;

/** An agent that looks ahead does the same each time. */
export function ReferenceCell({ title, setting, distance, measure }) {
  const ours = inUnit(setting?.[distance]?.mean_m ?? null, measure.ours);
  const printed = inUnit(setting?.published?.[`${distance}_m`] ?? null, measure.paper);
  const isUnfinished = setting?.published && setting.published[`${distance}_m`] === null;
  return html`
    <td role="cell" data-label=${title} class="reference num">
      <b>${shown(ours)}</b>
      ${printed !== null && html`<span class="dim printed">paper ${shown(printed)}</span>`}
      ${isUnfinished && html`<span class="dim printed">paper: unfinished</span>`}
    </td>
  `;
}
