// How the report was made, so that another can make it again.
import { count, duration } from "../../format.js";
import { html } from "../../html.js";

export function Making({ known }) {
  const { config, versions = {}, machine = {}, cost } = known;
  const rows = [
    ["Seeds", `${count(config.seeds, "seed")}, spawned from ${config.seed}`],
    ["Simulator", config.simulator === "mujoco" ? `MuJoCo ${versions.mujoco ?? ""}` : "ideal, without slip"],
    ["Versions", Object.entries(versions).filter(([name]) => name !== "mujoco").map(([name, one]) => `${name} ${one}`).join(", ")],
    ["Machine", [machine.platform, machine.cores && count(machine.cores, "core")].filter(Boolean).join(", ")],
    cost && ["Time", [cost.wall_s && duration(cost.wall_s), cost.trials_per_s && `${cost.trials_per_s.toPrecision(3)} trials a second`, cost.workers && count(cost.workers, "worker")].filter(Boolean).join(", ")],
  ].filter(Boolean);
  return html`
    <section class="panel making" aria-labelledby="making">
      <h2 id="making">How it was made</h2>
      <dl>${rows.map(([name, value]) => html`<div><dt>${name}</dt><dd>${value}</dd></div>`)}</dl>
    </section>
  `;
}
