// The experiments that there are, what each is for, and what one may say of it.
import { computed } from "@preact/signals";
import { options } from "../store.js";

const COMMON = ["seeds", "seed", "gaits", "observations", "robots", "simulator"];
/** What a sweep may vary of the practice, as lists of numbers. */
export const GRID = [
  "steps", "alpha", "gamma", "epsilon_start", "epsilon_end", "steps_per_episode", "divisions", "grid_side_m",
];
const GAITS = ["left-right-origin", "left-right-vertical", "front-back-origin", "front-back-vertical"];
const PAPER = {
  seeds: 30, seed: 0, gaits: GAITS, observations: ["measured", "commanded"], robots: ["stiff"],
  simulator: "mujoco", agents: ["q-learning"], steps: [500], alpha: [0.3], gamma: [0.9],
  epsilon_start: [1], epsilon_end: [0], steps_per_episode: [50], divisions: [2], grid_side_m: [0.04],
};

/** Until the server says its own. */
const KNOWN = [
  {
    name: "table1", title: "Table 1", fields: COMMON,
    help: "Four gaits after 500 and 1,000 steps, against greedy and two-step: the paper’s race, many times over.",
    defaults: { ...PAPER, robots: ["stiff", "compliant"], steps: [500, 1000] },
  },
  {
    name: "figure4", title: "Figure 4", fields: [...COMMON, "agents"],
    help: "How far it gets after each 250 steps of practice, up to 2,000.",
    defaults: { ...PAPER, steps: [250] },
  },
  {
    name: "sweep", title: "Sweep", fields: [...COMMON, "agents", ...GRID],
    help: "Any grid of rates, grids and agents: the tuning that the paper leaves to others.",
    defaults: { ...PAPER, observations: ["measured"] },
  },
];

/** [{name, title, help, fields, defaults}] */
export const experiments = computed(() => {
  const served = options.value?.experiments ?? [];
  return KNOWN.map((known) => {
    const own = served.find(({ name }) => name === known.name) ?? {};
    return { ...known, ...own, help: own.description ?? known.help, defaults: { ...known.defaults, ...plain(own.defaults) } };
  });
});

export const experimentOf = (name) => experiments.value.find((one) => one.name === name) ?? experiments.value[0];

/** Robots by name, as the form has them. */
const plain = (defaults = {}) =>
  defaults.robots ? { ...defaults, robots: defaults.robots.map((robot) => robot.preset ?? robot) } : defaults;
