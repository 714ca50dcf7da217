// Seeds, versions, machine and time of an experiment: what is needed to repeat it.
import { count, duration } from "../../format.js";
import { html } from "../../html.js";
import { simulatorTitle } from "../../titles.js";

const joined = (parts) => parts.filter(Boolean).join(", ");

/** @import { Summary } from "../../types.js" */

/** @param {Summary} known */
const simulatorOf = ({ config, versions = {} }) => {
  const version = config.simulator === "mujoco" ? versions.mujoco : null;
  return [simulatorTitle(config.simulator), version].filter(Boolean).join(" ");
};

/** @param {Summary} known */
const versionsOf = ({ versions = {} }) =>
  joined(Object.entries(versions).filter(([name]) => name !== "mujoco").map(([name, version]) => `${name} ${version}`));

/** @param {Summary} known */
const machineOf = ({ machine = {} }) => joined([machine.platform, machine.cores && count(machine.cores, "core")]);

const timeOf = ({ cost }) =>
  cost && joined([
    cost.wall_s && duration(cost.wall_s),
    cost.trials_per_s && `${cost.trials_per_s.toPrecision(3)} trials a second`,
    cost.workers && count(cost.workers, "worker"),
  ]);

export function Making({ known }) {
  const { seeds, seed } = known.config;
  const rows = [
    ["Seeds", `${count(seeds, "seed")}, spawned from ${seed}`],
    ["Simulator", simulatorOf(known)],
    ["Versions", versionsOf(known)],
    ["Machine", machineOf(known)],
    ["Time", timeOf(known)],
  ];
  return html`
    <section class="panel making" aria-labelledby="making">
      <h2 id="making">How it was made</h2>
      <dl>
        ${rows.filter(([, value]) => value !== undefined && value !== null).map(([name, value]) => html`
          <div><dt>${name}</dt><dd>${value}</dd></div>
        `)}
      </dl>
    </section>
  `;
}
