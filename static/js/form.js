// What the form asks for, and the same as an address: a link carries everything.
import { computed, signal } from "@preact/signals";

const text = { read: (word) => word, write: (value) => value };
const number = {
  read: (word) => (word.trim() === "" || !Number.isFinite(Number(word)) ? undefined : Number(word)),
  write: String,
};
const pace = {
  read: (word) => (word === "max" ? "max" : number.read(word)),
  write: String,
};
const names = {
  read: (word) => word.split(",").filter(Boolean),
  write: (list) => list.join(","),
};

/** Every field, in the order of the address. */
const FIELDS = {
  gait: text, steps: number, seed: number, observation: text,
  alpha: number, gamma: number, epsilon_start: number, epsilon_end: number,
  steps_per_episode: number, evaluate_every: number, pace,
  robot: text, simulator: text, divisions: number, grid_side_m: number,
  race_steps: number, lanes: names, name: text,
};

/** The defaults of the paper, until the server says its own. */
let defaults = {
  gait: "left-right-origin", steps: 500, seed: 0, observation: "measured",
  alpha: 0.3, gamma: 0.9, epsilon_start: 1, epsilon_end: 0,
  steps_per_episode: 50, evaluate_every: 50, pace: "max",
  robot: "stiff", simulator: "mujoco", divisions: 2, grid_side_m: 0.04,
  race_steps: 50, lanes: ["q-learning", "greedy", "two-step"], name: "",
};

export const form = signal(defaults);
/** Fields whose number is no number yet, with what is wrong: they hold the button back. */
export const mistakes = signal({});

export const set = (field, value) => {
  form.value = { ...form.value, [field]: value };
  writeAddress();
};

export const setMistake = (field, message) => {
  const { [field]: _, ...others } = mistakes.value;
  mistakes.value = message ? { ...others, [field]: message } : others;
};

const isTouched = computed(() =>
  Object.keys(FIELDS).some((field) => written(form.value, field) !== written(defaults, field)),
);

const written = (values, field) => FIELDS[field].write(values[field]);

/** Begin with the server's defaults. */
export function useDefaults({ defaults: served = {}, gaits = [] }) {
  const { training = {}, race = {} } = served;
  const robot = training.robot?.preset ?? training.robot ?? defaults.robot;
  const own = Object.fromEntries(
    Object.keys(FIELDS).filter((f) => training[f] !== undefined).map((f) => [f, training[f]]),
  );
  const lanes = race.lanes?.map((lane) => lane.agent);
  defaults = {
    ...defaults, ...own, robot, name: "",
    gait: training.gait ?? gaits[0]?.name ?? defaults.gait,
    race_steps: race.steps ?? defaults.race_steps,
    lanes: lanes?.length ? lanes : defaults.lanes,
  };
  form.value = defaults;
}

/** The whole form as a query. */
const query = () =>
  new URLSearchParams(Object.keys(FIELDS).filter((f) => written(form.value, f) !== "")
    .map((field) => [field, written(form.value, field)]));

/** Take over what the address says; what it does not say, or says badly, stays as it is. */
export function readAddress() {
  const given = new URLSearchParams(location.search);
  const read = {};
  for (const [field, { read: parse }] of Object.entries(FIELDS)) {
    const value = given.has(field) ? parse(given.get(field)) : undefined;
    if (value !== undefined) read[field] = value;
  }
  form.value = { ...form.value, ...read };
}

/** The address follows the form; a form as it came keeps a clean one. */
export function writeAddress() {
  const search = isTouched.value ? `?${query()}` : "";
  history.replaceState(history.state, "", `${location.pathname}${search}${location.hash}`);
}

export const link = () => `${location.origin}${location.pathname}?${query()}${location.hash}`;

const walk = ({ gait, robot, simulator, divisions, grid_side_m, name }) => ({
  gait, robot, simulator, divisions, grid_side_m, ...(name.trim() ? { name: name.trim() } : {}),
});

/** What is learned, and how; a training that goes on keeps its seed. */
function practice(values, continueFrom) {
  const { steps, seed, observation, alpha, gamma, pace } = values;
  const { epsilon_start, epsilon_end, steps_per_episode, evaluate_every } = values;
  return {
    steps, observation, alpha, gamma, epsilon_start, epsilon_end, steps_per_episode,
    evaluate_every, pace, ...(continueFrom ? { continue_from: continueFrom } : { seed }),
  };
}

export const trainingBody = (values, continueFrom = null) =>
  ({ ...walk(values), ...practice(values, continueFrom) });

/** What ideal robots are to try: the practice, without what only this one run has. */
export function whatIfBody(values) {
  const { gait, robot, divisions, grid_side_m, steps, observation, alpha, gamma } = values;
  const { epsilon_start, epsilon_end, steps_per_episode } = values;
  return {
    gait, robot, divisions, grid_side_m, steps, observation, alpha, gamma, epsilon_start, epsilon_end,
    steps_per_episode,
  };
}

/**
 * A race in which whoever learns practises first, goes on from `continueFrom`, or uses `table`.
 * @param learns tells whether an agent does
 */
export const raceBody = (values, learns, { continueFrom = null, table = null } = {}) => ({
  ...walk(values),
  steps: values.race_steps,
  seed: values.seed,
  lanes: values.lanes.map((agent) => {
    if (!learns(agent)) return { agent };
    if (table) return { agent, training_id: table };
    return { agent, training: practice(values, continueFrom) };
  }),
});
