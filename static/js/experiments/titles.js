// What things of an experiment are called.
import { agentOf } from "../selectors.js";
import { options } from "../store.js";
import { count, sentence } from "../format.js";
import { experimentOf } from "./catalogue.js";

export const gaitTitle = (gait) => options.value?.gaits?.find(({ name }) => name === gait)?.title ?? gait;
export const agentTitle = (name) => agentOf(name).title;
export const robotTitle = (name) => sentence(String(name));

export const OBSERVATIONS = {
  measured: ["Measured", "the robot feels where its feet are"],
  commanded: ["Commanded", "it trusts where it sent them"],
};
export const observationTitle = (name) => OBSERVATIONS[name]?.[0] ?? sentence(name);

export const FIELD_TITLES = {
  gait: "Gait", observation: "Observation", robot: "Robot", agent: "Agent", steps: "Steps", alpha: "α", gamma: "γ",
  epsilon_start: "ε at first", epsilon_end: "ε at last", steps_per_episode: "Steps an episode",
  divisions: "Divisions", grid_side_m: "Grid side, m",
};

/** A value of a setting's field, in words. */
export function valueTitle(field, value) {
  if (value === null || value === undefined) return "–";
  if (field === "gait") return gaitTitle(value);
  if (field === "agent") return agentTitle(value);
  if (field === "observation") return observationTitle(value);
  return field === "robot" ? robotTitle(value) : String(value);
}

export const runTitle = (run) => run.name || experimentOf(run.config.experiment).title;

/** What was asked for, in a line. */
export const aboutRun = ({ config }) =>
  [
    count(config.seeds, "seed"), `from seed ${config.seed}`, listOf(config.observations), listOf((config.robots ?? []).map((one) => one.preset ?? one.name ?? "own robot")),
    config.simulator === "mujoco" ? "physics" : "ideal, without slip",
  ].filter(Boolean).join(" · ");

const listOf = (items = []) => items.join(" and ");
