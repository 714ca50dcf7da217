// A small answer of GET /options, and runs and stages to put into the store.

/** @import { Options, Run, SettingOption, Stage } from "../../static/js/types.js" */

/** @type {(name: string, title?: string) => { name: string, title: string, description: string }} */
const described = (name, title = name) => ({ name, title, description: `About ${name}.` });

const SETTING = {
  title: "", symbol: null, quantity: null, unit: null, help: "", valid: "a number", minimum: null, maximum: null,
  excludes_minimum: false, excludes_maximum: false, is_number: true, is_boolean: false,
  is_whole: false, choices: [], choice_titles: [], default: null, is_live: false,
};
/** @type {(title: string, changes: object) => SettingOption} */
export const setting = (title, changes) => ({ ...SETTING, title, ...changes });

/** @type {(title: string, symbol: string, changes: object) => SettingOption} */
const share = (title, symbol, changes) => setting(title, { symbol, minimum: 0, maximum: 1, ...changes });

const ALPHA = share("Learning rate", "α", { default: 0.3, excludes_minimum: true, is_live: true });
const LEARNER = {
  alpha: ALPHA,
  gamma: share("Discount", "γ", { default: 0.9, excludes_maximum: true, is_live: true }),
  epsilon_start: share("Initial exploration", "ε", { quantity: "exploration", default: 1 }),
  epsilon_end: share("Final exploration", "ε", { quantity: "exploration", default: 0 }),
};
const EPSILON = share("Exploration now", "ε", { is_live: true });
const TRACER = {
  alpha: { ...ALPHA, default: 0.1 },
  trace: share("Trace decay", "λ", { default: 0.9, is_live: true }),
  kind: setting("Kind of trace", { default: "replacing", choices: ["replacing", "adding"], is_number: false }),
};

/** @type {(title: string, changes: object) => import("../../static/js/types.js").FieldOption} */
const field = (title, changes) =>
  ({ ...setting(title, changes), short: "", is_list: false, is_required: false, ranges: null, ...changes });
const STEP_FIELDS = {
  at_step: field("Begins at step", { minimum: 0, is_whole: true, default: 0 }),
  until_step: field("Ends at step", { minimum: 1, is_whole: true }),
};
const LEGS = field("Legs", { minimum: 1, maximum: 12, is_whole: true, is_list: true, is_required: true });
const DIRECTION = field("Direction", { minimum: -180, maximum: 180, unit: "°", default: 0 });
const NUMBER = { minimum: 0, is_required: true };
/** @type {Record<string, string>} */
const SHORT = { at_step: "at", until_step: "until" };
/** @param {object} fields */
const withNames = (fields) => Object.fromEntries(
  Object.entries(fields).map(([name, declaration]) => [name, { ...declaration, short: SHORT[name] ?? name }]));
/** @type {(name: string, title: string, fields: object, more?: object) => any} */
const kind = (name, title, fields, more = {}) =>
  ({ ...described(name, title), fields: withNames({ ...fields, ...STEP_FIELDS }), repairs: false, adjective: name,
    size: null, nothing: 0, lasts: true,
    identified_by: [], part: [], simulators: ["mujoco"], ...more });
const KINDS = [
  kind("limp", "Limp legs", { legs: LEGS }, { identified_by: ["legs"], part: ["power"] }),
  kind("stuck", "Stuck joint", {
    leg: field("Leg", { minimum: 1, maximum: 12, is_whole: true, is_required: true }),
    joint: field("Joint", { is_number: false, choices: ["coxa", "femur"], is_required: true }),
    angle_rad: field("Angle", {
      minimum: -1.5, maximum: 1.5, unit: "rad", is_required: true,
      ranges: { field: "joint", ranges: { coxa: [-1.2, 1.2], femur: [-1.5, 1.5] } },
    }),
  }, { identified_by: ["leg", "joint"] }),
  kind("lost", "Lost legs", { legs: LEGS }, { identified_by: ["legs"] }),
  kind("weak", "Weak servos", {
    legs: LEGS, torque_share: field("Share of torque", { ...NUMBER, maximum: 1 }),
  }, { size: "torque_share", nothing: 1, identified_by: ["legs"], part: ["power"] }),
  kind("repair", "Repaired legs", { legs: LEGS },
    { identified_by: ["legs"], repairs: true, adjective: "repaired" }),
  kind("slope", "Slope", {
    degrees: field("Slope", { ...NUMBER, maximum: 30, unit: "°" }), direction_deg: DIRECTION,
  }, { size: "degrees" }),
  kind("friction", "Friction", { value: field("Friction", { minimum: 0.01, maximum: 5, is_required: true }) },
    { size: "value", nothing: "friction" }),
  kind("patch", "Patch", {
    from_m: field("From", { ...NUMBER, unit: "m" }), to_m: field("To", { ...NUMBER, unit: "m" }),
    friction: field("Friction", NUMBER),
  }, { size: "friction", nothing: null, identified_by: ["from_m", "to_m"] }),
  kind("push", "Push", {
    impulse_ns: field("Impulse", { ...NUMBER, maximum: 20, unit: "N·s" }), direction_deg: DIRECTION,
  }, { size: "impulse_ns", lasts: false }),
  kind("sensor-noise", "Sensor noise", {
    sd_m: field("Standard deviation", { ...NUMBER, maximum: 0.05, unit: "m" }),
  }, { size: "sd_m", simulators: ["mujoco", "kinematic"] }),
];
const WORLDS = [
  { ...described("flat", "Flat ground"), disturbances: [] },
  { ...described("limp-pair", "Two limp legs"), disturbances: [{ kind: "limp", at_step: 0, legs: [1, 4] }] },
];

const TRAINING = {
  agent: "learner", gait: "tripod", steps: 500, seed: 0, observation: "measured",
  settings: { alpha: 0.3, gamma: 0.9, epsilon_start: 1, epsilon_end: 0 }, steps_per_episode: 50, evaluate_every: 50,
  robot: "stiff", simulator: /** @type {const} */ ("mujoco"),
  divisions: 2, grid_side_m: 0.04, tolerance: 0, reward: "forward", disturbances: [],
};

const GRID = ["steps", "alpha", "gamma", "epsilon_start", "epsilon_end", "trace", "kind"];
/** What an experiment has that sweeps over settings. */
const SWEEP = {
  about: "About it", measure: /** @type {const} */ ("distance"), references: ["greedy"], is_timed: false,
  is_published: false, takes_settings: true, earning_steps: null, paper_gaits: {},
};
const EXPERIMENT = {
  name: "", seeds: 30, seed: 0, gaits: ["tripod", "wave"], observations: ["measured"], robots: ["stiff"],
  simulator: "mujoco", agents: ["learner"], steps: [500], steps_per_episode: [50], divisions: [2], grid_side_m: [0.04],
};
const COMMON = ["seeds", "seed", "gaits", "observations", "robots", "simulator"];

const IN_WORLDS = [...COMMON, "agents", "worlds", "tolerance", "steps", "reward"];
const EVERY_AGENT = ["learner", "tracer", "greedy", "planner"];

const SEARCH = {
  learns: false, searches: true, needs_practice: false,
  keeps_learning: false, steps_ahead: null, settings: {}, live_settings: {},
};

const BUILT_IN = { id: null, hidden: false, body: null, grid_side_m: 0.04 };
/** @param {number} legs */
const jointsOf = (legs) => Array.from({ length: legs }, () => ["coxa", "femur", "tibia"]);
/** @param {number} legs @returns {[number, number][][]} */
const limitsOf = (legs) => Array.from({ length: legs }, () => [[-1.2, 1.2], [-1.5, 1.5], [-2.8, 0]]);

/** @type {Options} */
export const OPTIONS = {
  version: "1", robots_version: 1,
  gaits: ["tripod", "wave"].map((name) => ({
    ...described(name, `The ${name}`), forward_deg: 0, azimuths_deg: [0, 60, 120, 180, 240, 300],
    pairs: [[1, 4], [2, 5], [3, 6]],
  })),
  robots: [
    {
      ...described("stiff", "Stiff"), ...BUILT_IN, joints: jointsOf(6), limits_rad: limitsOf(6),
      robot: { preset: "stiff" },
      gait: "tripod", gaits: ["tripod", "wave"], recommended_agent: { tripod: "learner", wave: "learner" },
      azimuths_deg: [0, 60, 120, 180, 240, 300], built: { friction: 1 },
    },
    {
      ...described("dog", "Dog"), ...BUILT_IN, joints: jointsOf(4), limits_rad: limitsOf(4),
      robot: { preset: "dog" }, gaits: ["wave"], recommended_agent: { wave: "tracer" },
      azimuths_deg: [-60, 60, 120, -120], built: { friction: 1 },
      gait: { right_leg: 1, left_leg: 2, groups: [[1, 3], [2, 4]] },
    },
  ],
  leg_fields: {
    x_m: setting("To the right", { minimum: -2, maximum: 2, unit: "m", default: 0.1 }),
    y_m: setting("Ahead", { minimum: -2, maximum: 2, unit: "m", default: 0 }),
    yaw_deg: setting("Points to", { minimum: -360, maximum: 360, unit: "°", default: 0 }),
    foot_out_m: setting("Foot from joint", { minimum: 0.001, maximum: 5, unit: "m", default: 0.15 }),
    femur_m: setting("Femur", { minimum: 0.001, maximum: 2, unit: "m", default: 0.08 }),
  },
  torso_fields: {
    torso_radius_m: setting("Radius", { minimum: 0.01, maximum: 2, unit: "m", default: 0.1 }),
    torso_length_m: setting("Length", { minimum: 0.02, maximum: 4, unit: "m", default: 0.2 }),
    torso_width_m: setting("Width", { minimum: 0.02, maximum: 4, unit: "m", default: 0.2 }),
  },
  tournament_fields: {
    steps: setting("Most steps of practice", { minimum: 1, maximum: 5000, is_whole: true, default: 500 }),
    draws: setting("Secret seeds", { minimum: 5, maximum: 100, is_whole: true, default: 20 }),
    transitions: setting("Most transitions", { minimum: 500, maximum: 100_000, is_whole: true, default: 40_000 }),
    entries_per_hour: setting("Entries per hour", { minimum: 1, maximum: 60, is_whole: true, default: 6 }),
  },
  agents: [
    {
      ...described("learner", "Learner"), color: "#111111", steps_ahead: null,
      learns: true, searches: false, needs_practice: true,
      keeps_learning: false, settings: LEARNER,
      live_settings: { alpha: LEARNER.alpha, gamma: LEARNER.gamma, epsilon: EPSILON },
    },
    {
      ...described("tracer", "Tracer"), color: "#444444", steps_ahead: null,
      learns: true, searches: false, needs_practice: true,
      keeps_learning: true, settings: TRACER,
      live_settings: { alpha: TRACER.alpha, trace: TRACER.trace },
    },
    { ...described("greedy", "Greedy"), color: "#222222", ...SEARCH, steps_ahead: 1 },
    {
      ...described("planner", "Planner"), color: "#333333", ...SEARCH,
      settings: { depth: setting("Depth", { minimum: 1, maximum: 5, is_whole: true, default: 3 }) },
    },
  ],
  worlds: WORLDS,
  disturbances: KINDS,
  simulators: [described("mujoco", "MuJoCo physics"), described("kinematic", "ideal (no slip)")],
  observations: [described("measured"), described("commanded")],
  clocks: [described("paper", "paper clock"), described("wall", "real clock"), described("free", "no clock")],
  experiments: [
    {
      ...described("table1", "Table 1"), ...SWEEP, references: ["greedy", "two-step"], is_timed: true,
      is_published: true, takes_settings: false, paper_gaits: { wave: "The-Wave" },
      fields: COMMON, grid: [], defaults: { ...EXPERIMENT, steps: [500, 1000] },
      simulator_defaults: { mujoco: {}, kinematic: {} }, agents: [],
    },
    {
      ...described("figure4", "Figure 4"), ...SWEEP, measure: /** @type {const} */ ("blocks"), takes_settings: false,
      fields: [...COMMON, "agents"], grid: [], defaults: { ...EXPERIMENT, steps: [250] },
      simulator_defaults: { mujoco: {}, kinematic: {} }, agents: ["learner"],
    },
    {
      ...described("sweep", "Sweep"), ...SWEEP,
      fields: [...COMMON, "agents", ...GRID], grid: GRID, defaults: EXPERIMENT,
      simulator_defaults: { mujoco: {}, kinematic: {} }, agents: EVERY_AGENT,
    },
    {
      ...described("league", "League"), ...SWEEP, measure: /** @type {const} */ ("practice"), takes_settings: false,
      fields: IN_WORLDS, grid: ["steps"], agents: EVERY_AGENT,
      defaults: { ...EXPERIMENT, agents: ["learner", "planner"], worlds: ["flat", "limp-pair"], tolerance: 0.03 },
      simulator_defaults: { mujoco: {}, kinematic: { worlds: ["flat"], tolerance: 0 } },
    },
    {
      ...described("recovery", "Recovery"), ...SWEEP, measure: /** @type {const} */ ("recovery"), takes_settings: false,
      earning_steps: 50, fields: IN_WORLDS, grid: ["steps"], agents: ["learner", "tracer"],
      defaults: { ...EXPERIMENT, worlds: ["limp-pair"], tolerance: 0.03 },
      simulator_defaults: { mujoco: {}, kinematic: { worlds: ["flat"], tolerance: 0 } },
    },
  ],
  defaults: {
    training: { ...TRAINING, pace: "max" },
    race: { steps: 50, seed: 0, lanes: [{ agent: "learner" }, { agent: "greedy" }] },
    what_if: { seeds: 30 },
  },
  settings: {
    steps: setting("Practice", { minimum: 1, maximum: 10_000_000, is_whole: true, default: 500 }),
    seed: setting("Seed", { minimum: 0, is_whole: true, default: 0 }),
    grid_side_m: setting("Grid side", { minimum: 0.01, maximum: 0.1, unit: "m", default: 0.04 }),
    ...Object.fromEntries(["steps_per_episode", "evaluate_every", "divisions", "race_steps"]
      .map((name) => [name, setting(name, { minimum: 0, is_whole: true, default: 50 })])),
    keep_learning: setting("Keeps learning", { is_number: false, is_boolean: true, default: false }),
    plans_with: setting("Plans with", {
      is_number: false, choices: ["world", "start", "nominal"],
      choice_titles: ["true model", "model of the start", "nominal model"],
    }),
    observation: setting("Observation", {
      is_number: false, choices: ["measured", "commanded", "planned"],
      choice_titles: ["feet measured", "commands remembered", "feet as planned"],
      default: "measured",
    }),
    tolerance: setting("Build tolerance", { minimum: 0, maximum: 0.2, default: 0 }),
    reward: setting("Reward", {
      is_number: false, choices: ["forward", "track"], choice_titles: ["along its own heading", "along the track"],
      default: "forward",
    }),
    pace: setting("Pace", { choices: ["max"], minimum: 0.01, maximum: 1000, default: "max" }),
    ...TRACER, ...LEARNER,
  },
  limits: { seeds: [1, null], seed: [0, null], what_if_steps: [1, 2000], lanes: [1, 6], legs: [3, 12], name: [0, 20],
    tag: [1, 9], tags: [0, 3], notes: [0, 90], archive_runs: [1, 2], run_ids: [1, 2], gait_window_s: [0, 120],
    import_bytes: [1, 2 ** 20] },
  help: { alpha: "Learning rate." },
  titles: { gait: "Gait", agent: "Learner", lanes: "Lanes", name: "Name", robot: "Robot", world: "World" },
  exports: [
    { title: "Joints (CSV)", address: "joints?format=csv", method: "GET", ending: "csv", install: null },
    { title: "Joints (Parquet)", address: "joints?format=parquet", method: "GET", ending: "parquet",
      install: "pip install p" },
    { title: "Page", address: "page", method: "GET", ending: "html", install: null },
    { title: "Film", address: "film?format=mp4", method: "POST", ending: "mp4", install: null },
  ],
};

let number = 0;

/**
 * A run as the API shows it; each is newer than the one before.
 * @param {object} changes
 * @returns {Run}
 */
export function makeRun(changes) {
  number += 1;
  return /** @type {Run} */ (/** @type {unknown} */ ({
    id: `run-${String(number).padStart(4, "0")}`, kind: "training", name: null, is_named: "name" in changes,
    state: "finished",
    config: /** @type {any} */ ({ ...TRAINING, pace: "max" }),
    progress: { done: 0, total: 500 }, can_resume: false,
    created_at: new Date(Date.UTC(2030, 0, 1) + 1000 * number).toISOString(),
    ...changes,
  }));
}

/**
 * The stage that all pages share, as the API shows it; nothing is on it.
 * @param {Partial<Stage>} [changes]
 * @returns {Stage}
 */
export const makeStage = (changes = {}) => /** @type {Stage} */ ({
  run_id: null, next_run_id: null, holder: null, phase: "empty", origin: "none", playing: true, ended: false,
  speed: "time-lapse", clock: "paper", end_at_time_out: true, announced: null,
  presentation: { card: null, shows_why: false, is_blank: false, code: "large" }, sent_s: 0, version: "1",
  playhead: { at_s: 0, points: [[0, 0]], rate: 0, computed_s: 0, duration_s: null, time_out_s: null }, ...changes,
});

/**
 * A lane of the scene, at its start. Of the step that it takes less than the whole is shown.
 * @param {any} [changes]
 */
export const makeSceneLane = (changes = {}) => ({
  lane: 0, name: "Learner", color: "#111", rank: 1, distance_m: 0, step: 0, steps: 50, done: false, halted: false,
  steps_made: changes.done || changes.halted ? changes.step ?? 50 : Math.max(0, (changes.step ?? 0) - 1),
  thinking: false, futures: 0, futures_total: 0, crossed: false, marching: false, failure: null, ...changes,
});
