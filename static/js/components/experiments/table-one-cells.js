// Cells of Table 1: the seeds of this run as a strip, and the paper's value.
import { agentOf } from "../../agents.js";
import { count, percentage } from "../../format.js";
import { html } from "../../html.js";
import { bare, inUnit, shown } from "../../experiments/units.js";
import { largest } from "../../scale.js";
import { DotStrip } from "../dot-strip.js";

/** `measure`: {ours, paper, high}: factors of the unit, and the end of the axis. */
export function LearnerCell({ setting, distance, greedy, measure }) {
  const label = `${agentOf(setting.agent).title}, ${count(setting.steps, "step")}`;
  if (!setting[distance] || measure.ours === null) return html`<${EmptyCell} label=${label} />`;
  const shares = inUnits({ setting, distance, greedy, measure });
  const { typical, points, printed, marks } = shares;
  return html`
    <td role="cell" class="learner" data-label=${label}>
      <p class="cell-words num"><b>${shown(typical.iqm)}</b> <span class="dim">${intervalOf(typical)}</span></p>
      <${DotStrip} label=${captionOf(shares)} points=${points} high=${measure.high} typical=${typical} marks=${marks}
        color=${agentOf(setting.agent).color} />
      <${Published} value=${printed} quantile=${setting.published?.[`${distance}_quantile`] ?? null} />
    </td>
  `;
}

const EmptyCell = ({ label }) => html`
  <td role="cell" data-label=${label} class="learner empty-cell">
    <span class="dim">waiting for its first seed</span>
  </td>
`;

/** The distances of a cell in the chosen unit. */
function inUnits({ setting, distance, greedy, measure }) {
  const ours = setting[distance];
  const own = (metres) => inUnit(metres, measure.ours);
  const line = own(greedy?.[distance]?.mean_m ?? null);
  const printed = inUnit(setting.published?.[`${distance}_m`] ?? null, measure.paper);
  const marks = [{ value: line, kind: "greedy" }, { value: printed, kind: "published" }];
  return {
    line,
    printed,
    marks: marks.filter(({ value }) => value !== null),
    points: ours.points_m.map(own),
    typical: { iqm: own(ours.iqm_m), low: own(ours.low_m), high: own(ours.high_m) },
  };
}

const intervalOf = ({ low, high }) => (low === null ? "" : `${bare(low)} – ${bare(high)}`);

function captionOf({ points, typical, line, printed }) {
  const interval = intervalOf(typical);
  const lowest = -largest(points.map((one) => -one), -Infinity);
  return [
    `${count(points.length, "seed")} from ${shown(lowest)} to ${shown(largest(points, -Infinity))}`,
    `typically ${shown(typical.iqm)}${interval && `, 95 % interval ${interval}`}`,
    line !== null && `greedy ${shown(line)}`,
    printed !== null && `the paper ${shown(printed)}`,
  ].filter(Boolean).join("; ");
}

function Published({ value, quantile }) {
  if (value === null) return null;
  const above = quantile === null ? "" : `, above ${percentage(quantile)} of seeds`;
  return html`<p class="printed dim num">paper ${shown(value)}${above}</p>`;
}

/** Agents that look ahead do the same with every seed. */
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
