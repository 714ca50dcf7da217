/** Short names of the API's types, and the few types that only the page has. */

import type { ReadonlySignal } from "@preact/signals";
import type { FunctionComponent } from "preact";
import type * as Api from "./api-types.js";

export type {
  ActionValue,
  AgentOption as Agent,
  AllowanceView as Allowance,
  Ask,
  BeliefView as Belief,
  Bounds,
  CardResultsView as CardResults,
  Change,
  ClaimView,
  Curve as ScoredCurve,
  CurveOfSetting,
  CurvesView as Curves,
  CurveView as Curve,
  ComparisonView as WhatIfAnswer,
  DamagedRunView as DamagedRun,
  Described,
  Distances,
  DisturbanceOption as DisturbanceKind,
  EstimateView as Estimate,
  Evaluation,
  EventBodies,
  ExportOption,
  ExplanationView as Explanation,
  LossView as Loss,
  FieldOption,
  Finding,
  GaitAnalysis,
  GaitFigures,
  GaitLane,
  GainView as Gain,
  GaitOption as Gait,
  Interval95 as Interval,
  JoinedView as Joined,
  LaneResult,
  LessonList,
  LessonView,
  ListedLesson,
  ListedRoom,
  NarrativeSection,
  NewLesson,
  NewRoom,
  OptionsView as Options,
  Person,
  PooledView,
  Playhead,
  Preview,
  ReplayMark,
  ReplayView as ReplayPlan,
  QTableView as QTable,
  ResultEntry,
  ResultsView as Results,
  RoomState,
  RoomView as Classroom,
  RobotOption as Robot,
  StepPresses,
  TeachingEvent,
  TeachingView as TeachingState,
  StoredRobotView as StoredRobot,
  WholeRobotView as WholeRobot,
  FoundView as Found,
  SceneActionValues as ActionValues,
  SceneLane,
  SceneView as Scene,
  SettingOption,
  SettingView as Setting,
  SeedsView as WhatIfHalf,
  SpectatorsView as Spectators,
  SettingComparisonView as SettingComparison,
  SummaryView as Summary,
  TableView as StateTable,
  ListedTournament,
  OwnEntries,
  Judgement,
  RankedEntry,
  TournamentList,
  TournamentEvent,
  TimelineLane,
  TrialRow as Trial,
  Until,
  ValueUpdateView as ValueUpdate,
  VersusView,
  WallLane,
  WorldView,
} from "./api-types.js";

// ---- runs: the page lists all kinds together, and asks `kind` before it reads what only one kind has

type NameIn<Union> = Union extends unknown ? keyof Union : never;
type MemberOf<Union, Name> = Union extends unknown ? (Name extends keyof Union ? Union[Name] : never) : never;
/** The members of all types of a union, each of the type that it has where it is. */
type Merged<Union> = { [Name in NameIn<Union>]: MemberOf<Union, Name> };

type AnyRun = Api.TrainingView | Api.RaceView | Api.ExperimentView;
type WalkConfig = Merged<Api.TrainingConfigView | Api.RaceConfigView>;
/** Some of its fields are looked up by their names. */
export type RunConfig = WalkConfig & Omit<Api.ExperimentConfig, keyof WalkConfig> & { [field: string]: unknown };
export type RunResult = Merged<Api.TrainingResult | Api.RaceResult | Api.ExperimentResult>;
export type Run = Omit<Merged<AnyRun>, "config" | "result"> & { config: RunConfig; result: RunResult | null };
export type Kind = AnyRun["kind"];
export type State = AnyRun["state"];
export type Verb = "stop" | "pause" | "resume";
export type Clock = Api.TimelineView["clock"];
/** The stage that all pages share. */
export type Stage = Api.StageView;
/** What is played, and how: the stage, or a replay of this page's own. */
export type Playback = Pick<
  Stage,
  "next_run_id" | "phase" | "origin" | "playing" | "ended" | "speed" | "clock" | "end_at_time_out" | "announced" | "run_id"
>;
export type Presentation = Api.PresentationView;
/** A timeline, with the id of its race. */
export type Timeline = Api.TimelineView & { id: string };
export type ClockResult = Api.FiguresUnderClock;
/** Something that happens; its fields but the first two depend on its kind. Legs are numbered from 1. */
export type Disturbance = Api.TrainingConfigView["disturbances"][number] & { until_step?: number | null; leg?: number; legs?: number[] };
/** A lane as it was started, or as the form starts it. */
export type LaneConfig = Pick<Api.LaneView, "agent"> &
  Partial<Omit<Api.LaneView, "observation">> & { observation?: string };
export type SettingValue = Api.SettingOption["default"];
export type Limits = Pick<Api.SettingOption, "minimum" | "maximum" | "excludes_minimum" | "excludes_maximum">;
export type TimelinePoint = Api.TimelineLane["points"][number];
export type Move = Api.ExplanationView["action"];
export type FootCells = Pick<Api.ExplanationView, "pairs" | "cells_m" | "cell_names">;
/** What users say of a run. */
export type Annotations = Partial<Pick<AnyRun, "name" | "tags" | "notes">>;
/** Robot, observation and grid, within which agents are compared. */
export type Place = Pick<
  Api.SettingView,
  "key" | "observation" | "robot" | "divisions" | "grid_side_m" | "half_side_m"
>;
/** Values of the pace and of live settings by name. */
export type Rates = Record<string, SettingValue>;

export type Page<Item> = Omit<Api.RunPage, "items"> & { items: Item[] };

/** The name of a preset or the id of a stored robot, or an object with either and what differs from it. */
export type RobotConfig = string | { preset?: string; id?: string; name?: string; [part: string]: unknown };
/** What a person decides about a robot from a file. */
export interface RobotChoices {
  forward?: string | number;
  feet?: string[];
  keyframe?: string;
  home_rad?: Record<string, number>;
  servo_torque_nm?: number;
  servo_kp?: number;
}
/** A gait by the legs between which forward is, and one of the others: groups are legs, or the name of a rule. */
export interface GaitParts {
  right_leg: number;
  left_leg: number;
  symmetry?: string;
  pairs?: number[][];
  groups?: number[][] | string;
}
/** The name of a gait, or its parts. */
export type GaitConfig = string | Partial<GaitParts>;

// ---- events of elements, as their handlers read them

export interface Changed {
  target: HTMLInputElement;
}
export interface Toggled {
  target: HTMLDetailsElement;
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

/** A kind of experiment; its defaults are those of the form. */
export type ExperimentKind = Omit<Api.ExperimentOption, "defaults"> & { defaults: ExperimentValues };
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

// ---- lessons, as they are written: what is absent has its default

/** All members may be absent or null, at any depth. */
type Loose<Value> = Value extends (infer Item)[] ? Loose<Item>[]
  : Value extends object ? { [Name in keyof Value]?: Loose<Value[Name]> | null } : Value;
/** A card of a lesson, as it is sent and stored. */
export type LessonCard = { text: string, may?: Record<string, Partial<Api.Bounds>>, ask?: Api.Ask | null }
  & Omit<Loose<Api.Card>, "text" | "may" | "ask">;
/** A lesson, as it is sent. */
export type LessonDocument = Omit<Api.GivenLesson, "cards"> & { cards: LessonCard[] };

// ---- tournaments

/** Robots are names, ids, or objects. */
export type Tournament = Omit<Api.TournamentView, "rules" | "entries"> & {
  rules: TournamentRules, entries: TournamentEntry[], is_operator: boolean,
};
export type TournamentRules = Omit<Api.TournamentView["rules"], "robot" | "robots" | "gait"> & {
  robot: RobotConfig, robots: RobotConfig[], gait: GaitConfig,
};
export type TournamentEntry = Omit<Api.EntryView, "entry"> & { entry: EnteredAgent | null };
/** An entry, as it is judged. */
export type EnteredAgent = Omit<NonNullable<Api.EntryView["entry"]>, "robot"> & { robot?: RobotConfig | null };

// ---- features: what each can add to the page; all members but the name are optional

/** A module of the feature and what it exports, as "components/gait.js#Gait". */
export type FeatureSource = string;

/** A component that is loaded when it is first seen. */
export interface LoadedPart {
  show: FeatureSource;
  /** What the page calls it while it loads. */
  loading: string;
  /** Whether the page says nothing while it comes. */
  isQuiet?: boolean;
  /** Its style sheet, from the feature's folder. */
  style?: string;
}
export interface TabKind {
  title: string;
  /** The least depth that offers it: "watch", "try" or "study". */
  depth: string;
  /** Its place among the tabs, from left to right. */
  order: number;
  about: string;
  /** Whether Watch shows it too, with a way back, though it lists no tabs. */
  isInWatch?: boolean;
}
/** A view; the server has the page at its name too, as `/lessons`. */
export interface ViewPart extends LoadedPart {
  title: string;
  /** Whether the header has a link to it. */
  isInHeader?: boolean;
}
/** What is shown in place of the panel while a field of the page's state is set. */
export interface PanelPart extends LoadedPart {
  /** Who has it; everybody without one. */
  for?: "operator";
}
/** What a key of the view of the race does: it calls a function of a module that it loads. */
export interface FeatureKey {
  call: FeatureSource;
  /** The field of the page's state that must be set. */
  while?: string;
  /** What the help says of it; it lists no others. */
  does?: string;
}
export interface MenuRow {
  title: string | (() => string);
  /** The group of the page's menu in which it stands: `share`, `class`, `page`, or `help`; `page` without one. */
  group?: string;
  /** Its place among the rows of features. */
  order?: number;
  icon?: string;
  /** What the button says of itself that it has in the header too, at once: what is loaded later moves the others. */
  headerHint?: string;
  /** Who has it; everybody without one. */
  for?: "operator";
  /** Where it leads, or else what it does: loads a dialog, calls a function of a module that it loads, or runs. */
  href?: string;
  dialog?: string;
  call?: FeatureSource;
  run?: () => unknown;
}
/** What is put in a place of the core: a component that is there, or one that is loaded. */
export type SlotPart = LoadedPart | { component: FunctionComponent<any> };
/** A field of the page's state; `part`: "query", or the name of a view. */
export interface DeclaredField {
  part: string;
  /** Its name in the address; null for all that no other field of the part has. */
  name: string | null;
  is: "text" | "list" | "flag" | "whole" | "texts";
  initial?: unknown;
  /** Whether a change is a new entry of the history. */
  isEntry?: boolean;
}
/** The fields that features declare, with their types: each adds its own by an interface of this name. */
export interface FieldsOfFeatures {}
/** What is told of runs that are no trainings and no races. */
export interface RunKind {
  /** Several of them: "Experiments". */
  plural: string;
  /** Of what its progress is: "Trials". */
  unit: string;
  titleOf: (run: Run) => string;
  describe: (run: Run) => string;
  /** How far it is: as a share, in words, and how long it still takes. */
  paceOf: (run: Run) => { share: number, label: string, left: string };
  /** What the page shows of it: fields of its state. */
  stateOf: (id: string | null) => Record<string, unknown>;
  /** Its files: [label, address]. */
  downloads: (run: Pick<Run, "id">) => [string, string][];
}
/** Cards that are shown one after the other. */
export interface Deck {
  cards: ReadonlySignal<DeckCard[]>;
  /** The number of the open card, from 1; null without one. */
  number: ReadonlySignal<number | null>;
  open: (number: number) => void;
  /** The question of the open card. */
  Question: FunctionComponent;
}
export interface DeckCard {
  title: string;
  text: string;
  /** Whether it asks something, and of what. */
  ask?: "lane";
}

/** A feature, as `feature.json` declares it; `feature.js` adds what cannot be written in JSON. */
export interface Feature {
  /** That of its folder. */
  name: string;
  /** Whether it has a `feature.js`, which runs from the start. */
  hasCode?: boolean;
  /** The role of pages that alone run its code. */
  codeFor?: string;
  /** Names of the features without which it does not work. */
  needs?: string[];
  /** Names of the features of which it shows something, where they are there. */
  uses?: string[];
  fields?: Record<string, DeclaredField>;
  /** Parts of the page that a link can hide. */
  hideable?: string[];
  tabs?: Record<string, TabKind & LoadedPart>;
  views?: Record<string, ViewPart>;
  dialogs?: Record<string, LoadedPart>;
  /** By the field of the page's state. */
  panels?: Record<string, PanelPart>;
  /** What files are for that are dropped on the page, or pasted; an operator's. */
  files?: { words: string; call: FeatureSource };
  /** By the key; Escape leaves what is on top. */
  keys?: Record<string, FeatureKey>;
  /** By a field of the page's state: what is loaded and called once, when the field is first set. */
  whenSet?: Record<string, FeatureSource>;
  menu?: MenuRow[];
  /** Rows of the menu of each run; what they call gets the run. */
  runMenu?: MenuRow[];
  /** By the name of the place. */
  slots?: Record<string, SlotPart>;

  /** Runs once, before the page is drawn; the address has been read. */
  follow?: () => unknown;
  /** Runs once, when the server's options are there. */
  withOptions?: () => void;
  /** Handlers of events of the server, by their names. */
  events?: Record<string, (data: any) => void>;
  hidesTab?: (tab: string) => boolean;
  /** Kinds of runs besides trainings and races, by their names. */
  kinds?: Record<string, RunKind>;
  deck?: Deck;
  /** Who starts runs of their own here, without being an operator. */
  guest?: { isHere: ReadonlySignal<boolean>, runs: ReadonlySignal<string[]> };
  /** Called with each run that this page starts. */
  started?: (run: Run) => void;
}
