// The findings of a summary: figures and tables, claims, conclusions, trials left out and method. It asks the server
// for nothing, so that the report that opens without one has the same.
import { count, duration, whole } from "../../../js/format.js";
import { simulatorTitle } from "../../../js/titles.js";
import { html } from "../../../js/components/elements.js";
import { AtAGlance, Claims, FairClocks, Narrative, Versus } from "./findings.js";
import { ResultPanels } from "./result.js";
import { TwoSettings } from "./two-settings.js";

/** @import { Setting, Summary } from "../../../js/types.js" */
/** @import { ComponentChildren } from "preact" */

/** What happens at a click on the dot of a seed. @typedef {(setting: Setting, distance_m: number) => unknown} OnSeed */

/** @import { Compare, SaveFigure } from "./two-settings.js" */
/**
 * `children` follow the figure; `more` are further rows of the method.
 * @param {{
 *   summary: Summary, onSeed?: OnSeed | null, more?: [string, ComponentChildren][], children?: ComponentChildren,
 *   compare: Compare, firstPair?: string[] | null, saveFigure?: SaveFigure | null
 * }} props
 */
export function Findings({
  summary, onSeed = null, more = [], children, compare, firstPair = null, saveFigure = null,
}) {
  return html`
    <${LeftOut} trials=${summary.trials} />
    <${ResultPanels} summary=${summary} onSeed=${onSeed} />
    ${children}
    <${TwoSettings} summary=${summary} compare=${compare} first=${firstPair} saveFigure=${saveFigure} />
    ${!summary.worlds?.length && html`<${AtAGlance} summary=${summary} />`}
    <${Versus} summary=${summary} />
    <${Claims} claims=${summary.claims ?? []} isComplete=${summary.trials.done >= summary.trials.total} />
    <${Narrative} parts=${summary.story ?? []} />
    <${FairClocks} summary=${summary} />
    <${Method} summary=${summary} more=${more} />
  `;
}

// ---- trials without a distance, with the reasons

/** @param {{ trials: Summary["trials"] }} props */
function LeftOut({ trials }) {
  const aside = trials.set_aside ?? [];
  const failures = trials.failures ?? [];
  // Summaries of earlier versions count those that were set aside apart.
  const failed = Math.max(trials.failed, failures.length + aside.length);
  if (!failed) return null;
  const counts = [
    `${whole(failed)} of ${count(trials.total, "trial")} failed`,
    aside.length && `${aside.length} of them set aside`,
  ];
  return html`
    <section class="panel left-out" aria-labelledby="left-out">
      <h2 id="left-out">Left out: ${counts.filter(Boolean).join(", ")}</h2>
      <p class="dim">
        A trial is set aside when it has killed its worker three times, or cannot be run. All others are in the figures.
      </p>
      <details class="more">
        <summary>Which, and why</summary>
        <ul>
          ${failures.map(({ label, key, reason }) => html`
            <li>${label ?? key} failed: <span class="dim">${reason}</span></li>
          `)}
          ${aside.map(({ label, key, reason }) => html`
            <li>${label ?? key} was set aside: <span class="dim">${reason}</span></li>
          `)}
        </ul>
      </details>
    </section>
  `;
}

// ---- what is needed to repeat it: seeds, versions, machine and time

/** @param {(string | 0 | false | null | undefined)[]} parts */
const joined = (parts) => parts.filter(Boolean).join(", ");

/** @param {Summary} summary */
const simulatorOf = ({ config, versions = {} }) => {
  const version = config.simulator === "mujoco" ? versions.mujoco : null;
  return [simulatorTitle(config.simulator), version].filter(Boolean).join(" ");
};

/** @param {Summary} summary */
const versionsOf = ({ versions = {} }) =>
  joined(Object.entries(versions).filter(([name]) => name !== "mujoco").map(([name, version]) => `${name} ${version}`));

/** @param {Summary} summary */
const machineOf = ({ machine = {} }) => joined([machine.platform, machine.cores && count(machine.cores, "core")]);

/** @param {{ cost: Summary["cost"] }} summary */
const timeOf = ({ cost }) =>
  cost && joined([
    cost.wall_s && duration(cost.wall_s), cost.compute_s && `${duration(cost.compute_s)} of computing`,
    cost.trials_per_s && `${cost.trials_per_s.toPrecision(3)} trials a second`,
    cost.workers && count(cost.workers, "worker"),
  ]);

/** @param {Summary} summary */
const trialsOf = ({ trials: { done, total, failed, set_aside = [] } }) =>
  `${whole(done)} of ${whole(total)} done, ${whole(failed)} failed, ${whole(set_aside.length)} set aside`;

const STATISTICS = `Interquartile means with stratified bootstrap percentile intervals (2000 resamples; the gaits are
  the strata where they are taken together); shares with Wilson intervals; no correction for how many comparisons there
  are.`;

/** @param {{ summary: Summary, more: [string, ComponentChildren][] }} props */
function Method({ summary, more }) {
  const { seeds, seed } = summary.config;
  const rows = [
    ["Seeds", `${count(seeds, "seed")}, spawned from ${seed}`],
    ["Trials", trialsOf(summary)],
    ["Simulator", simulatorOf(summary)],
    ["Versions", versionsOf(summary)],
    ["Machine", machineOf(summary)],
    ["Time", timeOf(summary)],
    ["Statistics", STATISTICS],
    ...more,
  ];
  return html`
    <section class="panel making" aria-labelledby="making">
      <h2 id="making">Method</h2>
      <dl>
        ${rows.filter(([, value]) => value !== undefined && value !== null).map(([name, value]) => html`
          <div><dt>${name}</dt><dd>${value}</dd></div>
        `)}
      </dl>
    </section>
  `;
}
