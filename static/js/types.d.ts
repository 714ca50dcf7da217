/** The objects of the REST API and of the event stream, as far as the page reads them. */

export type Kind = "training" | "race" | "experiment";
export type State = "queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted";
export type Verb = "stop" | "pause" | "resume";
export type Clock = string;
/** Of a number; null where the server sets no bound. */
export interface Limits {
  minimum: number | null;
  maximum: number | null;
  /** Whether the minimum itself is not valid. */
  excludes_minimum: boolean;
  excludes_maximum: boolean;
}

export type SettingValue = string | number | boolean | null;

/** A setting as the server declares it. */
export interface SettingOption extends Limits {
  title: string;
  symbol: string | null;
  /** The part of the title that the symbol stands for; null if it is all of it. */
  quantity: string | null;
  unit: string | null;
  help: string;
  /** The valid values in words. */
  valid: string;
  is_number: boolean;
  is_boolean: boolean;
  is_whole: boolean;
  /** The valid words, if only certain words are valid. */
  choices: string[];
  /** Their titles, in their order. */
  choice_titles: string[];
  default: SettingValue;
  /** Whether it may change while a training runs. */
  is_live: boolean;
}

// ---- GET /options

export interface Described {
  name: string;
  title?: string;
  description: string;
}

export interface Gait extends Described {
  title: string;
  forward_deg: number;
  azimuths_deg: number[];
  /** Legs that move together, numbered from 1. */
  pairs: [number, number][];
}

export interface Agent extends Described {
  title: string;
  color: string;
  learns: boolean;
  /** Whether it plans with a simulator. */
  searches: boolean;
  needs_practice: boolean;
  keeps_learning: boolean;
  /** By name, in the order of their declaration. */
  settings: Record<string, SettingOption>;
  /** Those that may change while it learns. */
  live_settings: Record<string, SettingOption>;
}

/** A field of a kind of disturbance; of a list, the declaration of each of its values. */
export interface FieldOption extends SettingOption {
  is_list: boolean;
  is_required: boolean;
  /** Narrower limits, [low, high], by what is chosen in another field. */
  ranges: { field: string; ranges: Record<string, [number, number]> } | null;
}

export interface DisturbanceKind extends Described {
  title: string;
  fields: Record<string, FieldOption>;
  /** The field that says how much happens. */
  size: string | null;
  /** The size at which nothing happens, or the part of the robot that has it; null if something always happens. */
  nothing: number | string | null;
  /** The simulators that know it. */
  simulators: string[];
}

/** Something that happens; its steps are counted from 0. */
export interface Disturbance {
  kind: string;
  at_step: number;
  until_step?: number | null;
  /** Numbers from 1. */
  legs?: number[];
  [field: string]: any;
}

export interface World extends Described {
  title: string;
  disturbances: Disturbance[];
}

export interface Robot extends Described {
  robot: RobotConfig;
  /** Parts in whose place a disturbance puts another value. */
  built: Record<string, number>;
}

export interface ExperimentKind extends Described {
  title: string;
  /** The fields that a request may contain. */
  fields: string[];
  /** Of those, the ones that take several values, each combination being one setting. */
  grid: string[];
  defaults: ExperimentValues;
  /** Simulator → the defaults that are others there. */
  simulator_defaults: Record<string, Partial<ExperimentValues>>;
  /** Those that it can compare; none where it has its own. */
  agents: string[];
}

/** A type of file that a recorded walk can be exported as. */
export interface ExportOption {
  title: string;
  address: string;
  method: "GET" | "POST";
  ending: string;
  install: string | null;
}

export interface Options {
  version: string;
  gaits: Gait[];
  robots: Robot[];
  agents: Agent[];
  worlds: World[];
  disturbances: DisturbanceKind[];
  simulators: Described[];
  observations: Described[];
  clocks: Described[];
  experiments: ExperimentKind[];
  defaults: {
    training: {
      agent: string; robot: string; simulator: string; settings: Record<string, SettingValue>;
      [field: string]: FormValue | Record<string, SettingValue>;
    };
    race: { steps: number; lanes: { agent: string }[] };
    what_if: { seeds: number };
  };
  settings: Record<string, SettingOption>;
  limits: Record<string, [number | null, number | null]>;
  help: Record<string, string>;
  /** Extras of the package that the server lacks, each with the command that installs it. */
  exports: ExportOption[];
}

// ---- the forms

export type FormValue = SettingValue | string[] | Exclude<RobotConfig, string> | Exclude<GaitConfig, string>;

/** The common fields, and the settings of the chosen learner. */
export interface FormValues {
  /** The learner. */
  agent: string;
  gait: GaitConfig;
  steps: number;
  seed: number;
  observation: string;
  steps_per_episode: number;
  evaluate_every: number;
  /** "max", or a multiple of real time. */
  pace: number | "max";
  robot: RobotConfig;
  simulator: string;
  divisions: number;
  grid_side_m: number;
  race_steps: number;
  lanes: string[];
  name: string;
  /** The name of a world. */
  world: string;
  /** Disturbances besides, as on the command line. */
  disturb: string[];
  [setting: string]: FormValue;
}

export type ExperimentValue = string | number | SettingValue[];

export interface ExperimentValues {
  name: string;
  seeds: number;
  seed: number;
  gaits: string[];
  observations: string[];
  robots: string[];
  simulator: string;
  agents: string[];
  steps: number[];
  steps_per_episode: number[];
  divisions: number[];
  grid_side_m: number[];
  [field: string]: ExperimentValue;
}

// ---- runs

/** The name of a preset, or an object with a preset and what differs from it. */
export type RobotConfig = string | { preset?: string; name?: string; [part: string]: unknown };
/** The name of a gait, or its parts. */
export type GaitConfig = string | { [part: string]: unknown };

export interface LaneConfig {
  agent: string;
  training_id?: string | null;
  keep_learning?: boolean;
  /** In a run of a search always one of `world`, `start`, `nominal`. */
  plans_with?: string | null;
  /** Whether nobody asked for it. */
  plans_with_by_default?: boolean;
  observation?: string;
  /** Of the agent, if the lane has no training. */
  settings?: Record<string, any>;
}

/** Trainings, races and experiments have different fields; those of all three stand here. */
export interface RunConfig {
  agent: string;
  gait: GaitConfig;
  robot: RobotConfig;
  simulator: string;
  observation: string;
  divisions: number;
  grid_side_m: number;
  steps: number;
  seed: number;
  steps_per_episode: number;
  evaluate_every: number;
  pace: number | "max";
  /** Of the agent, by name; of an experiment, the lists of their values. */
  settings: Record<string, any>;
  continue_from?: string | null;
  /** Runs of earlier versions have none. */
  disturbances?: Disturbance[];
  /** Of a race that repeats another up to a step. */
  branch_from?: { race_id: string; step: number } | null;
  lanes: LaneConfig[];
  experiment: string;
  seeds: number;
  gaits: string[];
  observations: string[];
  robots: Exclude<RobotConfig, string>[];
  [field: string]: any;
}

export interface ClockResult {
  rank: number;
  finished_distance_m: number;
  /** When the lane has used its steps [s]. */
  elapsed_s: number;
  crossed_s: number | null;
}

export interface LaneResult {
  agent: string;
  steps: number;
  total_distance_m: number;
  decision_s: number;
  simulated_transitions: number;
  failure?: string | null;
  /** Counted from 0. */
  fell_at_step?: number | null;
  /** At its end, 90 to the left. */
  heading_deg?: number | null;
  clocks: Record<Clock, ClockResult>;
}

/** Of a training the distances, of a race the lanes, of an experiment the files. */
export interface RunResult {
  distance_m: number;
  greedy_distance_m: number;
  best_known_m?: number | null;
  /** Null for a learner that keeps no table. */
  q_table_sha256?: string | null;
  /** Counted from 0. */
  fell_at_step?: number | null;
  lanes: LaneResult[];
  files?: string[];
}

export interface Run {
  id: string;
  kind: Kind;
  name: string | null;
  state: State;
  config: RunConfig;
  queue_position?: number | null;
  progress: { done: number; total: number };
  eta_s?: number | null;
  result?: RunResult | null;
  error?: string | null;
  tags?: string[];
  notes?: string;
  can_resume: boolean;
  created_at: string;
  started_at?: string | null;
  ended_at?: string | null;
  /** The trainings that a race waits for. */
  waiting_for?: string[];
  greedy_distance_m?: number | null;
  /** Of a race. */
  best_known_m?: number | null;
  /** Of a training: what was changed while it ran. */
  changes?: Change[];
}

/** What users say of a run. */
export interface Annotations {
  name?: string;
  tags?: string[];
  notes?: string;
}

/** New values of live settings and the pace, or what happened, with the number of steps done before. */
export interface Change {
  step: number;
  disturbance?: Disturbance | null;
  pace?: number | "max" | null;
  settings?: Record<string, SettingValue>;
}

/** A run that the server cannot read. It can be deleted. */
export interface DamagedRun {
  id: string;
  kind: Kind | null;
  name: string | null;
  state?: State;
  created_at: string | null;
  /** Why it cannot be read. */
  damaged: string;
}

/** The column of the exploration rate has the name of the live setting that replaces it. */
export interface Evaluation {
  step: number;
  distance_m: number;
  epsilon: number;
  [setting: string]: number;
}

export interface Page<Item> {
  items: Item[];
  next_cursor: string | null;
}

export interface Curve {
  evaluations: Evaluation[];
  greedy_distance_m: number | null;
  best_known_m: number | null;
}

/** A point of a lane's path: race time [s], distance [m]. */
export type TimelinePoint = [number, number];

export interface TimelineLane {
  agent: string;
  color: string;
  points: TimelinePoint[];
  /** Intervals [from, to] of the race time [s]. */
  thinking: [number, number][];
  /** Steps that it has taken so far. */
  steps: number;
  /** Number of steps told as one; 1 in all but long races. */
  stride: number;
  /** Simulated transitions before each stride of steps. */
  futures: number[];
  total_s: number;
}

export interface Timeline {
  id: string;
  clock: Clock;
  lanes: TimelineLane[];
  /** When the first lane has used its steps [s]: the time-out. */
  first_finish_s: number | null;
  finish_line_m: number;
}

// ---- GET /runs/{id}/gait; times are robot time [s]: motion only

export interface GaitFigures {
  from_s: number;
  to_s: number;
  distance_m: number;
  speed_m_s: number;
  speed_body_lengths_s: number;
  duty_factor: number;
  mass_kg: number;
  /** When each foot is on the ground. */
  legs: { leg: number; stance: [number, number][]; duty_factor: number }[];
  /** The steps that the walk repeats at its end; its actions are [pair, cell]. */
  cycle: {
    steps: number;
    period_s: number;
    /** Counted from 0. */
    first_step: number;
    repeats: number;
    advance_m: number;
    actions: [number, number][];
  } | null;
  posture: {
    time_s: number[];
    height_m: number[];
    pitch_deg: number[];
    roll_deg: number[];
    height_range_m: [number, number];
    pitch_range_deg: [number, number];
    roll_range_deg: [number, number];
  };
  effort: {
    time_s: number[];
    torque_nm: number[];
    power_w: number[];
    largest_torque_nm: number;
    torque_limit_nm: number;
    energy_j: number;
    mean_power_w: number;
    cost_of_transport: number | null;
  } | null;
}

export interface GaitLane {
  agent: string;
  recorded_from_s: number;
  recorded_to_s: number;
  figures: GaitFigures | null;
  /** Why there are neither torque nor energy. */
  no_effort: string | null;
}

export interface GaitAnalysis {
  part: "race" | "practice" | "evaluation";
  /** Duration of a step [s]. */
  step_s: number;
  lanes: GaitLane[];
}

export interface WhatIfHalf {
  distances_m: number[];
  iqm_m: number;
  /** Share that covers at least half of greedy's distance. */
  walkers: number;
}

export interface WhatIfAnswer {
  seeds: number;
  greedy_m: number;
  chosen: WhatIfHalf;
  default: WhatIfHalf;
}

// ---- the stage and its scene

/** Where others can watch. */
export interface Spectators {
  address: string | null;
  qr_code: string | null;
  reason: string;
  watching: number;
}

export interface Stage {
  run_id: string | null;
  /** Of the state machine of app/stage/state_machine.py. */
  phase: "empty" | "live" | "decided" | "showing" | "ended";
  origin: "none" | "started" | "chosen" | "automatic" | "restored";
  next_run_id: string | null;
  playing: boolean;
  /** Whether its end is shown; playing starts it again. */
  ended: boolean;
  speed: number | "time-lapse";
  clock: Clock;
  end_at_time_out: boolean;
  /** A replay that the stage will show by itself. */
  announced: { run_id: string; in_s: number } | null;
}

// ---- GET /runs/{id}/replay

export interface ReplayMark {
  kind: "time-out" | "crossing" | "fall" | "disturbance" | "evaluation";
  time_s: number;
  lane: number | null;
  step: number | null;
  distance_m: number | null;
}

export interface ReplayPlan {
  run_id: string;
  ghost_id: string | null;
  kind: "training" | "race";
  complete: boolean;
  duration_s: number | null;
  recorded_s: [number, number][];
  step_ends_s: number[][];
  marks: ReplayMark[];
  frame_s: number;
  segment_frames: number;
  lowest_level: number;
  highest_level: number;
}

export interface SceneLane {
  lane: number;
  name: string;
  color: string;
  rank: number;
  distance_m: number;
  step: number;
  steps: number;
  /** Whether it has used all its steps, or failed. */
  done: boolean;
  /** Whether its run ended before. */
  halted: boolean;
  thinking: boolean;
  futures: number;
  futures_total: number;
  crossed: boolean;
  marching: boolean;
  failure?: string | null;
}

/** The learner's action values in its current state. */
export interface ActionValues {
  agent: string;
  lane: number;
  pairs: [number, number][];
  cell_names: string[];
  cells_m: [number, number][];
  /** [pair][cell]; null where the foot already stands. */
  values_m: (number | null)[][];
  visits: (number | null)[][] | null;
  /** The cell of each pair. */
  current: number[];
  next: { pair: number; cell: number } | null;
  low: number;
  high: number;
}

export interface Scene {
  run_id: string | null;
  kind: "idle" | "training" | "race";
  label: string;
  phase: string;
  clock: Clock;
  time_s: number;
  duration_s: number | null;
  /** Time of the run up to which it is computed. */
  computed_s: number;
  time_out_s: number | null;
  ended: boolean;
  shown_speed: number;
  replay: boolean;
  lanes: SceneLane[];
  action_values: ActionValues | null;
  /** The robots of another run that are shown as ghosts. */
  ghost_lanes?: { lane: number; name: string; distance_m: number; step: number }[];
}

// ---- explained steps, and tables

/** The leg pairs and the cells of a foot grid. */
export interface FootCells {
  pairs: number[][];
  cells_m: [number, number][];
  cell_names: string[];
}

/** Leg pair, and cell to which it moves. */
export type Move = [number, number];

/** GET /trainings/{id}/table: a row a state, a column a move. */
export interface StateTable extends FootCells {
  step: number;
  /** Number of all states. */
  states: number;
  /** Index of the state of the first row. */
  first: number;
  /** Null where the feet stand already. */
  values: (number | null)[][];
  visits: (number | null)[][];
  best: Move[];
}

export interface RuleTerm {
  symbol: string;
  value: number;
  meaning: string;
}

export interface ValueUpdate {
  observation: number[];
  action: Move;
  move: string;
  rule: string;
  numbers: string;
  terms: RuleTerm[];
  before: number;
  after: number;
  is_exact: boolean;
}

export interface Belief {
  name: string;
  unit: string;
  before: number;
  after: number;
  deviation_before: number | null;
  deviation_after: number | null;
}

/** GET /runs/{id}/explain */
export interface Explanation extends FootCells {
  run_id: string;
  lane: number | null;
  step: number;
  agent: string;
  observation: number[];
  action: Move;
  reward_m: number;
  next_observation: number[] | null;
  /** How often each move had been tried here before: [pair][cell]. */
  visits: (number | null)[][] | null;
  choice: {
    kind: "exploited" | "explored" | "unknown";
    criterion: string;
    scores: (number | null)[][];
    best: Move[];
    runner_up: Move | null;
    margin_m: number | null;
    epsilon: number | null;
    draw: number | null;
    probability: number;
    sentences: string[];
  } | null;
  update: {
    summary: string;
    direct: ValueUpdate | null;
    stored: number | null;
    others: { count: number; values_changed: number; largest: ValueUpdate[] };
    beliefs: Belief[];
  } | null;
  /** What a search found; its own move comes first. */
  search: {
    compares: string;
    transitions: number;
    futures: { action: Move; reward_m: number; return_m: number; sequences: number; steps: number }[];
    sentences: string[];
  } | null;
  unexplained: string | null;
}

/** Values of the pace and of live settings by name. */
export type Rates = Record<string, SettingValue>;

// ---- GET /experiments/{id}/trials

export interface Trial {
  /** The setting, and the number of the seed: "…#12". */
  key: string;
  result: { distances_m?: number[]; [field: string]: any } | null;
}

// ---- GET /experiments/{id}/summary

export interface Interval {
  share: number;
  verdict: string;
}

export interface Distances {
  points_m: number[];
  mean_m: number;
  iqm_m: number;
  low_m: number | null;
  high_m: number | null;
}

/** One setting of an experiment with the distances of its seeds. */
export interface Setting {
  [field: string]: any;
  key: string;
  role: "learner" | "reference";
  n: number;
  agent: string;
  gait: string;
  observation: string;
  robot: string;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
  steps: number;
  total: Distances | null;
  finished: Distances | null;
  walkers: { share: number } | null;
  published: Record<string, number | null> | null;
  /** Reports of earlier versions have none. */
  best_known_m?: number | null;
}

/** Robot, observation and grid, within which agents are compared. */
export interface Place {
  key: string;
  observation: string;
  robot: string;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
}

export interface Summary {
  [part: string]: any;
  experiment: string;
  settings: Setting[];
  /** Names of what is varied beside place and agent. */
  parameters: string[];
}
