// How many trials an experiment has, before it is asked for.
import { learns } from "../selectors.js";

const RATES = ["steps", "alpha", "gamma", "epsilon_start", "epsilon_end", "steps_per_episode"];

const product = (values, fields) => fields.reduce((total, field) => total * values[field].length, 1);

/** Who learns is tried once a seed; who looks ahead once; greedy is always there to compare with. */
export function futureRuns(experiment, values) {
  const places = product(values, ["gaits", "observations", "robots", "divisions", "grid_side_m"]);
  if (experiment === "table1") return places * (2 + values.steps.length * values.seeds + 1);
  const learners = values.agents.filter(learns).length;
  const ahead = values.agents.filter((name) => !learns(name) && name !== "greedy").length;
  return places * (1 + ahead + learners * product(values, RATES) * values.seeds);
}
