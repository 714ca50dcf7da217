// One sentence about every setting: on screen for the one that is touched, to screen readers for each.
import { signal } from "@preact/signals";
import { form } from "../form.js";
import { html } from "../html.js";
import { options } from "../store.js";

const touched = signal("gait");

/** Until the server says its own. */
const SENTENCES = {
  gait: "Which two legs move together, and which way is forward.",
  steps: "How many steps the learner practises before it races; the paper took 500 and 1,000.",
  seed: "Start of all chance: the same seed and settings give the same run, to the last bit.",
  observation: "Whether the robot feels where its feet are, or trusts where it sent them.",
  alpha: "Learning rate: how much of what a step taught replaces what was believed before.",
  gamma: "Discount: how much the steps that follow count against the next one.",
  epsilon_start: "Exploration: the share of random moves at first; it falls while it practises.",
  epsilon_end: "Exploration: the share of random moves in the last episode.",
  epsilon: "Exploration right now: the share of random moves.",
  steps_per_episode: "Exploration stays the same for so many steps, then falls.",
  evaluate_every: "After so many steps what was learned is tried out for 50 steps; 0 is never.",
  pace: "As fast as the computer can, or a number of times real time; slow paces can be steered.",
  robot: "Servos and ground: stiff servos, compliant ones, or a slippery floor.",
  simulator: "Full physics with MuJoCo, or the ideal law of walking without slip.",
  divisions: "Points along a side of the square of places where a foot may go.",
  grid_side_m: "Side of that square, in metres.",
  race_steps: "How many steps each robot has in the race.",
  lanes: "Who races, one lane each.",
  seeds: "How often each setting is tried, each time with other luck.",
  gaits: "Which gaits are tried.",
  robots: "Which robots are tried.",
  observations: "Whether the robot feels where its feet are, or trusts where it sent them.",
  agents: "Who learns, or looks ahead, and is compared with the others.",
  name: "What this run is called in the list of runs.",
};

export const sentenceFor = (field) => options.value?.help?.[field] ?? SENTENCES[field] ?? "";
export const showHelp = (field) => () => (touched.value = field);

/** The sentence that a field's `aria-describedby` names. */
export const Description = ({ field, id = field }) =>
  html`<span class="sr-only" id=${`help-${id}`}>${sentenceFor(field)}</span>`;

/** What is touched, in a sentence; of the gait, which it is. */
export function SettingHelp() {
  const gait = options.value?.gaits?.find(({ name }) => name === form.value.gait);
  const words = touched.value === "gait" ? gait?.description ?? sentenceFor("gait") : sentenceFor(touched.value);
  return html`<p class="setting-help" aria-hidden="true">${words}</p>`;
}
