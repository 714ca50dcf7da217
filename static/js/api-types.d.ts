// Written by `make page-types` from the API's response models.

export type JsonValue = unknown;
export type GaitInAnswers =
  | (
      | "left-right-origin"
      | "left-right-vertical"
      | "front-back-origin"
      | "front-back-vertical"
      | "tripod"
      | "tetrapod"
      | "trot"
      | "pace"
      | "bound"
      | "one-by-one"
    )
  | {
      right_leg: number;
      left_leg: number;
      symmetry?: "origin" | "vertical";
      pairs?: [number, number][];
      groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
    };
export type GivenJsonValue = unknown;

/**
 * Value of an action, [pair, cell], in a state, which is the cell of each pair.
 */
export interface ActionValue {
  state: number[];
  action: [number, number];
  value: number;
  visits: number;
}
/**
 * An agent, with its constructor's settings and those that can change during a training.
 */
export interface AgentOption {
  name: string;
  title: string;
  description: string;
  learns: boolean;
  /**
   * whether it plans with a simulator: takes `plans_with`.
   */
  searches: boolean;
  needs_practice: boolean;
  keeps_learning: boolean;
  /**
   * of a look-ahead agent without settings: how many steps it simulates.
   */
  steps_ahead: number | null;
  color: string;
  settings: {
    [k: string]: SettingOption;
  };
  live_settings: {
    [k: string]: SettingOption;
  };
}
/**
 * Declaration of a setting: the labels, limits and default of its form control.
 */
export interface SettingOption {
  title: string;
  symbol: string | null;
  quantity: string | null;
  unit: string | null;
  help: string;
  /**
   * the valid values, in words.
   */
  valid: string;
  minimum: number | null;
  maximum: number | null;
  /**
   * whether the minimum itself is not valid.
   */
  excludes_minimum: boolean;
  /**
   * whether the maximum itself is not valid.
   */
  excludes_maximum: boolean;
  is_number: boolean;
  is_boolean: boolean;
  is_whole: boolean;
  /**
   * the valid words, if only certain words are valid.
   */
  choices: string[];
  /**
   * the titles of these words, in their order.
   */
  choice_titles: string[];
  default: number | string | boolean | null;
  /**
   * whether it may change while a training runs.
   */
  is_live: boolean;
}
/**
 * What each visitor of a demo may start, and what is left of it to who asks.
 */
export interface AllowanceView {
  /**
   * steps that may be computed in any hour; of a race of all its lanes.
   */
  steps_per_hour: number;
  /**
   * of these.
   */
  steps_left: number;
  /**
   * steps of one start, with all the practice that a race needs.
   */
  steps_per_start: number;
  /**
   * a start counts as so many at least.
   */
  least_steps: number;
  /**
   * starts that may wait or go on at once.
   */
  max_unended: number;
  /**
   * starts that do.
   */
  unended: number;
  /**
   * runs that may be kept at once.
   */
  max_kept: number;
  /**
   * for so long a run computes at most; then it is stopped [s].
   */
  seconds_per_run: number;
  /**
   * after how many hours what was made is deleted.
   */
  hours: number;
  /**
   * ids of the runs of who asks, oldest first.
   */
  runs: string[];
}
/**
 * A run that the stage will show again by itself; `PUT /stage` with `stay` keeps its own.
 */
export interface Announcement {
  run_id: string;
  in_s: number;
}
/**
 * A question, to which each participant gives one answer before the reveal.
 */
export interface Ask {
  /**
   * of answer: a text of the choices, a number, a point [x, y] on a chart, or a curve, a list of points.
   */
  kind: "choice" | "number" | "point" | "curve";
  /**
   * the question, in Markdown.
   */
  text: string;
  /**
   * of which one is the answer, of kind `choice` alone; a name of an agent stands for the race that it wins.
   */
  choices: string[];
  /**
   * between which a number is.
   */
  minimum: number | null;
  /**
   * between which a number is.
   */
  maximum: number | null;
  /**
   * of the number; `m` and `cm` are compared with distances.
   */
  unit: string | null;
}
/**
 * A share of the seeds, and the verdict whether it exceeds one half.
 */
export interface Beats {
  share: number;
  low: number | null;
  high: number | null;
  verdict: "yes" | "no" | "not established";
}
/**
 * Beliefs of a model, before and after the step.
 */
export interface BeliefView {
  name: string;
  unit: string;
  before: number;
  after: number;
  deviation_before: number | null;
  deviation_after: number | null;
}
/**
 * Groups with which a robot that tips would stand.
 */
export interface BetterGroups {
  /**
   * the gait with these groups.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  /**
   * least support margin of the gait.
   */
  margin_m: number;
  /**
   * number of states with the gait.
   */
  states: number;
}
/**
 * A value with its 95 % interval, which is null with too few seeds.
 */
export interface BootstrappedView {
  value: number;
  low: number | null;
  high: number | null;
}
/**
 * Allowed values of a setting; without any bound, all that are valid.
 */
export interface Bounds {
  /**
   * least number, inclusive.
   */
  minimum: number | null;
  /**
   * greatest number, inclusive.
   */
  maximum: number | null;
  /**
   * the values of which one may be chosen.
   */
  choices: [number | string | boolean, ...(number | string | boolean)[]] | null;
}
/**
 * The moment of another race at which a race branches off; until then both are the same.
 */
export interface Branch {
  /**
   * id of the other race.
   */
  race_id: string;
  /**
   * How many steps of that race are repeated.
   */
  step: number;
}
/**
 * A page of a lesson.
 */
export interface Card {
  /**
   * by name the settings that may be changed, each with its bounds.
   */
  may: {
    [k: string]: Bounds;
  };
  title: string | null;
  /**
   * in Markdown.
   */
  text: string;
  /**
   * what it opens of the page.
   */
  state: PageState | null;
  /**
   * the tabs of the panel that are shown; null for those of the depth.
   */
  show: ("board" | "train" | "world" | "why" | "gait" | "table" | "what-if")[] | null;
  /**
   * its question.
   */
  ask: Ask | null;
  /**
   * what the button runs, from the form of the state; null for nothing.
   */
  go: ("training" | "race" | "what-if") | null;
  /**
   * how the class teaches a robot, which walks by the form of the state.
   */
  teach: Teach | null;
  /**
   * what is revealed afterwards, or its text alone.
   */
  reveal: Reveal | string | null;
}
/**
 * A part of the page's state document; what is null stays as it is.
 */
export interface PageState {
  /**
   * the open view.
   */
  view: ("race" | "experiments" | "runs" | "compare") | null;
  /**
   * fields of the start that the page offers, by name: those of a training, settings of its agent (by themselves or in `settings`), `lanes` and `race_steps` of a race, `world` and `disturb`.
   */
  form: {
    [k: string]: JsonValue;
  } | null;
  /**
   * id of the run that is replayed.
   */
  run: string | null;
  /**
   * id of the run whose robots walk along.
   */
  ghost: string | null;
  /**
   * where the replay is held [s].
   */
  moment: number | null;
  /**
   * of the replay of a race.
   */
  clock: ("paper" | "wall" | "free") | null;
  /**
   * where the replay of a race ends.
   */
  end: ("time-out" | "all") | null;
  /**
   * how much of the page is shown.
   */
  depth: ("watch" | "try" | "study") | null;
  /**
   * the open tab of the panel.
   */
  tab: ("board" | "train" | "world" | "why" | "gait" | "table" | "what-if") | null;
  /**
   * a second tab beside it.
   */
  pinned: ("board" | "train" | "world" | "why" | "gait" | "table" | "what-if") | null;
  /**
   * its target: `directed` (or `leader`, the same), `free`, or the number of a lane.
   */
  camera: ("directed" | "leader" | "free" | "1" | "2" | "3" | "4" | "5" | "6" | "7" | "8") | null;
  /**
   * parts of the page that are hidden.
   */
  hidden: ("panel" | "card")[];
}
/**
 * How a class teaches a robot; gait, robot and simulator are those of the card's form.
 */
export interface Teach {
  /**
   * learner of the class's robot, and of the one beside it.
   */
  agent: "tamer";
  /**
   * what the robot beside it learns from: the `reward` itself, or a `simulated` person.
   */
  rival: "reward" | "simulated";
  /**
   * how long the class teaches [s].
   */
  seconds: number;
  /**
   * how long a step of the robot lasts, which walks slower for that [s].
   */
  step_s: number;
}
/**
 * Text and answer that are revealed after the answers.
 */
export interface Reveal {
  /**
   * in Markdown.
   */
  text: string;
  /**
   * the right choice or number, where it does not follow from the runs.
   */
  answer: number | string | null;
}
/**
 * The results of a card, as far as the reader may see them.
 */
export interface CardResultsView {
  card: number;
  title: string;
  ask: Ask | null;
  is_revealed: boolean;
  /**
   * number of participants, of those who have answered, and of those whose run has finished.
   */
  participants: number;
  /**
   * number of participants, of those who have answered, and of those whose run has finished.
   */
  predicted: number;
  /**
   * number of participants, of those who have answered, and of those whose run has finished.
   */
  finished: number;
  /**
   * entries of the participants; before the reveal a participant gets their own alone.
   */
  entries: ResultEntry[];
  /**
   * distances of all seeds, shortest first; before the reveal for a teacher alone.
   */
  distances_m: number[];
  interval: IntervalView | null;
  /**
   * answer that the lesson gives; null before the reveal, but for a teacher.
   */
  answer: number | string | null;
  /**
   * number of finished runs that a projector does not tell yet, as the phones of their participants still show them.
   */
  on_their_way: number;
  /**
   * race of the best, the median and the last robot; null before the reveal.
   */
  race: ClassRaceView | null;
}
/**
 * A participant's part of a card's results.
 */
export interface ResultEntry {
  seed: number;
  /**
   * name of the participant; null where it is hidden from the reader.
   */
  name: string | null;
  is_own: boolean;
  prediction: JsonValue;
  /**
   * score of the prediction; participants get it after the reveal.
   */
  score: Score | null;
  /**
   * of the question after the lesson, 1 if the participant was wrong before and is right now, -1 if it is the other way round, else 0; null unless both are answered, and for others before the reveal.
   */
  gain: (-1 | 0 | 1) | null;
  run: RunOutcome | null;
}
/**
 * Score of an answer against all seeds; null where that does not apply.
 */
export interface Score {
  /**
   * whether it is the answer that the lesson gives.
   */
  is_right: boolean | null;
  /**
   * of races, the share of seeds in which the chosen agent won (a draw counts in part).
   */
  share: number | null;
  /**
   * share of the seeds below the number; one that is equal counts half.
   */
  quantile: number | null;
  /**
   * absolute difference from the answer of the lesson, or else from the interquartile mean, in the unit of the question; of a point or a curve the mean over its points [m].
   */
  error: number | null;
}
/**
 * A participant's run on a card.
 */
export interface RunOutcome {
  /**
   * id of the run, or of the record of a what-if.
   */
  id: string;
  kind: ("training" | "race" | "experiment") | "what-if";
  state: "queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted";
  /**
   * settings that the participant gave, by name.
   */
  given: {
    [k: string]: unknown;
  };
  /**
   * distance that the robot walked; of a race that of the learner at time-out; of a what-if the interquartile mean with the chosen settings.
   */
  distance_m: number | null;
  /**
   * agents of the lanes that won a race.
   */
  winners: string[];
  /**
   * rank among the seeds, 1 for the longest distance; null before the reveal.
   */
  rank: number | null;
  /**
   * answer of the reader's own what-if; null for other runs.
   */
  answer: ComparisonView | null;
}
/**
 * The chosen settings of a practice compared with the defaults.
 */
export interface ComparisonView {
  seeds: number;
  greedy_m: number;
  chosen: SeedsView;
  default: SeedsView;
  compute_s: number;
}
/**
 * Result of many seeds with these settings: their distances [m] and interquartile mean.
 */
export interface SeedsView {
  /**
   * settings of the agent, by name
   */
  settings: {
    [k: string]: number | string | boolean | null;
  };
  steps_per_episode: number;
  distances_m: number[];
  walkers: number;
  iqm_m: number;
}
/**
 * Interquartile mean of the distances [m] with its 95 % interval, from three seeds on.
 */
export interface IntervalView {
  iqm_m: number;
  low_m: number | null;
  high_m: number | null;
}
/**
 * The race of a card's best, median and last robot.
 */
export interface ClassRaceView {
  /**
   * id of the race.
   */
  run_id: string;
  /**
   * seeds of its lanes, from left to right: the best, then the median, then the last.
   */
  seeds: number[];
  /**
   * number of robots among which they are: those that walk alike, of which most do.
   */
  of: number;
}
/**
 * The texts of a card as HTML: of the card, of its question, and of what is revealed.
 */
export interface CardTexts {
  text: string;
  ask: string;
  reveal: string;
}
/**
 * A change of a running training, and the step after which it applies.
 *
 * Fields that did not change are left out.
 */
export interface Change {
  step: number;
  pace?: number | "max" | null;
  /**
   * settings of the agent, by name
   */
  settings?: {
    [k: string]: number | string | boolean | null;
  };
  disturbance?: {
    kind: string;
    at_step: number;
    [k: string]: number | string | null | number[];
  } | null;
  /**
   * of those who watch: pairs of the steps done in the picture, and a value from -1 to 1.
   */
  presses?: [number, number, ...number[]][];
}
/**
 * Why an action was chosen, why no other, and when another would have been.
 */
export interface ChoiceView {
  /**
   * the best by its scores, a random one, or one that is not known yet.
   */
  kind: "exploited" | "explored" | "unknown";
  /**
   * what its scores are.
   */
  criterion: string;
  /**
   * by leg pair and cell [m]; null where it could not be chosen
   */
  scores: (number | null)[][];
  best: [number, number][];
  runner_up: [number, number] | null;
  /**
   * score of the action, less that of the runner-up.
   */
  margin_m: number | null;
  /**
   * probability of a random action.
   */
  epsilon: number | null;
  /**
   * random number that was compared with it.
   */
  draw: number | null;
  /**
   * of this action in this state.
   */
  probability: number;
}
/**
 * Decisions of a person about a robot from a file; null fields are inferred from the file.
 *
 * This interface was referenced by `Root`'s JSON-Schema
 * via the `definition` "Choices-Output".
 */
export interface ChoicesOutput {
  /**
   * of several robots in a zip the path of the one that is meant.
   */
  file: string | null;
  /**
   * values of arguments of a xacro, `$(arg …)`, by name.
   */
  arguments: {
    [k: string]: string;
  } | null;
  /**
   * factor of all lengths of the file; 0.001 reads millimetres. Inertias change with its square, and masses that follow from densities with its cube; masses and torques that the file gives stay.
   */
  scale: number | null;
  /**
   * axis of the file that points up; z unless told otherwise.
   */
  up: ("x" | "-x" | "y" | "-y" | "z" | "-z") | null;
  /**
   * unit of the limits of joints in the file.
   */
  angle_unit: ("rad" | "deg") | null;
  /**
   * mass of the whole robot; those of its links keep their ratios.
   */
  mass_kg: number | null;
  /**
   * direction in which it walks, in the frame of its torso in the file: a horizontal axis, such as `x`, `-x`, `y` or `-y`; or an angle anticlockwise from x, seen from above; from y where x or -x is up [°].
   */
  forward: string | number | null;
  /**
   * for each leg the name of its foot in the file: of a body or link, of a geom, or of a site; in any order.
   */
  feet: [string, string, string, ...string[]] | null;
  /**
   * name of the keyframe of the file in which it stands.
   */
  keyframe: string | null;
  /**
   * height of the torso's centre above the centres of the feet, with which it stands.
   */
  body_height_m: number | null;
  /**
   * angles of joints with which it stands, by their names in the file [rad]; each is as given, the others are as found.
   */
  home_rad: {
    [k: string]: number;
  } | null;
  /**
   * which legs move together: the name of a gait, or groups of legs.
   */
  gait: GaitInAnswers | null;
  /**
   * largest torque of all servos [N·m].
   */
  servo_torque_nm: number | null;
  /**
   * position gain of all servos [N·m/rad].
   */
  servo_kp: number | null;
  /**
   * velocity gain of all servos [N·m·s/rad].
   */
  servo_kv: number | null;
}
/**
 * Verdict on one of the paper's claims.
 */
export interface ClaimVerdict {
  id: string;
  verdict: "holds" | "does not hold" | "not established" | "depends";
}
/**
 * A claim of the paper, with its verdict and the evidence.
 */
export interface ClaimView {
  id: string;
  claim: string;
  criterion: string;
  verdict: "holds" | "does not hold" | "not established" | "depends";
  evidence: string;
  where: Finding[];
}
/**
 * Verdict on a claim in one case.
 */
export interface Finding {
  observation: "measured" | "commanded" | "planned";
  robot: string;
  label: string;
  verdict: "holds" | "does not hold" | "not established" | "depends";
  evidence: string;
}
/**
 * The time of the server's clock [s], after a while without other events.
 */
export interface ClockEvent {
  sent_s: number;
}
/**
 * A run as commands for a shell, and as a Python program.
 */
export interface CodeView {
  command: string;
  python: string;
}
/**
 * A setting as it was compared: its name, interquartile mean and number of seeds.
 */
export interface ComparedView {
  name: string;
  iqm: BootstrappedView;
  seeds: number;
  is_deterministic: boolean;
}
/**
 * A comparison in sentences; one that says nothing is empty.
 */
export interface ComparisonWordsView {
  outcome: string;
  chance: string;
  further: string;
  seeds: string;
}
/**
 * Computing time of an experiment [s], trials per second, and workers.
 */
export interface Cost {
  wall_s: number;
  compute_s: number;
  trials_per_s: number | null;
  workers: number;
}
/**
 * Interquartile means over the seeds at some steps, with 95 % intervals [m].
 */
export interface Curve {
  steps: number[];
  iqm_m: number[];
  low_m: (number | null)[];
  high_m: (number | null)[];
  mean_m: number[];
}
/**
 * Learning curve of a setting: distances after each block, or on the way in one go [m].
 */
export interface CurveOfSetting {
  steps_per_episode: number | null;
  observation: "measured" | "commanded" | "planned";
  robot: string;
  world?: string;
  agent: string;
  steps: number[];
  blocks: number;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
  key: string;
  gait: string;
  greedy_m: number | null;
  best_known_m?: number | null;
  iqm_m: number[];
  low_m: (number | null)[];
  high_m: (number | null)[];
  mean_m: number[];
  walkers: (number | null)[];
  points_m: number[][];
  [k: string]:
    | number
    | string
    | boolean
    | null
    | "measured"
    | "commanded"
    | "planned"
    | number[]
    | (number | null)[]
    | number[][]
    | undefined;
}
/**
 * A learning curve with its references: greedy's distance, and the best known one [m].
 *
 * Both are of the world as it is now; the best known is null where it was not computed.
 */
export interface CurveView {
  evaluations: Evaluation[];
  greedy_distance_m: number | null;
  best_known_m: number | null;
}
/**
 * Evaluation of a training: the distance walked [m] after `step` steps of practice.
 */
export interface Evaluation {
  step: number;
  distance_m: number;
  epsilon: number;
}
/**
 * Thinned learning curves, of the runs that have one, in the order of their ids.
 */
export interface CurvesView {
  curves: ThinnedCurve[];
}
/**
 * A few points of a training's learning curve, by step.
 */
export interface ThinnedCurve {
  id: string;
  steps: number[];
  distances_m: (number | null)[];
}
/**
 * The sequence of steps that a walk repeats at its end, at least three times.
 */
export interface Cycle {
  /**
   * its length.
   */
  steps: number;
  /**
   * its duration.
   */
  period_s: number;
  /**
   * the step in which the repetition begins, counted from 0.
   */
  first_step: number;
  /**
   * how often it was walked, in full.
   */
  repeats: number;
  /**
   * the distance along the track in one period, on average.
   */
  advance_m: number;
  /**
   * (group, cell) of each step, beginning with that of `first_step`.
   */
  actions: [number, number][];
}
/**
 * A run that cannot be read, and why. It can be deleted.
 */
export interface DamagedRunView {
  id: string;
  kind: ("training" | "race" | "experiment") | null;
  name: string | null;
  state: ("queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted") | null;
  created_at: string | null;
  damaged: string;
}
/**
 * Default request bodies of a training and of a race, and what features add to them.
 */
export interface DefaultsView {
  training: TrainingDefaults;
  race: RaceDefaults;
  what_if: WhatIfDefaults;
}
/**
 * Default request body of a training.
 */
export interface TrainingDefaults {
  agent: string;
  robot: string;
  simulator: "mujoco" | "kinematic";
  /**
   * settings of the agent, by name
   */
  settings: {
    [k: string]: number | string | boolean | null;
  };
  [k: string]: unknown;
}
/**
 * Default request body of a race.
 */
export interface RaceDefaults {
  steps: number;
  seed: number;
  lanes: LaneDefaults[];
}
/**
 * Default request body of a lane.
 */
export interface LaneDefaults {
  agent: string;
  [k: string]: unknown;
}
/**
 * The number of seeds of a what-if.
 */
export interface WhatIfDefaults {
  seeds: number;
}
/**
 * A run that was deleted.
 */
export interface DeletedRun {
  id: string;
}
/**
 * Ids of what was deleted, and the runs that could not be.
 */
export interface DeletedView {
  deleted: string[];
  kept: KeptRun[];
  /**
   * until when `POST …/{id}/restore`, below the address of their list, brings them all back; null where one is gone for good.
   */
  restorable_until: string | null;
}
/**
 * A run that could not be deleted, and why; of other things that is an error.
 */
export interface KeptRun {
  id: string;
  reason: string;
}
/**
 * An option of a form, with its name on the page and a one-sentence description.
 */
export interface Described {
  name: string;
  title: string;
  description: string;
}
/**
 * Distances of the seeds, their mean, median, interquartile mean and 95 % interval [m].
 */
export interface Distances {
  points_m: number[];
  mean_m: number;
  median_m: number;
  iqm_m: number;
  low_m: number | null;
  high_m: number | null;
}
/**
 * A kind of disturbance, with its fields and the simulators that know it.
 */
export interface DisturbanceOption {
  name: string;
  title: string;
  description: string;
  fields: {
    [k: string]: FieldOption;
  };
  /**
   * the field that says how much happens.
   */
  size: string | null;
  /**
   * the size at which nothing happens: a number, or the robot's part that has it.
   */
  nothing: number | string | null;
  /**
   * whether it holds until another of the same thing.
   */
  lasts: boolean;
  /**
   * fields that tell, beside the kind, what it changes; each leg is one thing.
   */
  identified_by: string[];
  /**
   * part of a leg to which it happens; empty for all of it.
   */
  part: string[];
  /**
   * whether it only ends what happened before.
   */
  repairs: boolean;
  /**
   * of a leg to which it has happened: limp, repaired.
   */
  adjective: string;
  simulators: string[];
}
/**
 * Declaration of a field of a disturbance; of a list, that of each of its values.
 */
export interface FieldOption {
  title: string;
  symbol: string | null;
  quantity: string | null;
  unit: string | null;
  help: string;
  /**
   * the valid values, in words.
   */
  valid: string;
  minimum: number | null;
  maximum: number | null;
  /**
   * whether the minimum itself is not valid.
   */
  excludes_minimum: boolean;
  /**
   * whether the maximum itself is not valid.
   */
  excludes_maximum: boolean;
  is_number: boolean;
  is_boolean: boolean;
  is_whole: boolean;
  /**
   * the valid words, if only certain words are valid.
   */
  choices: string[];
  /**
   * the titles of these words, in their order.
   */
  choice_titles: string[];
  default: number | string | boolean | null;
  /**
   * whether it may change while a training runs.
   */
  is_live: boolean;
  /**
   * its name in a text, such as `limp:legs=1,4:at=25`.
   */
  short: string;
  is_list: boolean;
  is_required: boolean;
  /**
   * narrower limits by the choice of another field.
   */
  ranges: RangesView | null;
}
/**
 * Limits of a field by what is chosen in another: (low, high) of each choice.
 */
export interface RangesView {
  field: string;
  ranges: {
    [k: string]: [number, number];
  };
}
/**
 * A seed and a world on which all entries are judged, so that they can be compared in pairs.
 */
export interface Draw {
  /**
   * Everything that is random follows from this number: the same seed, the same run.
   */
  seed: number;
  /**
   * name of the world, or its disturbances.
   */
  world: string;
}
/**
 * An entry: an agent with its settings, a creature where allowed, or a trained table.
 */
export interface EntryConfig {
  /**
   * a registered name.
   */
  agent: string;
  /**
   * observation mode; with a table that of its training.
   */
  observation: "measured" | "commanded" | "planned";
  /**
   * settings of the agent, by name
   */
  settings: {
    [k: string]: number | string | boolean | null;
  };
  /**
   * steps of practice on each draw, within the budget; null for all of it. An agent that does not learn, or enters with a table, practises none.
   */
  steps: number | null;
  /**
   * a creature that the rules allow; null for the robot of the rules.
   */
  robot: RobotInAnswers | null;
  /**
   * SHA-256 of the trained table, hexadecimal; null for an agent that practises on each draw.
   */
  table: string | null;
}
/**
 * A preset, or the id and the name of a stored robot, and by name the parts that differ from it.
 */
export interface RobotInAnswers {
  preset?:
    | "stiff"
    | "compliant"
    | "slippery"
    | "ant"
    | "crab"
    | "spider"
    | "starfish"
    | "dog"
    | "centipede"
    | "freenove"
    | "phantomx"
    | "chica";
  id?: string;
  name?: string;
  legs?: {
    azimuth_deg: number;
    radius_m: number;
    z_m?: number;
    yaw_deg?: number;
    foot_out_m?: number;
    coxa_m?: number;
    femur_m?: number;
    tibia_m?: number;
    coxa_kg?: number;
    femur_kg?: number;
    tibia_kg?: number;
    foot_kg?: number;
    servo_kp?: number;
    servo_kv?: number;
    servo_torque_nm?: number;
  }[];
  [k: string]:
    | number
    | "stiff"
    | "compliant"
    | "slippery"
    | "ant"
    | "crab"
    | "spider"
    | "starfish"
    | "dog"
    | "centipede"
    | "freenove"
    | "phantomx"
    | "chica"
    | string
    | {
        azimuth_deg: number;
        radius_m: number;
        z_m?: number;
        yaw_deg?: number;
        foot_out_m?: number;
        coxa_m?: number;
        femur_m?: number;
        tibia_m?: number;
        coxa_kg?: number;
        femur_kg?: number;
        tibia_kg?: number;
        foot_kg?: number;
        servo_kp?: number;
        servo_kv?: number;
        servo_torque_nm?: number;
      }[]
    | undefined;
}
/**
 * An entry of a tournament.
 */
export interface EntryView {
  /**
   * from 0, in the order of their entering; the references come first.
   */
  number: number;
  /**
   * of its entrant, or of the reference; null where it is not to be seen.
   */
  name: string | null;
  is_reference: boolean;
  /**
   * whether it is the reader's own; an operator's if an operator reads.
   */
  is_own: boolean;
  /**
   * with all settings; that of others is null until the end, but for operators.
   */
  entry: EntryConfig | null;
  /**
   * of the training whose table entered; null where the entry is, or without one.
   */
  training_id: string | null;
  /**
   * `judging` once its first draw is; `withdrawn` if the end came before it was judged.
   */
  state: "waiting" | "judging" | "judged" | "withdrawn";
  /**
   * number of draws on which it is judged, and of all.
   */
  judged: number;
  /**
   * number of draws on which it is judged, and of all.
   */
  of: number;
  /**
   * on each draw; null until the end.
   */
  judgements: Judgement[] | null;
  entered_at: string;
}
/**
 * Result of an entry on a draw.
 */
export interface Judgement {
  /**
   * that it walked in 50 steps from rest [m]; 0 if it failed.
   */
  distance_m: number;
  /**
   * why it failed, one sentence; null if it did not.
   */
  failure: string | null;
}
/**
 * Estimated duration of a run here once it has a core [s].
 */
export interface EstimateView {
  seconds: number;
  /**
   * how many of its practices are computed at once; null where there are few.
   */
  workers: number | null;
}
/**
 * An evaluation of a training that runs.
 */
export interface EvaluationEvent {
  step: number;
  distance_m: number;
  epsilon: number;
  run_id: string;
}
/**
 * Data of each server-sent event of the core, by the event's name.
 */
export interface EventBodies {
  snapshot: SnapshotView;
  run: (TrainingView | RaceView | ExperimentView) | DamagedRunView;
  "run-deleted": DeletedRun;
  evaluation: EvaluationEvent;
  reference: ReferenceEvent;
  rates: RatesEvent;
  stage: StageView;
  piece: PieceEvent;
  clock: ClockEvent;
  viewers: ViewersEvent;
  robots: RobotsEvent;
  room: RoomEvent;
  teaching: TeachingEvent;
  tournament: TournamentEvent;
  summary: SummaryEvent;
}
/**
 * State of the server when the stream begins: the newest runs, or the one that is followed.
 */
export interface SnapshotView {
  version: string;
  /**
   * `operator`, `spectator`, or another one of clients whom a feature knows.
   */
  role: string;
  viewers: number;
  /**
   * of the list of stored robots; a greater one than in the options that a client has means that they have changed since.
   */
  robots_version: number;
  runs: ((TrainingView | RaceView | ExperimentView) | DamagedRunView)[];
  stage: StageView;
  scene: SceneView;
  evaluations?: Evaluation[];
}
/**
 * A training.
 */
export interface TrainingView {
  id: string;
  name: string;
  /**
   * whether somebody named it; else its name tells its config
   */
  is_named: boolean;
  state: "queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted";
  /**
   * whether its state allows `resume`, which is still refused if a run that it needs was deleted, or if a stopped training's table has been used since.
   */
  can_resume: boolean;
  queue_position: number | null;
  progress: ProgressView;
  eta_s: number | null;
  error: string | null;
  tags: string[];
  notes: string;
  created_at: string;
  started_at: string | null;
  ended_at: string | null;
  kind: "training";
  config: TrainingConfigView;
  result: TrainingResult | null;
  greedy_distance_m: number | null;
  changes: Change[];
}
/**
 * Progress: steps of a training or of all lanes of a race; other kinds count other things.
 */
export interface ProgressView {
  done: number;
  total: number;
}
/**
 * Config of a training.
 */
export interface TrainingConfigView {
  /**
   * a named gait, or a gait given by its groups of legs.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  robot: RobotInAnswers;
  /**
   * `mujoco` (physics) or `kinematic` (ideal, no slip).
   */
  simulator: "mujoco" | "kinematic";
  /**
   * Points along each side of the foot grid: more choices, more to learn.
   */
  divisions: number;
  /**
   * Side of the square in which each foot may be put; every leg must reach all of it.
   */
  grid_side_m: number;
  /**
   * what happens to the robot and the ground, by step.
   *
   * Items: A disturbance from a step on; the fields of its kind are further members.
   */
  disturbances: {
    kind: string;
    at_step: number;
    [k: string]: number | string | null | number[];
  }[];
  /**
   * How far the robot that the seed draws differs from its design, as a share.
   */
  tolerance: number;
  /**
   * Displacement that a step's reward is: along the robot's own heading (default), or along the track, so that a robot that turns earns no more than it advances.
   */
  reward: "forward" | "track";
  /**
   * How many steps it practises; the paper uses 500 and 1000.
   */
  steps: number;
  /**
   * Everything that is random follows from this number: the same seed, the same run.
   */
  seed: number;
  /**
   * observation mode, `measured`, `commanded` or `planned`.
   */
  observation: "measured" | "commanded" | "planned";
  /**
   * settings of the agent, by name
   */
  settings: {
    [k: string]: number | string | boolean | null;
  };
  /**
   * The share of random steps falls after every so many steps.
   */
  steps_per_episode: number;
  /**
   * Evaluates the policy after every so many steps; 0: never.
   */
  evaluate_every: number;
  /**
   * How fast it practises: max, or a number of times real time.
   */
  pace: "max" | number;
  /**
   * a registered name or `my.module:Agent`.
   */
  agent: string;
  continue_from: string | null;
}
/**
 * Final distance [m] of the agent and of the greedy reference, and the Q-table's hash.
 *
 * Both walked in the world as it was at the end. `fell_at_step` is the first step of practice,
 * counted from 0, in which the robot fell.
 */
export interface TrainingResult {
  distance_m: number | null;
  greedy_distance_m?: number | null;
  best_known_m?: number | null;
  q_table_sha256?: string | null;
  fell_at_step?: number | null;
}
/**
 * A race. `best_known_m` is null where it was not computed, as of worlds that change.
 */
export interface RaceView {
  id: string;
  name: string;
  /**
   * whether somebody named it; else its name tells its config
   */
  is_named: boolean;
  state: "queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted";
  /**
   * whether its state allows `resume`, which is still refused if a run that it needs was deleted, or if a stopped training's table has been used since.
   */
  can_resume: boolean;
  queue_position: number | null;
  progress: ProgressView;
  eta_s: number | null;
  error: string | null;
  tags: string[];
  notes: string;
  created_at: string;
  started_at: string | null;
  ended_at: string | null;
  kind: "race";
  config: RaceConfigView;
  result: RaceResult | null;
  best_known_m: number | null;
  waiting_for: string[];
}
/**
 * Config of a race.
 */
export interface RaceConfigView {
  /**
   * a named gait, or a gait given by its groups of legs.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  robot: RobotInAnswers;
  /**
   * `mujoco` (physics) or `kinematic` (ideal, no slip).
   */
  simulator: "mujoco" | "kinematic";
  /**
   * Points along each side of the foot grid: more choices, more to learn.
   */
  divisions: number;
  /**
   * Side of the square in which each foot may be put; every leg must reach all of it.
   */
  grid_side_m: number;
  /**
   * what happens to the robot and the ground, by step.
   *
   * Items: A disturbance from a step on; the fields of its kind are further members.
   */
  disturbances: {
    kind: string;
    at_step: number;
    [k: string]: number | string | null | number[];
  }[];
  /**
   * How far the robot that the seed draws differs from its design, as a share.
   */
  tolerance: number;
  /**
   * Displacement that a step's reward is: along the robot's own heading (default), or along the track, so that a robot that turns earns no more than it advances.
   */
  reward: "forward" | "track";
  /**
   * in order.
   */
  lanes: LaneView[];
  /**
   * How many steps each robot has in the race.
   */
  steps: number;
  /**
   * Everything that is random follows from this number: the same seed, the same run.
   */
  seed: number;
  /**
   * the race whose first steps this one repeats, if any.
   */
  branch_from: Branch | null;
}
/**
 * A lane of a race, with the id of the training whose Q-table it uses.
 *
 * The settings of an agent with training are those of the training.
 */
export interface LaneView {
  /**
   * a registered name or `my.module:Agent`.
   */
  agent: string;
  /**
   * How the agent reads its state; with a training as in the training.
   */
  observation: "measured" | "commanded" | "planned";
  /**
   * Whether it learns from each step of the race too; without practice it begins there.
   */
  keep_learning: boolean;
  /**
   * model that it plans with; null if it does not search.
   */
  plans_with: ("world" | "start" | "nominal") | null;
  /**
   * settings of the agent, by name
   */
  settings: {
    [k: string]: number | string | boolean | null;
  };
  /**
   * whether `plans_with` was left out.
   */
  plans_with_by_default: boolean;
  training_id: string | null;
}
/**
 * Result of a race, by lane.
 *
 * `recording_sha256` is a hash of all steps without the times of decisions, the same wherever the
 * race is repeated. `shared_machine`: whether other
 * runs computed beside it, which slows its wall clock.
 */
export interface RaceResult {
  lanes: LaneResult[];
  recording_sha256?: string | null;
  shared_machine?: boolean;
}
/**
 * Result of a lane. Deterministic except for `decision_s` and the `wall` clock.
 *
 * A lane that did not take all its steps has no total distance, and its failure as the reason.
 * `trained_robot` is set if its table was learned on another robot. `plans_with` is what its
 * search knew, null if it does not search. `fell_at_step` is counted from 0, null if it did not
 * fall; `heading_deg` is its heading at the end: 0 along the track, and 90 to the left.
 */
export interface LaneResult {
  agent: string;
  training_id?: string | null;
  trained_robot?: {
    [k: string]: unknown;
  } | null;
  steps: number;
  total_distance_m: number | null;
  failure: string | null;
  decision_s: number;
  simulated_transitions: number;
  clocks: LaneFigures;
  plans_with?: ("world" | "start" | "nominal") | null;
  fell_at_step?: number | null;
  heading_deg?: number | null;
}
/**
 * Figures of a lane under each clock.
 */
export interface LaneFigures {
  paper: FiguresUnderClock;
  wall: FiguresUnderClock;
  free: FiguresUnderClock;
}
/**
 * Figures of a lane under one clock; lanes are ranked by the distance at time-out.
 *
 * Without a time-out, as of a race that was stopped before, there are no ranks.
 */
export interface FiguresUnderClock {
  finished_distance_m: number | null;
  elapsed_s: number;
  crossed_s: number | null;
  rank: number | null;
}
/**
 * An experiment.
 */
export interface ExperimentView {
  id: string;
  name: string;
  /**
   * whether somebody named it; else its name tells its config
   */
  is_named: boolean;
  state: "queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted";
  /**
   * whether its state allows `resume`, which is still refused if a run that it needs was deleted, or if a stopped training's table has been used since.
   */
  can_resume: boolean;
  queue_position: number | null;
  progress: ProgressView;
  eta_s: number | null;
  error: string | null;
  tags: string[];
  notes: string;
  created_at: string;
  started_at: string | null;
  ended_at: string | null;
  kind: "experiment";
  config: ExperimentConfig;
  result: ExperimentResult | null;
  workers: number | null;
}
/**
 * Config of an experiment. `experiment_config` adds the defaults of the experiment.
 */
export interface ExperimentConfig {
  /**
   * name of its preset, see `presets`.
   */
  experiment: string;
  /**
   * How often each setting is tried, each time with other random numbers.
   */
  seeds: number;
  /**
   * Everything that is random follows from this number: the same seed, the same run.
   */
  seed: number;
  /**
   * the learners, and look-ahead agents beside those that are always tried.
   */
  agents: string[];
  /**
   * every combination is a setting; without gaits, each robot has the gait that suits it.
   */
  gaits: GaitInAnswers[];
  /**
   * every combination is a setting; without gaits, each robot has the gait that suits it.
   */
  observations: ("measured" | "commanded" | "planned")[];
  /**
   * every combination is a setting; without gaits, each robot has the gait that suits it.
   */
  robots: RobotInAnswers[];
  /**
   * simulator of all trials.
   */
  simulator: "mujoco" | "kinematic";
  /**
   * values of these fields of a training; every combination is a setting.
   *
   * Items: How many steps it practises; the paper uses 500 and 1000.
   */
  steps: number[];
  /**
   * settings of the agent, by name
   */
  settings: {
    [k: string]: (number | string | boolean | null)[];
  };
  /**
   * values of these fields of a training; every combination is a setting.
   *
   * Items: The share of random steps falls after every so many steps.
   */
  steps_per_episode: number[];
  /**
   * values of these fields of a training; every combination is a setting.
   *
   * Items: Points along each side of the foot grid: more choices, more to learn.
   */
  divisions: number[];
  /**
   * values of these fields of a training; every combination is a setting.
   *
   * Items: Side of the square in which each foot may be put; every leg must reach all of it.
   */
  grid_side_m: number[];
  /**
   * number of blocks of `steps` of practice; between blocks the table is saved and loaded.
   */
  blocks: number;
  /**
   * names of worlds, or disturbances as on the command line; every one is a setting.
   */
  worlds: string[];
  /**
   * How far the robot that the seed draws differs from its design, as a share.
   */
  tolerance: number;
  /**
   * Displacement that a step's reward is: along the robot's own heading (default), or along the track, so that a robot that turns earns no more than it advances.
   */
  reward: "forward" | "track";
}
/**
 * Result of an experiment; `files` are those of its report.
 *
 * `shared_machine`: whether other runs computed beside it, which slows what is timed. `finding`:
 * what came of it, in a sentence; empty where its claims say it.
 */
export interface ExperimentResult {
  trials: TrialCounts;
  claims: ClaimVerdict[];
  files: string[];
  shared_machine?: boolean;
  finding?: string;
}
/**
 * Number of trials by outcome; `failed` are all without a distance, `set_aside` among them.
 */
export interface TrialCounts {
  done: number;
  total: number;
  failed: number;
  set_aside: number;
}
/**
 * State of the stage, which shows one run to all viewers.
 */
export interface StageView {
  run_id: string | null;
  kind: "idle" | "training" | "race";
  /**
   * `empty`; `live`: the run is computed; `decided`: it is computed, and its picture is at time-out; `showing`: it has ended, its picture has not; `ended`: both have.
   */
  phase: "empty" | "live" | "decided" | "showing" | "ended";
  /**
   * why the run is on the stage: it was `started`, a person has `chosen` it, the server shows it again (`automatic`), or it was shown last before the server's start (`restored`).
   */
  origin: "none" | "started" | "chosen" | "automatic" | "restored";
  time_s: number;
  playing: boolean;
  speed: number | "time-lapse";
  clock: "paper" | "wall" | "free";
  end_at_time_out: boolean;
  replay: boolean;
  live: boolean;
  ended: boolean;
  next_run_id: string | null;
  holder: string | null;
  announced: Announcement | null;
  /**
   * time of the server's clock when this was written [s]; only differences count.
   */
  sent_s: number;
  /**
   * of the frames of the run on the stage; null for an empty stage.
   */
  version: string | null;
  playhead: Playhead;
  presentation: Presentation;
}
/**
 * The time of the run that is shown [s], as a function of the time of the server's clock.
 */
export interface Playhead {
  /**
   * time of the clock at the first point [s].
   */
  at_s: number;
  /**
   * at `at_s + after_s` the picture is at `time_s` of the run; between two points it moves uniformly. At least one, in order of time.
   */
  points: [number, number][];
  /**
   * seconds of the run per second after the last point; 0 where it holds there.
   */
  rate: number;
  /**
   * time of the run up to which it is computed.
   */
  computed_s: number;
  /**
   * of the run; null while it is not known.
   */
  duration_s: number | null;
  /**
   * of a race; null of a training, and until it is known.
   */
  time_out_s: number | null;
}
/**
 * State of presenters' windows beside the stage; set by their keys or by a remote.
 */
export interface Presentation {
  /**
   * number of the card that is shown, from 1; null before the first
   */
  card: number | null;
  /**
   * whether the step that is shown is explained
   */
  shows_why: boolean;
  /**
   * whether they show nothing
   */
  is_blank: boolean;
  /**
   * size of the QR code of the spectators' address
   */
  code: "large" | "small" | "none";
}
/**
 * The moment of a run that the stage shows, without poses.
 */
export interface SceneView {
  run_id: string | null;
  kind: "idle" | "training" | "race";
  phase: string;
  time_s: number;
  duration_s: number | null;
  /**
   * time of the run up to which it is computed.
   */
  computed_s: number;
  time_out_s: number | null;
  ended: boolean;
  shown_speed: number;
  playing: boolean;
  clock: "paper" | "wall" | "free";
  replay: boolean;
  label: string;
  lanes: SceneLane[];
  ghosts: GhostView[];
  ghost_lanes: GhostLane[];
  action_values: SceneActionValues | null;
}
/**
 * A lane at the moment that the stage shows; `halted` if its run ended before it was done.
 */
export interface SceneLane {
  lane: number;
  agent: string;
  name: string;
  color: string;
  distance_m: number;
  /**
   * number of the present step, from 1; at the end of the lane the last.
   */
  step: number;
  steps: number;
  /**
   * steps that have ended.
   */
  steps_made: number;
  thinking: boolean;
  futures: number;
  futures_total: number;
  /**
   * whether it has used all its steps, or failed.
   */
  done: boolean;
  halted: boolean;
  crossed: boolean;
  rank: number;
  marching: boolean;
  failure: string | null;
}
/**
 * A robot in the state after an earlier evaluation.
 */
export interface GhostView {
  step: number;
  distance_m: number;
}
/**
 * A robot of another run that is shown as a ghost.
 */
export interface GhostLane {
  step: number;
  distance_m: number;
  lane: number;
  name: string;
}
/**
 * Action values of a learner in its present state.
 */
export interface SceneActionValues {
  agent: string;
  lane: number;
  pairs: number[][];
  cell_names: string[];
  cells_m: [number, number][];
  /**
   * action values by leg pair and cell; null where the foot already stands.
   */
  values_m: (number | null)[][];
  visits: (number | null)[][];
  /**
   * the cell of each leg pair.
   */
  current: number[];
  next: NextAction | null;
  low: number;
  high: number;
}
/**
 * An action: the leg pair, and the cell to which it moves.
 */
export interface NextAction {
  pair: number;
  cell: number;
}
/**
 * Distances [m] of greedy and of the best known walk on the robot of a training.
 */
export interface ReferenceEvent {
  run_id: string;
  greedy_distance_m: number;
  best_known_m: number | null;
}
/**
 * A change of a training's pace and live settings; what stayed is left out.
 */
export interface RatesEvent {
  run_id: string;
  step: number;
  pace?: number | "max" | null;
  /**
   * settings of the agent, by name
   */
  settings?: {
    [k: string]: number | string | boolean | null;
  };
}
/**
 * Frames of the run on stage, before they are shown; see `docs/replays.md`.
 */
export interface PieceEvent {
  /**
   * of the run.
   */
  run_id: string;
  /**
   * that times a race.
   */
  clock: "paper" | "wall" | "free";
  /**
   * of the run's frames.
   */
  version: string;
  /**
   * level of the frames, and number of the first; null for a single frame.
   */
  level: number | null;
  /**
   * level of the frames, and number of the first; null for a single frame.
   */
  first: number | null;
  /**
   * number of frames; the last ones may be missing at the end of the run.
   */
  count: number;
  /**
   * time of a single frame, which the stage holds; null for others.
   */
  time_s: number | null;
  /**
   * time of the server's clock when this was written [s].
   */
  sent_s: number;
  playhead: Playhead;
  /**
   * the frames, encoded as in a replay; base64.
   */
  data: string;
}
/**
 * The number of pages that watch the stage.
 */
export interface ViewersEvent {
  count: number;
}
/**
 * Stored robots have changed; `GET /options` has them. `count` leaves hidden ones out.
 */
export interface RobotsEvent {
  count: number;
  version: number;
}
/**
 * A room has changed; sent on its own stage alone.
 */
export interface RoomEvent {
  code: string;
  title: string;
  language: string;
  lesson_id: string | null;
  /**
   * `open`, `frozen`: nothing can be answered or started, or `ended`.
   */
  state: "open" | "frozen" | "ended";
  /**
   * number of the card that is shown, from 0.
   */
  card: number;
  /**
   * number of the lesson's cards.
   */
  cards: number;
  /**
   * numbers of the cards that are revealed.
   */
  revealed: number[];
  /**
   * number of participants who are in the room.
   */
  participants: number;
  /**
   * number of participants who have answered the card that is shown.
   */
  predicted: number;
  /**
   * number of participants who have started a run on it.
   */
  started: number;
  /**
   * whether the card asks what is known before the lesson, or after it; null for cards of the lesson.
   */
  knowledge: ("before" | "after") | null;
  /**
   * id of the run on its stage.
   */
  spotlight: string | null;
  needs_approval: boolean;
}
/**
 * The class has pressed, or its teaching has begun or ended; sent on the room's stage alone.
 */
export interface TeachingEvent {
  card: number;
  /**
   * of the steps since the last event.
   */
  presses: StepPresses[];
}
/**
 * What the class pressed for a step of the robot.
 */
export interface StepPresses {
  /**
   * number of the step, from 0.
   */
  step: number;
  /**
   * numbers of pupils who pressed + and −; each counts once, with the last press.
   */
  plus: number;
  /**
   * numbers of pupils who pressed + and −; each counts once, with the last press.
   */
  minus: number;
  /**
   * mean over those who pressed, from -1 to 1.
   */
  value: number;
}
/**
 * A tournament has changed; `GET /tournaments/{tournament_id}` returns it.
 */
export interface TournamentEvent {
  id: string;
  state: ("open" | "ending" | "ended") | "deleted";
  /**
   * number of its entries, without the references.
   */
  entries: number;
  /**
   * number of draws that are judged, over all entries and references, and of all.
   */
  judged: number;
  /**
   * number of draws that are judged, over all entries and references, and of all.
   */
  of: number;
}
/**
 * The summary of an experiment has a new number of trials.
 */
export interface SummaryEvent {
  run_id: string;
  done: number;
  total: number;
}
/**
 * An experiment, with the fields of its request body and their defaults.
 */
export interface ExperimentOption {
  name: string;
  title: string;
  description: string;
  fields: string[];
  grid: string[];
  defaults: {
    [k: string]: unknown;
  };
  /**
   * by simulator: the defaults that are others there.
   */
  simulator_defaults: {
    [k: string]: {
      [k: string]: unknown;
    };
  };
  /**
   * the agents that it can compare.
   */
  agents: string[];
  /**
   * what it is, in a few words.
   */
  about: string;
  /**
   * when its learners are evaluated.
   */
  measure: "distance" | "blocks" | "practice" | "recovery";
  /**
   * agents that are always tried in addition.
   */
  references: string[];
  /**
   * whether a race measures decision times in each place.
   */
  is_timed: boolean;
  /**
   * whether the paper prints its numbers.
   */
  is_published: boolean;
  /**
   * whether its agents' settings may have several values.
   */
  takes_settings: boolean;
  /**
   * steps after each evaluation whose rewards are added up; null where none are.
   */
  earning_steps: number | null;
  /**
   * the paper's names of the gaits, where the paper prints its numbers.
   */
  paper_gaits: {
    [k: string]: string;
  };
}
/**
 * Page of experiments.
 */
export interface ExperimentPage {
  /**
   * Cursor of the next page; null on the last page.
   */
  next_cursor: string | null;
  items: (ExperimentView | DamagedRunView)[];
}
/**
 * An explained step.
 */
export interface ExplanationView {
  pairs: number[][];
  cells_m: [number, number][];
  cell_names: string[];
  run_id: string;
  lane: number | null;
  step: number;
  agent: string;
  /**
   * Items: cell of the foot grid; 0 is home
   */
  observation: number[];
  /**
   * leg pair and cell to which it moves, both from 0 on
   *
   * @minItems 2
   * @maxItems 2
   */
  action: [number, number];
  reward_m: number;
  next_observation: number[] | null;
  /**
   * how often each move had been tried here before, by leg pair and cell.
   */
  visits: (number | null)[][] | null;
  choice: ChoiceView | null;
  /**
   * null if it learned nothing from it.
   */
  update: UpdateView | null;
  /**
   * null if it does not search.
   */
  search: SearchView | null;
  /**
   * why the choice is not explained.
   */
  unexplained: string | null;
  /**
   * in a sentence what the step brought, and how often its move had been tried here.
   */
  what: string;
  /**
   * in a sentence why this move was made; null where the choice is not explained.
   */
  why: string | null;
  /**
   * in a sentence what it passed over or did not see; null where the choice is not explained.
   */
  missed: string | null;
}
/**
 * Update of the learner's values by a step.
 */
export interface UpdateView {
  summary: string;
  direct: ValueUpdateView | null;
  /**
   * the value in the end, as planning may change it again.
   */
  stored: number | null;
  others: OtherUpdates;
  beliefs: BeliefView[];
}
/**
 * Update of one value: the rule gives the value after it, to the last bit.
 */
export interface ValueUpdateView {
  /**
   * Items: cell of the foot grid; 0 is home
   */
  observation: number[];
  /**
   * leg pair and cell to which it moves, both from 0 on
   *
   * @minItems 2
   * @maxItems 2
   */
  action: [number, number];
  move: string;
  rule: string;
  /**
   * the rule with rounded numbers put in.
   */
  numbers: string;
  terms: TermView[];
  before: number;
  after: number;
  /**
   * whether the rule was checked and gives `after`.
   */
  is_exact: boolean;
}
/**
 * A number in a rule.
 */
export interface TermView {
  symbol: string;
  value: number;
  meaning: string;
}
/**
 * Further updates by the same step: planned ones, and those of earlier steps.
 */
export interface OtherUpdates {
  count: number;
  values_changed: number;
  largest: ValueUpdateView[];
}
/**
 * Simulations of a search, with the outcome of each future; its action comes first.
 */
export interface SearchView {
  compares: string;
  transitions: number;
  futures: FutureView[];
}
/**
 * Finding of a search about an action.
 */
export interface FutureView {
  /**
   * leg pair and cell to which it moves, both from 0 on
   *
   * @minItems 2
   * @maxItems 2
   */
  action: [number, number];
  /**
   * of the step, as simulated.
   */
  reward_m: number;
  /**
   * what the search compared.
   */
  return_m: number;
  /**
   * simulated ones that begin with it.
   */
  sequences: number;
  /**
   * how far these look ahead.
   */
  steps: number;
}
/**
 * A type of file that a race or training which has ended can be exported as.
 */
export interface ExportOption {
  title: string;
  /**
   * below `/api/v1/runs/{run_id}/`.
   */
  address: string;
  /**
   * of the request; POST is for operators only.
   */
  method: "GET" | "POST";
  ending: string;
  /**
   * the command that installs what the server lacks; null if it lacks nothing.
   */
  install: string | null;
}
/**
 * Findings in the file of a robot, which a person may correct.
 */
export interface FoundView {
  file_format: "mjcf" | "urdf";
  /**
   * path in the zip of the file that was read; null if it was not in a zip.
   */
  file: string | null;
  /**
   * leg by leg: the names of the joints and of the foot in the file.
   */
  legs: ImportedLeg[];
  /**
   * names in the file of all parts that could be the foot of a leg.
   */
  feet: string[];
  /**
   * names of the file's keyframes.
   */
  keyframes: string[];
  /**
   * direction in which it walks, anticlockwise from x of its torso in the file.
   */
  forward_deg: number;
  /**
   * whether its feet reach a foot grid that suits its size.
   */
  reaches_grid: boolean;
}
/**
 * A leg as it is called in the file.
 */
export interface ImportedLeg {
  /**
   * names of its joints, from the torso to the foot.
   */
  joints: string[];
  /**
   * name of its foot: of a geom, a site, or a body or link; fit for `Choices.feet`.
   */
  foot: string;
}
/**
 * The gain of a class, over the participants who have answered before and after the lesson.
 */
export interface GainView {
  /**
   * number of these participants.
   */
  pairs: number;
  /**
   * number of them who were right.
   */
  right_before: number;
  /**
   * number of them who were right.
   */
  right_after: number;
  /**
   * share who were right after the lesson, less the share before it.
   */
  gain: number;
  /**
   * its 95 % interval, a bootstrap over participants; null below three.
   */
  low: number | null;
  /**
   * its 95 % interval, a bootstrap over participants; null below three.
   */
  high: number | null;
}
/**
 * Gait analysis of a race, lane by lane, or of a training; times are robot time [s].
 */
export interface GaitAnalysis {
  /**
   * part of the run that is analysed.
   */
  part: "race" | "practice" | "evaluation";
  /**
   * duration of a step.
   */
  step_s: number;
  /**
   * all lanes of a race, or the one of a training.
   */
  lanes: GaitLane[];
}
/**
 * A robot's walk; `figures` are null if nothing of it lies in the window.
 */
export interface GaitLane {
  /**
   * name of its agent.
   */
  agent: string;
  /**
   * robot time at the beginning and at the end of the recording.
   */
  recorded_from_s: number;
  /**
   * robot time at the beginning and at the end of the recording.
   */
  recorded_to_s: number;
  /**
   * figures of the gait within the window.
   */
  figures: GaitFigures | null;
  /**
   * why there are neither torque nor energy, in a sentence.
   */
  no_effort: string | null;
}
/**
 * Figures of a walk between two times of robot time.
 */
export interface GaitFigures {
  /**
   * the window.
   */
  from_s: number;
  /**
   * the window.
   */
  to_s: number;
  /**
   * along the direction that the robot faces at the beginning of the recorded steps.
   */
  distance_m: number;
  /**
   * distance by time.
   */
  speed_m_s: number;
  /**
   * speed by the diameter of the torso.
   */
  speed_body_lengths_s: number;
  /**
   * mean of all legs that the robot has.
   */
  duty_factor: number;
  /**
   * of the robot with its payload, mean over the window.
   */
  mass_kg: number;
  /**
   * footfalls of each leg.
   */
  legs: LegGait[];
  /**
   * null if the walk does not end in one, or its choices were not recorded.
   */
  cycle: Cycle | null;
  posture: Posture;
  /**
   * null if it was not recorded.
   */
  effort: ServoEffort | null;
}
/**
 * Footfalls of a leg in a window: when it stands [s], and the share of that.
 */
export interface LegGait {
  leg: number;
  stance: [number, number][];
  duty_factor: number;
}
/**
 * The torso over time: the height of its centre over flat ground, its pitch and roll.
 */
export interface Posture {
  /**
   * robot time of the samples.
   */
  time_s: number[];
  /**
   * at those times; pitch is positive with the front up, roll with the left side up.
   */
  height_m: number[];
  /**
   * at those times; pitch is positive with the front up, roll with the left side up.
   */
  pitch_deg: number[];
  /**
   * at those times; pitch is positive with the front up, roll with the left side up.
   */
  roll_deg: number[];
  /**
   * lowest and highest of all frames.
   *
   * @minItems 2
   * @maxItems 2
   */
  height_range_m: [number, number];
  /**
   * lowest and highest of all frames.
   *
   * @minItems 2
   * @maxItems 2
   */
  pitch_range_deg: [number, number];
  /**
   * lowest and highest of all frames.
   *
   * @minItems 2
   * @maxItems 2
   */
  roll_range_deg: [number, number];
}
/**
 * Torque and mechanical work of the servos.
 */
export interface ServoEffort {
  /**
   * robot time of the samples.
   */
  time_s: number[];
  /**
   * the largest torque of any servo since the sample before, by magnitude.
   */
  torque_nm: number[];
  /**
   * mean positive mechanical power of all servos since the sample before.
   */
  power_w: number[];
  /**
   * in the window.
   */
  largest_torque_nm: number;
  /**
   * the most that the servo with the largest torque has.
   */
  torque_limit_nm: number;
  /**
   * positive mechanical work in the window; what servos draw on top is not simulated.
   */
  energy_j: number;
  /**
   * energy by time.
   */
  mean_power_w: number;
  /**
   * energy by weight times distance; null without distance.
   */
  cost_of_transport: number | null;
}
/**
 * A gait, with the directions of the hexapod's legs [°] and the groups that move together.
 */
export interface GaitOption {
  name: string;
  title: string;
  description: string;
  forward_deg: number;
  azimuths_deg: number[];
  pairs: number[][];
}
/**
 * A question, to which each participant gives one answer before the reveal.
 */
export interface GivenAsk {
  /**
   * of answer: a text of the choices, a number, a point [x, y] on a chart, or a curve, a list of points.
   */
  kind: "choice" | "number" | "point" | "curve";
  /**
   * the question, in Markdown.
   */
  text: string;
  /**
   * of which one is the answer, of kind `choice` alone; a name of an agent stands for the race that it wins.
   */
  choices?: string[];
  /**
   * between which a number is.
   */
  minimum?: number | null;
  /**
   * between which a number is.
   */
  maximum?: number | null;
  /**
   * of the number; `m` and `cm` are compared with distances.
   */
  unit?: string | null;
}
/**
 * Allowed values of a setting; without any bound, all that are valid.
 */
export interface GivenBounds {
  /**
   * least number, inclusive.
   */
  minimum?: number | null;
  /**
   * greatest number, inclusive.
   */
  maximum?: number | null;
  /**
   * the values of which one may be chosen.
   */
  choices?: [number | string | boolean, ...(number | string | boolean)[]] | null;
}
/**
 * A page of a lesson.
 */
export interface GivenCard {
  /**
   * by name the settings that may be changed, each with its bounds.
   */
  may?: {
    [k: string]: GivenBounds;
  };
  title?: string | null;
  /**
   * in Markdown.
   */
  text: string;
  /**
   * what it opens of the page.
   */
  state?: GivenPageState | null;
  /**
   * the tabs of the panel that are shown; null for those of the depth.
   */
  show?: ("board" | "train" | "world" | "why" | "gait" | "table" | "what-if")[] | null;
  /**
   * its question.
   */
  ask?: GivenAsk | null;
  /**
   * what the button runs, from the form of the state; null for nothing.
   */
  go?: ("training" | "race" | "what-if") | null;
  /**
   * how the class teaches a robot, which walks by the form of the state.
   */
  teach?: GivenTeach | null;
  /**
   * what is revealed afterwards, or its text alone.
   */
  reveal?: GivenReveal | string | null;
}
/**
 * A part of the page's state document; what is null stays as it is.
 */
export interface GivenPageState {
  /**
   * the open view.
   */
  view?: ("race" | "experiments" | "runs" | "compare") | null;
  /**
   * fields of the start that the page offers, by name: those of a training, settings of its agent (by themselves or in `settings`), `lanes` and `race_steps` of a race, `world` and `disturb`.
   */
  form?: {
    [k: string]: GivenJsonValue;
  } | null;
  /**
   * id of the run that is replayed.
   */
  run?: string | null;
  /**
   * id of the run whose robots walk along.
   */
  ghost?: string | null;
  /**
   * where the replay is held [s].
   */
  moment?: number | null;
  /**
   * of the replay of a race.
   */
  clock?: ("paper" | "wall" | "free") | null;
  /**
   * where the replay of a race ends.
   */
  end?: ("time-out" | "all") | null;
  /**
   * how much of the page is shown.
   */
  depth?: ("watch" | "try" | "study") | null;
  /**
   * the open tab of the panel.
   */
  tab?: ("board" | "train" | "world" | "why" | "gait" | "table" | "what-if") | null;
  /**
   * a second tab beside it.
   */
  pinned?: ("board" | "train" | "world" | "why" | "gait" | "table" | "what-if") | null;
  /**
   * its target: `directed` (or `leader`, the same), `free`, or the number of a lane.
   */
  camera?: ("directed" | "leader" | "free" | "1" | "2" | "3" | "4" | "5" | "6" | "7" | "8") | null;
  /**
   * parts of the page that are hidden.
   */
  hidden?: ("panel" | "card")[];
}
/**
 * How a class teaches a robot; gait, robot and simulator are those of the card's form.
 */
export interface GivenTeach {
  /**
   * learner of the class's robot, and of the one beside it.
   */
  agent?: "tamer";
  /**
   * what the robot beside it learns from: the `reward` itself, or a `simulated` person.
   */
  rival?: "reward" | "simulated";
  /**
   * how long the class teaches [s].
   */
  seconds?: number;
  /**
   * how long a step of the robot lasts, which walks slower for that [s].
   */
  step_s?: number;
}
/**
 * Text and answer that are revealed after the answers.
 */
export interface GivenReveal {
  /**
   * in Markdown.
   */
  text?: string;
  /**
   * the right choice or number, where it does not follow from the runs.
   */
  answer?: number | string | null;
}
/**
 * A question about what a lesson teaches, which is asked before it and after it.
 */
export interface GivenKnowledgeQuestion {
  /**
   * of answer: a text of the choices, a number, a point [x, y] on a chart, or a curve, a list of points.
   */
  kind: "choice" | "number" | "point" | "curve";
  /**
   * the question, in Markdown.
   */
  text: string;
  /**
   * of which one is the answer, of kind `choice` alone; a name of an agent stands for the race that it wins.
   */
  choices?: string[];
  /**
   * between which a number is.
   */
  minimum?: number | null;
  /**
   * between which a number is.
   */
  maximum?: number | null;
  /**
   * of the number; `m` and `cm` are compared with distances.
   */
  unit?: string | null;
  /**
   * the right answer: one of the choices, or a number.
   */
  right: number | string;
}
/**
 * A lesson.
 */
export interface GivenLesson {
  /**
   * in plain text.
   */
  title: string;
  /**
   * of its texts, such as `en` or `de-AT`.
   */
  language?: string;
  /**
   * how long it takes a class; null where its author does not say.
   */
  minutes?: number | null;
  /**
   * for whom it is, such as "from 12".
   */
  ages?: string | null;
  /**
   * what is learned, each a line of plain text.
   */
  aims?: string[];
  /**
   * question that a room asks before the first card, to measure what the class gains.
   */
  before?: GivenKnowledgeQuestion | null;
  /**
   * question that it asks after the last card; by default that of `before` again.
   */
  after?: GivenKnowledgeQuestion | null;
  /**
   * its pages, in order.
   *
   * @minItems 1
   */
  cards: [GivenCard, ...GivenCard[]];
}
/**
 * A group of legs.
 */
export interface GroupPreview {
  /**
   * numbers of the legs.
   */
  legs: number[];
  /**
   * support margin while the group swings: distance of the centre of mass from the edge of the polygon of the other feet; below 0 the robot tips.
   */
  margin_m: number;
  /**
   * reach of its feet from home; null where they reach all that can occur.
   */
  back_m: number | null;
  /**
   * reach of its feet from home; null where they reach all that can occur.
   */
  ahead_m: number | null;
}
/**
 * Status and version of the server.
 */
export interface HealthView {
  status: "ok" | "ready";
  version: string;
}
/**
 * Runs that were imported, in the order of their archive.
 */
export interface ImportedView {
  items: (TrainingView | RaceView | ExperimentView)[];
}
/**
 * Interquartile mean with its 95 % interval, which is null with too few seeds.
 */
export interface Interval95 {
  iqm: number;
  low: number | null;
  high: number | null;
}
/**
 * A participant who has joined: name, and the seed of all their runs.
 */
export interface JoinedView {
  name: string;
  seed: number;
}
/**
 * A question about what a lesson teaches, which is asked before it and after it.
 */
export interface KnowledgeQuestion {
  /**
   * of answer: a text of the choices, a number, a point [x, y] on a chart, or a curve, a list of points.
   */
  kind: "choice" | "number" | "point" | "curve";
  /**
   * the question, in Markdown.
   */
  text: string;
  /**
   * of which one is the answer, of kind `choice` alone; a name of an agent stands for the race that it wins.
   */
  choices: string[];
  /**
   * between which a number is.
   */
  minimum: number | null;
  /**
   * between which a number is.
   */
  maximum: number | null;
  /**
   * of the number; `m` and `cm` are compared with distances.
   */
  unit: string | null;
  /**
   * the right answer: one of the choices, or a number.
   */
  right: number | string;
}
/**
 * Value of a landing, which is the cell of each pair when a step has ended.
 */
export interface LandingValue {
  landing: number[];
  value: number;
  visits: number;
}
/**
 * Values [m] and visits of all landings, in the order of their cells.
 */
export interface LandingsView {
  values: number[];
  visits: number[];
}
/**
 * A leg, with its foot in the robot frame.
 */
export interface LegPreview {
  /**
   * number of the leg.
   */
  leg: number;
  /**
   * number of its group, from 0.
   */
  group: number;
  /**
   * 1 on the right, -1 on the left, 0 on the axis or mirrored otherwise.
   */
  side: number;
  /**
   * place of its foot at home: right, forward.
   *
   * @minItems 2
   * @maxItems 2
   */
  home_m: [number, number];
  /**
   * mass of the leg, with the foot.
   */
  mass_kg: number;
  /**
   * sentence on a cell of its grid that it cannot reach; null if it reaches all.
   */
  out_of_reach: string | null;
  /**
   * whether its foot can go to any place near home; one of two joints cannot.
   */
  follows_grid: boolean;
  /**
   * all numbers of the leg, as in a request: its place by `x_m` and `y_m`.
   */
  built: {
    [k: string]: number;
  };
  /**
   * places of its joints and foot while the robot stands, from the torso outward: right, forward, up from the torso's centre; null if it cannot stand.
   */
  links_m: [number, number, number][] | null;
}
/**
 * All lessons: the built-in ones, then those that were stored, newest first.
 */
export interface LessonList {
  items: ListedLesson[];
}
/**
 * A lesson in a list.
 */
export interface ListedLesson {
  id: string;
  title: string;
  language: string;
  /**
   * how long it takes a class, if its author says so.
   */
  minutes: number | null;
  /**
   * for whom it is.
   */
  ages: string | null;
  aims: string[];
  /**
   * whether a question is asked before it and after it.
   */
  has_knowledge_question: boolean;
  /**
   * number of its cards.
   */
  cards: number;
  is_built_in: boolean;
}
/**
 * A lesson with its id.
 */
export interface LessonView {
  /**
   * in plain text.
   */
  title: string;
  /**
   * of its texts, such as `en` or `de-AT`.
   */
  language: string;
  /**
   * how long it takes a class; null where its author does not say.
   */
  minutes: number | null;
  /**
   * for whom it is, such as "from 12".
   */
  ages: string | null;
  /**
   * what is learned, each a line of plain text.
   */
  aims: string[];
  /**
   * question that a room asks before the first card, to measure what the class gains.
   */
  before: KnowledgeQuestion | null;
  /**
   * question that it asks after the last card; by default that of `before` again.
   */
  after: KnowledgeQuestion | null;
  /**
   * its pages, in order.
   *
   * @minItems 1
   */
  cards: [Card, ...Card[]];
  /**
   * of the lesson.
   */
  id: string;
  /**
   * whether it comes with the server.
   */
  is_built_in: boolean;
  /**
   * whether an open room teaches it and who asks is no operator, so that what is revealed and the cards after the one that is shown are left out.
   */
  is_taught: boolean;
  /**
   * the texts of each card as HTML that a page may show as it is.
   */
  html: CardTexts[];
}
/**
 * A room in a list.
 */
export interface ListedRoom {
  code: string;
  title: string;
  state: "open" | "frozen" | "ended";
  participants: number;
  created_at: string;
}
/**
 * A tournament in a list.
 */
export interface ListedTournament {
  id: string;
  title: string;
  /**
   * code of its room; null without one.
   */
  room: string | null;
  /**
   * `open` for entries; `ending` until those that wait are judged; or `ended`.
   */
  state: "open" | "ending" | "ended";
  /**
   * number of its entries, without the references.
   */
  entries: number;
  created_at: string;
}
/**
 * Why a learner with a table loses a race: in numbers, and in three sentences.
 */
export interface LossView {
  run_id: string;
  lane: number;
  agent: string;
  clock: "paper" | "wall" | "free";
  /**
   * whether the race has timed out; if not, lanes are compared as they are now.
   */
  is_ranked: boolean;
  /**
   * lane that is ahead of all others.
   */
  ahead: number;
  /**
   * how far this lane is behind that one.
   */
  behind_m: number;
  /**
   * of the lane so far, each of which was simulated with every other move.
   */
  steps: number;
  /**
   * before the race; null if a training of them was deleted.
   */
  practised_steps: number | null;
  /**
   * moves, or landings, of the table that it had tried when it took its last step.
   */
  tried: number;
  /**
   * in the table, and of what kind they are.
   */
  entries: number;
  kind: "moves" | "landings";
  /**
   * different ones that it walked through.
   */
  states: number;
  /**
   * moves of these states that it had tried.
   */
  tried_there: number;
  /**
   * in these states.
   */
  moves_there: number;
  /**
   * what a step brought, on average.
   */
  reward_m: number;
  /**
   * what the best moves would have brought, one step ahead.
   */
  best_reward_m: number;
  /**
   * how much more the best move has to bring to count as better.
   */
  better_by_m: number;
  /**
   * steps in which the best move was better; the next three tell why it was not made.
   */
  better: number;
  /**
   * it had never tried it.
   */
  untried: number;
  /**
   * its table held it for worse than the move that it made.
   */
  undervalued: number;
  /**
   * its table held it for no worse, and it made another.
   */
  not_chosen: number;
  /**
   * @minItems 3
   */
  sentences: [string, string, string, ...string[]];
}
/**
 * Machine on which the experiment ran; empty before its start.
 */
export interface Machine {
  platform?: string;
  cores?: number | null;
}
/**
 * The participant who asks.
 */
export interface Me {
  name: string;
  seed: number;
  predictions: OwnAnswer[];
  runs: OwnRun[];
}
/**
 * Answer of a participant to the question of a card.
 */
export interface OwnAnswer {
  card: number;
  value: JsonValue;
}
/**
 * A run that a participant has started, and the card on which that was.
 */
export interface OwnRun {
  run_id: string;
  card: number;
}
/**
 * A short text under a heading.
 */
export interface NarrativeSection {
  heading: string;
  text: string;
}
/**
 * A lesson that was stored.
 */
export interface NewLesson {
  id: string;
  /**
   * address of the page with it, for others if they can reach the server.
   */
  link: string;
  /**
   * of the link, an SVG image as a data URI; null if others cannot reach the server.
   */
  qr_code: string | null;
}
/**
 * A room that was opened.
 */
export interface NewRoom {
  code: string;
  /**
   * of its page, for others if they can reach the server.
   */
  address: string;
  /**
   * of the address, an SVG image as a data URI; null if phones cannot reach the server.
   */
  qr_code: string | null;
}
/**
 * A guess or a repair, as a sentence with what it is about.
 */
export interface Note {
  /**
   * a guess is to be confirmed or corrected, a repair changed what the file says.
   */
  kind: "guess" | "repair";
  /**
   * what it is about; for most guesses `Choices` has a field by which to correct it.
   */
  topic:
    | "file"
    | "links"
    | "base"
    | "legs"
    | "forward"
    | "groups"
    | "stance"
    | "joints"
    | "servos"
    | "masses"
    | "size"
    | "shapes"
    | "meshes";
  /**
   * the sentence, which names what is in the file.
   */
  text: string;
  /**
   * names in the file of the bodies and joints that it is about; empty for the whole.
   */
  parts: string[];
  /**
   * a choice that the sentence offers instead; null where it offers none.
   */
  offer: ChoicesOutput | null;
}
/**
 * Options, defaults, limits and help texts of all forms.
 */
export interface OptionsView {
  version: string;
  /**
   * increases with each change of the stored robots.
   */
  robots_version: number;
  gaits: GaitOption[];
  robots: RobotOption[];
  agents: AgentOption[];
  worlds: WorldOption[];
  disturbances: DisturbanceOption[];
  simulators: Described[];
  observations: Described[];
  clocks: Described[];
  defaults: DefaultsView;
  settings: {
    [k: string]: SettingOption;
  };
  /**
   * [lowest, highest]; `settings` says which of them are not valid themselves.
   */
  limits: {
    [k: string]: [number | null, number | null];
  };
  help: {
    [k: string]: string;
  };
  /**
   * names of fields that are no declared settings.
   */
  titles: {
    [k: string]: string;
  };
  tournament_fields: {
    [k: string]: SettingOption;
  };
  experiments: ExperimentOption[];
  exports: ExportOption[];
  leg_fields: {
    [k: string]: SettingOption;
  };
  torso_fields: {
    [k: string]: SettingOption;
  };
}
/**
 * A robot: built in, or stored, which has its id as its name too.
 */
export interface RobotOption {
  name: string;
  title: string;
  description: string;
  /**
   * of a stored robot; null for one that is built in.
   */
  id: string | null;
  /**
   * whether it is left out where a robot is chosen.
   */
  hidden: boolean;
  /**
   * of a stored robot: by value, for links that are opened where it is not stored; null for one that is built in or from a file.
   */
  body: RobotInAnswers | null;
  robot: RobotInAnswers;
  /**
   * side of a foot grid that suits its size.
   */
  grid_side_m: number;
  /**
   * names of the joints of each leg, from the torso to the foot.
   */
  joints: string[][];
  /**
   * lowest and highest angle of each of them.
   */
  limits_rad: [number, number][][];
  /**
   * directions of its legs in its own frame, anticlockwise.
   */
  azimuths_deg: number[];
  /**
   * a gait that suits it.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  /**
   * names of the gaits that its legs can have.
   */
  gaits: string[];
  /**
   * by each of these gaits the learner to begin with, on the usual foot grid; `POST /robots/preview` says why, and of any gait and grid.
   */
  recommended_agent: {
    [k: string]: string;
  };
  /**
   * parts in whose place a disturbance puts another value, as they were built.
   */
  built: {
    [k: string]: number;
  };
}
/**
 * A named world, with what happens in it.
 */
export interface WorldOption {
  name: string;
  title: string;
  description: string;
  /**
   * Items: A disturbance from a step on; the fields of its kind are further members.
   */
  disturbances: {
    kind: string;
    at_step: number;
    [k: string]: number | string | null | number[];
  }[];
}
/**
 * What the reader may enter.
 */
export interface OwnEntries {
  /**
   * whether an entry would be taken now.
   */
  may_enter: boolean;
  /**
   * why not, in a sentence; null if it would be.
   */
  reason: string | null;
  /**
   * entries that are left this hour; null for operators, who have no limit, and for others who may not enter at all.
   */
  left: number | null;
  /**
   * when there is a further one; null while some are left.
   */
  next_at: string | null;
}
/**
 * A participant, as the teacher sees them.
 */
export interface Person {
  seed: number;
  name: string;
  /**
   * whether they have not left.
   */
  is_present: boolean;
  is_name_hidden: boolean;
  is_approved: boolean;
  joined_at: string;
  /**
   * whether they have answered the card that is shown.
   */
  has_predicted: boolean;
  /**
   * of what they started last on the card that is shown.
   */
  run_id: string | null;
  /**
   * of what they started last on the card that is shown.
   */
  run_state: ("queued" | "running" | "paused" | "finished" | "stopped" | "failed" | "interrupted") | null;
}
/**
 * Results of a setting, pooled over its gaits, with the best known as a share of greedy's.
 */
export interface PooledView {
  steps_per_episode: number | null;
  observation: "measured" | "commanded" | "planned";
  robot: string;
  world?: string;
  agent: string;
  steps: number;
  blocks: number;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
  relative: Interval95 | null;
  relative_finished: Interval95 | null;
  of_best_known?: Interval95 | null;
  walkers: SharedBy | null;
  beats_greedy: Beats | null;
  beats_greedy_total: Beats | null;
  reaches_greedy: SharedBy | null;
  gaits: string[];
  n: number;
  best_known_relative?: number | null;
  [k: string]:
    | number
    | string
    | boolean
    | null
    | "measured"
    | "commanded"
    | "planned"
    | Interval95
    | SharedBy
    | Beats
    | string[]
    | undefined;
}
/**
 * A share of the seeds with its 95 % interval.
 */
export interface SharedBy {
  share: number;
  low: number | null;
  high: number | null;
}
/**
 * An answer that is kept.
 */
export interface PredictionView {
  card: number;
  value: JsonValue;
}
/**
 * A press that counts, and the step that it is about, from 0.
 */
export interface PressView {
  step: number;
  value: 1 | -1;
}
/**
 * Preview of a walking problem.
 */
export interface Preview {
  /**
   * the gait with its groups leg by leg.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  /**
   * forward direction of the gait, anticlockwise from body x.
   */
  forward_deg: number;
  /**
   * cells of the foot grid by their places from home: right, forward.
   */
  cells_m: [number, number][];
  /**
   * all numbers of the robot that legs share; a torso that is no box has null for one.
   */
  built: {
    [k: string]: number | null;
  };
  /**
   * leg by leg.
   */
  legs: LegPreview[];
  /**
   * group by group.
   */
  groups: GroupPreview[];
  /**
   * least support margin over the groups.
   */
  margin_m: number;
  /**
   * whether that is below 0: it then tips onto the feet that swing, and drags.
   */
  tips: boolean;
  /**
   * whether it stands on all of its feet.
   */
  stands: boolean;
  /**
   * mass of the whole robot.
   */
  mass_kg: number;
  /**
   * size of a table: states, legal actions in each, and their product.
   */
  states: number;
  /**
   * size of a table: states, legal actions in each, and their product.
   */
  actions: number;
  /**
   * size of a table: states, legal actions in each, and their product.
   */
  values: number;
  /**
   * whether a learner with a table can start.
   */
  table_fits: boolean;
  /**
   * advance of the steady walk by the law without slip.
   */
  law_m_per_step: number;
  /**
   * advance of 50 steps, a race, by that law.
   */
  law_m: number;
  /**
   * sentence on a cell that a leg cannot reach; null if all legs reach all.
   */
  out_of_reach: string | null;
  /**
   * largest grid side with which it may walk; null if it reaches none.
   */
  largest_side_m: number | null;
  /**
   * largest grid side with which every action is always possible; likewise.
   */
  safe_side_m: number | null;
  /**
   * sentence on the legs that cannot follow the grid; null if all can.
   */
  beside_grid: string | null;
  /**
   * groups to take instead; null if it does not tip, or tips with any.
   */
  better: BetterGroups | null;
  /**
   * learner to begin with, by the support margin.
   */
  recommended_agent: string;
  /**
   * reason of the recommendation, in a sentence.
   */
  recommended_because: string;
}
/**
 * Value printed in the paper [m], and its quantile among the seeds.
 */
export interface PublishedView {
  total_m: number | null;
  finished_m: number | null;
  total_quantile: number | null;
  finished_quantile: number | null;
}
/**
 * Q-table; `cells` are the (x, y) of each cell [m].
 *
 * `values` are those of all legal actions in all states, or of a learner over landings those of
 * all landings.
 */
export interface QTableView {
  gait: GaitInAnswers;
  divisions: number;
  grid_side_m: number;
  cells: [number, number][];
  values: ActionValue[] | LandingValue[];
}
/**
 * Page of races.
 */
export interface RacePage {
  /**
   * Cursor of the next page; null on the last page.
   */
  next_cursor: string | null;
  items: (RaceView | DamagedRunView)[];
}
/**
 * Standing of an entry that has been judged on all draws.
 */
export interface RankedEntry {
  /**
   * of the entry.
   */
  number: number;
  /**
   * interquartile mean of the distances over all draws [m].
   */
  iqm_m: number;
  /**
   * its 95 % bootstrap interval [m].
   */
  low_m: number;
  /**
   * its 95 % bootstrap interval [m].
   */
  high_m: number;
  /**
   * the ranks that it may have: 1 + the number of entries that are better and can be told apart from it, and the number of all without those that are worse and can be told apart.
   */
  best_rank: number;
  /**
   * the ranks that it may have: 1 + the number of entries that are better and can be told apart from it, and the number of all without those that are worse and can be told apart.
   */
  worst_rank: number;
  /**
   * numbers, ascending, of the entries of which the 95 % interval of the paired difference of the interquartile means includes 0, to a micrometre.
   */
  not_separable: number[];
  /**
   * on how many draws it could not walk to the end; it counts as 0 m there.
   */
  failures: number;
}
/**
 * A leg of a robot that was read.
 */
export interface ReadLeg {
  /**
   * its number, from 1.
   */
  leg: number;
  /**
   * direction of its place on the torso, anticlockwise from body x.
   */
  azimuth_deg: number;
  /**
   * names of its joints in the file, from the torso to the foot.
   */
  joints: string[];
  /**
   * name of its foot in the file.
   */
  foot: string;
}
/**
 * A body of the file. Positions are of the sketch: x right, y forward, z up, ground at 0.
 */
export interface ReadPart {
  name: string;
  /**
   * number of its leg, from 1; 0 for the torso and what is of no leg.
   */
  leg: number;
  /**
   * what `feet` of the choices calls it; null if it cannot be a foot.
   */
  foot: string | null;
  /**
   * middle of what is drawn of it.
   *
   * @minItems 3
   * @maxItems 3
   */
  at_m: [number, number, number];
  /**
   * its lowest point.
   *
   * @minItems 3
   * @maxItems 3
   */
  low_m: [number, number, number];
}
/**
 * A robot as it was read, before it is stored.
 */
export interface ReadRobot {
  name: string;
  /**
   * which legs move together.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  /**
   * legs of each group of this gait.
   */
  groups: number[][];
  legs: ReadLeg[];
  /**
   * direction in which it walks, anticlockwise from x of its torso in the file.
   */
  forward_deg: number;
  mass_kg: number;
  /**
   * height of the torso's centre above the centres of the feet.
   */
  body_height_m: number;
  /**
   * lowest and highest one that its legs allow; null if it cannot be changed.
   */
  body_heights_m: [number, number] | null;
  /**
   * names of the file's keyframes.
   */
  keyframes: string[];
  /**
   * whether its feet reach a foot grid that suits its size.
   */
  reaches_grid: boolean;
}
/**
 * Why a trial has no result, with its key and its description in words.
 */
export interface Reason {
  key: string;
  label?: string | null;
  reason: string;
}
/**
 * A lane of a recording; `rest_qpos` are the joint positions before the first step.
 */
export interface RecordedLane {
  agent: string;
  training_id: string | null;
  failure: string | null;
  rest_qpos: number[];
  steps: RecordedStep[];
}
/**
 * A recorded step, with the joint positions `qpos` at `time_s` since the motion began.
 */
export interface RecordedStep {
  step: number;
  observation: number[];
  action: [number, number];
  reward_m: number;
  distance_m: number;
  transitions: number;
  decision_s: number;
  time_s: number[];
  qpos: number[][];
}
/**
 * Recording of a race, sufficient to replay it.
 */
export interface RecordingView {
  steps: number;
  lanes: RecordedLane[];
}
/**
 * Something that happened in a run, as a point on its timeline.
 */
export interface ReplayMark {
  kind: "time-out" | "crossing" | "fall" | "disturbance" | "evaluation";
  time_s: number;
  /**
   * from 0; null if it concerns all lanes.
   */
  lane: number | null;
  /**
   * that begins then, or in which a robot fell, from 0.
   */
  step: number | null;
  /**
   * that an evaluation reached.
   */
  distance_m: number | null;
}
/**
 * Plan by which a page plays a run by itself; times are the run's own [s].
 */
export interface ReplayView {
  run_id: string;
  /**
   * of the run whose lanes are shown as ghosts.
   */
  ghost_id: string | null;
  kind: "training" | "race";
  /**
   * that times a race; null for a training.
   */
  clock: ("paper" | "wall" | "free") | null;
  /**
   * whether the run will record no more.
   */
  complete: boolean;
  /**
   * null while it is not known.
   */
  duration_s: number | null;
  /**
   * intervals that can be shown; of a long practice the first and newest steps.
   */
  recorded_s: [number, number][];
  /**
   * for each lane, of its recorded steps.
   */
  step_ends_s: number[][];
  marks: ReplayMark[];
  /**
   * time between two frames of level 0.
   */
  frame_s: number;
  /**
   * number of frames in a segment.
   */
  segment_frames: number;
  /**
   * each level has half as many frames as the one below.
   */
  lowest_level: number;
  highest_level: number;
  /**
   * version of the frames; a segment that is requested with it never changes once it has all its frames.
   */
  version: string;
}
/**
 * The results of a room, by card.
 */
export interface ResultsView {
  code: string;
  /**
   * what the class gains by the lesson; null before the question after it is revealed, but for a teacher.
   */
  gain: GainView | null;
  cards: CardResultsView[];
}
/**
 * What was read from a robot's file, for a person who confirms or corrects it.
 */
export interface RobotReadingView {
  /**
   * of the file, which the server keeps for a while; empty for a body.
   */
  id: string;
  /**
   * name of the file.
   */
  file: string;
  /**
   * path in a zip of what was read; null if it was given alone.
   */
  document: string | null;
  /**
   * paths in a zip of all documents that could be the robot, fit for `choices.file`.
   */
  documents: string[];
  /**
   * values of the arguments of a xacro, fit for `choices.arguments`.
   */
  arguments: {
    [k: string]: string;
  };
  choices: ChoicesOutput;
  /**
   * the robot; null if it cannot be stored as it is.
   */
  robot: ReadRobot | null;
  /**
   * why it cannot be stored; null if it can.
   */
  problem: string | null;
  /**
   * what was guessed and repaired.
   */
  notes: Note[];
  /**
   * bodies of the file.
   */
  parts: ReadPart[];
  /**
   * feet of its legs; of a file without a robot what could be feet.
   */
  feet: SketchFoot[];
  /**
   * it on a turntable, in base64, as `GET /start-line` encodes a scene. Its bodies are the nodes `/world/sketch/part/0`, `…/1`, in the order of `parts`; likewise `…/foot/0`.
   */
  scene: string;
}
/**
 * A foot of a leg, or where no legs were found, what could be one.
 */
export interface SketchFoot {
  /**
   * its name in the file, fit for `Choices.feet`.
   */
  name: string;
  /**
   * number of its leg, from 1; 0 where no legs were found.
   */
  leg: number;
  /**
   * its centre in the frame of the sketch.
   *
   * @minItems 3
   * @maxItems 3
   */
  at_m: [number, number, number];
  /**
   * its radius.
   */
  radius_m: number;
}
/**
 * The rooms that who asks may know: for a teacher all, for a participant their own.
 */
export interface RoomList {
  items: ListedRoom[];
  /**
   * whether phones can reach the server, so that a room can be opened for a class.
   */
  is_reachable: boolean;
}
/**
 * A tournament of a room.
 */
export interface RoomTournament {
  id: string;
  title: string;
  state: "open" | "ending" | "ended";
}
/**
 * A room.
 */
export interface RoomView {
  code: string;
  title: string;
  language: string;
  lesson_id: string | null;
  /**
   * `open`, `frozen`: nothing can be answered or started, or `ended`.
   */
  state: "open" | "frozen" | "ended";
  /**
   * number of the card that is shown, from 0.
   */
  card: number;
  /**
   * number of the lesson's cards.
   */
  cards: number;
  /**
   * numbers of the cards that are revealed.
   */
  revealed: number[];
  /**
   * number of participants who are in the room.
   */
  participants: number;
  /**
   * number of participants who have answered the card that is shown.
   */
  predicted: number;
  /**
   * number of participants who have started a run on it.
   */
  started: number;
  /**
   * whether the card asks what is known before the lesson, or after it; null for cards of the lesson.
   */
  knowledge: ("before" | "after") | null;
  /**
   * id of the run on its stage.
   */
  spotlight: string | null;
  needs_approval: boolean;
  /**
   * of who asks.
   */
  role: "teacher" | "participant" | "spectator";
  shown: Card;
  html: CardTexts;
  /**
   * the participant who asks; null for others.
   */
  me: Me | null;
  /**
   * all participants, for a teacher alone.
   */
  people: Person[];
  /**
   * all of it, for a teacher alone.
   */
  lesson: LessonView | null;
  /**
   * of the room, oldest first.
   */
  tournaments: RoomTournament[];
  /**
   * of its page, for others if they can reach the server.
   */
  address: string;
  /**
   * of the address, an SVG image as a data URI; null if phones cannot reach the server.
   */
  qr_code: string | null;
}
/**
 * Page of runs of every kind.
 */
export interface RunPage {
  /**
   * Cursor of the next page; null on the last page.
   */
  next_cursor: string | null;
  items: ((TrainingView | RaceView | ExperimentView) | DamagedRunView)[];
}
/**
 * Setting `a` compared with setting `b`.
 */
export interface SettingComparisonView {
  a: ComparedView;
  b: ComparedView;
  difference: BootstrappedView;
  improvement: BootstrappedView;
  /**
   * whether both have the same seeds, which were resampled together.
   */
  is_paired: boolean;
  /**
   * number of seeds that only one of two paired settings has.
   */
  left_out: number;
  /**
   * the setting that is ahead, if the interval of the difference excludes 0.
   */
  ahead: "a" | "b" | "not established";
  /**
   * what further seeds would bring.
   */
  outlook: "settled" | "reachable" | "out of reach" | "equal" | "too few seeds";
  /**
   * of each setting, that settle the difference with a chance of 80 % if it is as large as it seems; null where none would.
   */
  further_seeds: number | null;
  /**
   * of the values: metres, half grid sides or shares of greedy's distance.
   */
  unit: "m" | "h" | "greedy";
  /**
   * whether distances are those at time-out.
   */
  is_at_time_out: boolean;
  words: ComparisonWordsView;
}
/**
 * Results of a setting over its seeds.
 *
 * `seed_numbers` are those of the seeds that have a distance, in the order of the points.
 * `is_deterministic`: whether every seed would come equally far.
 */
export interface SettingView {
  steps_per_episode: number | null;
  observation: "measured" | "commanded" | "planned";
  robot: string;
  world?: string;
  agent: string;
  steps: number;
  blocks: number;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
  relative: Interval95 | null;
  relative_finished: Interval95 | null;
  of_best_known?: Interval95 | null;
  walkers: SharedBy | null;
  beats_greedy: Beats | null;
  beats_greedy_total: Beats | null;
  reaches_greedy: SharedBy | null;
  key: string;
  role: "learner" | "reference";
  gait: string;
  n: number;
  seed_numbers?: number[] | null;
  is_deterministic?: boolean | null;
  failed: number;
  total: Distances | null;
  finished: Distances | null;
  elapsed_s: number | null;
  published: PublishedView | null;
  best_known_m?: number | null;
  [k: string]:
    | number
    | string
    | boolean
    | null
    | "measured"
    | "commanded"
    | "planned"
    | Interval95
    | SharedBy
    | Beats
    | "learner"
    | "reference"
    | number[]
    | Distances
    | PublishedView
    | undefined;
}
/**
 * Limits of the 95 % intervals of 0, 1, … of a number of seeds, as shares of them.
 */
export interface ShareLimits {
  seeds: number;
  low: number[];
  high: number[];
}
/**
 * Spectators' address with its QR code, or the reason why there is none.
 */
export interface SpectatorsView {
  address: string | null;
  /**
   * SVG image as a data URI.
   */
  qr_code: string | null;
  reason: string;
  watching: number;
}
/**
 * A leg of a stored robot.
 */
export interface StoredLeg {
  /**
   * number of the leg, from 1.
   */
  leg: number;
  /**
   * direction of its place on the torso, anticlockwise from body x.
   */
  azimuth_deg: number;
  /**
   * names of its joints, from the torso to the foot.
   */
  joints: string[];
}
/**
 * A stored robot.
 */
export interface StoredRobotView {
  /**
   * id of its content: the same robot has the same id on every server.
   */
  id: string;
  /**
   * no other robot here has it.
   */
  name: string;
  /**
   * whether it is left out where a robot is chosen.
   */
  hidden: boolean;
  /**
   * gait that suits the robot.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  /**
   * of a robot from a file: what was guessed, in sentences.
   */
  guesses: string[];
  /**
   * likewise, what was repaired.
   */
  repairs: string[];
  /**
   * likewise, what a person has corrected.
   */
  choices: {
    [k: string]: unknown;
  } | null;
  /**
   * name of the file that it is from; null if it was made here.
   */
  file: string | null;
  /**
   * in UTC.
   */
  created_at: string;
  /**
   * legs of each group of this gait.
   */
  groups: number[][];
  legs: StoredLeg[];
}
/**
 * Stored robots, in the order in which they were stored.
 */
export interface StoredRobotsView {
  items: StoredRobotView[];
}
/**
 * Number of trials by outcome, with the reasons of those that failed or were set aside.
 *
 * `failed` counts both; `done` are all with a result, also those whose walk failed.
 */
export interface SummaryCounts {
  done: number;
  total: number;
  failed: number;
  failures?: Reason[];
  set_aside: Reason[];
}
/**
 * Summary of an experiment's trials so far.
 */
export interface SummaryView {
  format: number;
  experiment: string;
  config: ExperimentConfig;
  versions: {
    [k: string]: string;
  };
  machine: Machine;
  trials: SummaryCounts;
  cost: Cost | null;
  /**
   * names of what is varied beside place and agent.
   */
  parameters: string[];
  settings: SettingView[];
  pooled: PooledView[];
  curves: CurveOfSetting[];
  versus: VersusView[];
  timed: TimedView[];
  worlds?: WorldView[];
  claims: ClaimView[];
  story: NarrativeSection[];
  /**
   * limits of shares of seeds, by which performance profiles have their bands.
   */
  share_limits?: ShareLimits[];
  /**
   * what came of it, in a sentence; empty where its claims say it.
   */
  finding?: string;
}
/**
 * Probability that agent `a` walks farther than agent `b`, with its 95 % interval.
 */
export interface VersusView {
  steps_per_episode: number | null;
  gait: string;
  observation: "measured" | "commanded" | "planned";
  robot: string;
  world?: string;
  steps: number;
  blocks: number;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
  a: string;
  b: string;
  probability: number;
  low: number | null;
  high: number | null;
  verdict: "yes" | "no" | "not established";
  [k: string]:
    | number
    | string
    | boolean
    | null
    | "measured"
    | "commanded"
    | "planned"
    | "yes"
    | "no"
    | "not established"
    | undefined;
}
/**
 * A race that was measured by the wall clock.
 */
export interface TimedView {
  gait: string;
  observation: "measured" | "commanded" | "planned";
  robot: string;
  lanes: WallLane[];
}
/**
 * A lane of a race that was measured by the wall clock.
 */
export interface WallLane {
  agent: string;
  decision_s: number;
  finished_distance_m: number;
  elapsed_s: number;
  rank: number;
}
/**
 * An agent in a world of a league or recovery, and the walks of its references [m].
 */
export interface WorldView {
  steps_per_episode: number | null;
  observation: "measured" | "commanded" | "planned";
  robot: string;
  world?: string;
  agent: string;
  steps: number;
  blocks: number;
  divisions: number;
  grid_side_m: number;
  half_side_m: number;
  key: string;
  role: "learner" | "reference";
  gait: string;
  plans_with: ("world" | "start" | "nominal") | null;
  n: number;
  greedy_m: number | null;
  greedy_nominal_m: number | null;
  best_known_m: number | null;
  distance: Interval95;
  of_greedy: Interval95 | null;
  of_best_known: Interval95 | null;
  curve: Curve | null;
  mean_m: Interval95 | null;
  until_greedy: Until | null;
  until_best_known: Until | null;
  earned: Curve | null;
  [k: string]:
    | number
    | string
    | boolean
    | null
    | "measured"
    | "commanded"
    | "planned"
    | "learner"
    | "reference"
    | "world"
    | "start"
    | "nominal"
    | Interval95
    | Curve
    | Until
    | undefined;
}
/**
 * Steps until a share (`of`) of a reference's distance; null if most seeds never get there.
 */
export interface Until {
  of: number;
  median_steps: number | null;
  reached: number;
  low: number | null;
  high: number | null;
}
/**
 * Values, visits and best actions of states: a row a state, in the order of their cells.
 */
export interface TableView {
  pairs: number[][];
  cells_m: [number, number][];
  cell_names: string[];
  step: number;
  /**
   * number of all states.
   */
  states: number;
  first: number;
  /**
   * action values [m], pair by pair; null where illegal.
   */
  values: (number | null)[][];
  /**
   * how often each was tried; a value without a try is no estimate.
   */
  visits: (number | null)[][];
  best: [number, number][];
  /**
   * of a learner that keeps one value for each landing, which all actions share that end with the feet there; null for others, and where there are too many for an answer.
   */
  landings: LandingsView | null;
}
/**
 * A robot of a teaching.
 */
export interface TaughtRobot {
  /**
   * id of its training.
   */
  run_id: string;
  /**
   * how far it walks in 50 steps now that it has learned [m]: in the race of both as soon as that is computed; null before the reveal, but for a teacher.
   */
  distance_m: number | null;
}
/**
 * How the class of a room teaches a robot on the card that is shown.
 */
export interface TeachingView {
  card: number;
  /**
   * `ready`: nothing was started; `teaching`: presses count; `frozen`; `ended`.
   */
  state: "ready" | "teaching" | "frozen" | "ended";
  /**
   * number of steps of the robot.
   */
  steps: number;
  /**
   * duration of one in the run's own time [s].
   */
  step_s: number;
  /**
   * by step, oldest first.
   */
  presses: StepPresses[];
  /**
   * the robot of the class, and the one that learns from the reward.
   */
  taught: TaughtRobot | null;
  /**
   * the robot of the class, and the one that learns from the reward.
   */
  rival: TaughtRobot | null;
  /**
   * id of the race of both; null before the reveal.
   */
  race_id: string | null;
}
/**
 * A lane's distance over time: points are [s, m], decision intervals are [from s, to s].
 *
 * Of a lane of more than 2,000 steps, `stride` steps together are told as one: it decides on all
 * of them, then walks.
 */
export interface TimelineLane {
  agent: string;
  training_id: string | null;
  color: string;
  /**
   * that it has taken so far.
   */
  steps: number;
  /**
   * number of steps told as one; 1 in all but long races.
   */
  stride: number;
  points: [number, number][];
  thinking: [number, number][];
  futures: number[];
  crossed_s: number | null;
  total_s: number;
  failure: string | null;
}
/**
 * Timeline of a race under one clock.
 */
export interface TimelineView {
  clock: "paper" | "wall" | "free";
  steps: number;
  finish_line_m: number;
  first_finish_s: number | null;
  lanes: TimelineLane[];
}
/**
 * The tournaments that who asks may know, newest first.
 */
export interface TournamentList {
  items: ListedTournament[];
}
/**
 * Rules of a tournament: the walking problem, the secret draws, and what an entry may choose.
 */
export interface TournamentRules {
  /**
   * a named gait, or a gait given by its groups of legs.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  robot: RobotInAnswers;
  /**
   * `mujoco` (physics) or `kinematic` (ideal, no slip).
   */
  simulator: "mujoco" | "kinematic";
  /**
   * Points along each side of the foot grid: more choices, more to learn.
   */
  divisions: number;
  /**
   * Side of the square in which each foot may be put; every leg must reach all of it.
   */
  grid_side_m: number;
  /**
   * what happens to the robot and the ground, by step.
   *
   * Items: A disturbance from a step on; the fields of its kind are further members.
   */
  disturbances: {
    kind: string;
    at_step: number;
    [k: string]: number | string | null | number[];
  }[];
  /**
   * How far the robot that the seed draws differs from its design, as a share.
   */
  tolerance: number;
  /**
   * Displacement that a step's reward is: along the robot's own heading (default), or along the track, so that a robot that turns earns no more than it advances.
   */
  reward: "forward" | "track";
  /**
   * The most that an entry practises on each draw.
   */
  steps: number;
  /**
   * Draws on which each entry is judged; each has a world.
   */
  draws: number;
  /**
   * names of worlds, or disturbances as on the command line, of which each draw has one.
   */
  worlds: string[];
  /**
   * creatures that an entry may choose beside `robot`.
   */
  robots: RobotInAnswers[];
  /**
   * gait of each of `robots`, in order; empty for those that suit them, which are then written out, since what suits a stored robot is not known everywhere.
   */
  gaits: GaitInAnswers[];
  /**
   * whether a trained table may enter.
   */
  tables: boolean;
  /**
   * The most on each draw; over it, the search has failed there.
   */
  transitions: number;
}
/**
 * A tournament, as who asks may see it.
 */
export interface TournamentView {
  id: string;
  title: string;
  /**
   * code of its room; null without one.
   */
  room: string | null;
  /**
   * `open` for entries; `ending` until those that wait are judged; or `ended`.
   */
  state: "open" | "ending" | "ended";
  rules: TournamentRules;
  /**
   * SHA-256 of the secret, from which the draws follow.
   */
  commitment: string;
  /**
   * entries of a participant within an hour.
   */
  entries_per_hour: number;
  created_at: string;
  ended_at: string | null;
  /**
   * of its page, for others if they can reach the server.
   */
  address: string;
  /**
   * of the address, an SVG image as a data URI; null if phones cannot reach the server.
   */
  qr_code: string | null;
  /**
   * in the order of their numbers.
   */
  entries: EntryView[];
  /**
   * of the entries that are judged on all draws, best first.
   */
  standings: RankedEntry[];
  own: OwnEntries;
  /**
   * whether the reader is one, and may delete it.
   */
  is_operator: boolean;
  /**
   * whether the reader may end it.
   */
  may_end: boolean;
  /**
   * null until the end.
   */
  secret: string | null;
  /**
   * null until the end.
   */
  draws: Draw[] | null;
  /**
   * path of the file with all of it; null until the end.
   */
  file: string | null;
}
/**
 * Page of trainings.
 */
export interface TrainingPage {
  /**
   * Cursor of the next page; null on the last page.
   */
  next_cursor: string | null;
  items: (TrainingView | DamagedRunView)[];
}
/**
 * Result of a trial; `distances_m` after each block.
 */
export interface TrialFigures {
  distances_m: number[];
  finished_distance_m: number | null;
  elapsed_s: number | null;
  transitions: number;
  wall: WallLane[] | null;
  failure: string | null;
  earned_m?: number[];
}
/**
 * A trial; its key is the setting, `#` and the seed's number.
 */
export interface TrialRow {
  key: string;
  result: TrialFigures | null;
  set_aside: string | null;
  compute_s: number;
}
/**
 * The trials so far.
 */
export interface TrialsView {
  trials: TrialRow[];
}
/**
 * The visitors of a demo, those who have started last first.
 */
export interface VisitorList {
  items: VisitorView[];
}
/**
 * A visitor of a demo, of whom nothing but this is known.
 */
export interface VisitorView {
  /**
   * beginning of the hash of the key in the visitor's cookie.
   */
  id: string;
  /**
   * when the oldest of the runs was made.
   */
  since: string;
  /**
   * when the newest was.
   */
  newest: string;
  /**
   * that were started within the hour before that.
   */
  steps: number;
  /**
   * ids of the runs, oldest first; some may have been deleted.
   */
  runs: string[];
}
/**
 * A stored robot with all its numbers, and a preview of its walk.
 *
 * The preview is with its gait, on a foot grid that suits its size.
 */
export interface WholeRobotView {
  /**
   * id of its content: the same robot has the same id on every server.
   */
  id: string;
  /**
   * no other robot here has it.
   */
  name: string;
  /**
   * whether it is left out where a robot is chosen.
   */
  hidden: boolean;
  /**
   * gait that suits the robot.
   */
  gait:
    | (
        | "left-right-origin"
        | "left-right-vertical"
        | "front-back-origin"
        | "front-back-vertical"
        | "tripod"
        | "tetrapod"
        | "trot"
        | "pace"
        | "bound"
        | "one-by-one"
      )
    | {
        right_leg: number;
        left_leg: number;
        symmetry?: "origin" | "vertical";
        pairs?: [number, number][];
        groups?: ("tripod" | "tetrapod" | "trot" | "pace" | "bound" | "one-by-one") | [number, ...number[]][];
      };
  /**
   * of a robot from a file: what was guessed, in sentences.
   */
  guesses: string[];
  /**
   * likewise, what was repaired.
   */
  repairs: string[];
  /**
   * likewise, what a person has corrected.
   */
  choices: {
    [k: string]: unknown;
  } | null;
  /**
   * name of the file that it is from; null if it was made here.
   */
  file: string | null;
  /**
   * in UTC.
   */
  created_at: string;
  /**
   * legs of each group of this gait.
   */
  groups: number[][];
  legs: StoredLeg[];
  /**
   * the robot by value, as a request may have it.
   */
  robot: {
    [k: string]: unknown;
  };
  preview: Preview;
  /**
   * findings in its file; null if it was made here.
   */
  found: FoundView | null;
}
