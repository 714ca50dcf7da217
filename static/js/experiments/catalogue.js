// The experiments that the server offers.
import { computed } from "@preact/signals";
import { presetOf } from "../selectors.js";
import { options } from "../store.js";

/** @import { ExperimentKind } from "../types.js" */

/** Every kind of experiment, robots by the names of their presets. @type {{ value: ExperimentKind[] }} */
export const experiments = computed(() =>
  (options.value?.experiments ?? []).map((kind) => {
    const robots = kind.defaults.robots.map((robot) => presetOf(robot) ?? "");
    return { ...kind, defaults: { ...kind.defaults, name: "", robots } };
  }),
);

/** The kind of a name, else the first. @type {(name: string) => ExperimentKind} */
export const experimentOf = (name) =>
  experiments.value.find((one) => one.name === name) ?? experiments.value[0];
