// The runs of the list in groups: those that differ in few settings, a race with its trainings, or those of a day.
import { folded } from "./runs.js";
import { canonical } from "./robots.js";
import { commonInWords, differenceInWords, fieldsOf, titleOfSweep, variedIn } from "./run-settings.js";
import { beginning, factsOf, isNamed, titleOf } from "./run-words.js";

/** @import { AnyRun } from "./runs.js" */
/** @import { Fields } from "./run-settings.js" */
/** @import { Run } from "./types.js" */

/**
 * A run, its name in the group, and what is told beside it.
 * @typedef {{ run: AnyRun, name: string, facts: string[] }} Row
 */
/**
 * `title` is empty where a group needs none; `facts` are what all its runs have in common. `isSweep`: whether names are
 * what its runs differ in.
 * @typedef {{ key: string, title: string, facts: string[], rows: Row[], isSweep: boolean }} Group
 */

/** @type {(key: string, title: string, runs: AnyRun[], facts?: string[]) => Group} */
const groupOf = (key, title, runs, facts = []) =>
  ({ key, title, facts, isSweep: false, rows: runs.map((run) => aloneRow(run, facts)) });

/** @type {(run: AnyRun, told: string[]) => Row} */
const aloneRow = (run, facts) => ({
  run, name: titleOf(run), facts: "damaged" in run ? [] : factsOf(run).filter((fact) => !facts.includes(fact)),
});

/**
 * @template Item
 * @param {Item[]} items
 * @param {(item: Item) => string} keyFor
 */
function groupedBy(items, keyFor) {
  /** @type {Map<string, Item[]>} */
  const groups = new Map();
  for (const item of items) {
    const key = keyFor(item);
    groups.set(key, [...groups.get(key) ?? [], item]);
  }
  return groups;
}

// ---- by sweep: sets of trainings, or of races, that differ in one field, or fill a grid of two

/** Share of a grid's cells that runs fill. */
const MIN_FILLED = 0.8;
/** A grid of two by two. */
const MIN_GRID = 4;

/** A run with the keys of its fields. @typedef {{ run: Run, fields: Fields }} Known */
/** Runs that differ only in some fields. @typedef {{ varied: string[], members: Known[] }} Sweep */

/** @type {(one: Known, name: string) => string} */
const keyOf = ({ fields }, name) => fields[name]?.key ?? "";

/** Number of different settings. @type {(members: Known[], names: string[]) => number} */
const distinct = (members, names) =>
  new Set(members.map((member) => canonical(names.map((name) => keyOf(member, name))))).size;

/** Whether runs differ in a field, or fill most of a grid of two. @param {Sweep} sweep */
function isSweep({ varied, members }) {
  const sizes = varied.map((name) => distinct(members, [name]));
  if (sizes.some((size) => size < 2)) return false;
  const cells = sizes.reduce((product, size) => product * size, 1);
  const filled = distinct(members, varied);
  return varied.length === 1 || (filled >= MIN_GRID && filled >= MIN_FILLED * cells);
}

/**
 * Every sweep of these fields among runs.
 * @type {(known: Known[], all: string[], varied: string[]) => Sweep[]}
 */
function sweepsOver(runs, all, varied) {
  const fixed = all.filter((name) => !varied.includes(name));
  const groups = groupedBy(runs, (entry) => fixed.map((name) => keyOf(entry, name)).join("\n"));
  return [...groups.values()].map((members) => ({ varied, members })).filter(isSweep);
}

/** A sweep of these tells least: it comes after others of the same size. */
const LAST = ["agent", "lanes", "gait", "world", "seed", "practice_seed", "before", "changes"];

/**
 * The more values the better, then the fewer fields, then settings before all else.
 * @type {(a: Sweep, b: Sweep) => number}
 */
const byWorth = (a, b) =>
  distinct(b.members, b.varied) - distinct(a.members, a.varied) || a.varied.length - b.varied.length
  || LAST.indexOf(a.varied[0]) - LAST.indexOf(b.varied[0]);

/**
 * Sweeps, each run in one at most.
 * @param {Run[]} runs
 */
export function sweepsOf(runs) {
  const entries = runs.map((run) => ({ run, fields: fieldsOf(run) }));
  const all = variedIn(entries.map(({ fields }) => fields));
  const single = all.flatMap((name) => sweepsOver(entries, all, [name]));
  const names = [...new Set(single.flatMap(({ varied }) => varied))];
  const pairs = names.flatMap((name, at) => names.slice(at + 1).map((other) => [name, other]));
  const waiting = [...single, ...pairs.flatMap((pair) => sweepsOver(entries, all, pair))];
  const taken = new Set();
  /** @type {Sweep[]} */
  const chosen = [];
  while (waiting.length) {
    waiting.sort(byWorth);
    const [sweep] = waiting.splice(0, 1);
    const members = sweep.members.filter(({ run }) => !taken.has(run.id));
    if (members.length === sweep.members.length) {
      members.forEach(({ run }) => taken.add(run.id));
      chosen.push(sweep);
    } else if (isSweep({ ...sweep, members })) waiting.push({ ...sweep, members });
  }
  return chosen;
}

/**
 * A sweep as a group, its runs named by what differs, in the order of the list.
 * @param {Sweep} sweep
 * @returns {Group}
 */
function groupOfSweep({ varied, members }) {
  const all = members.map(({ fields }) => fields);
  const rows = members.map(({ run, fields }) => {
    const difference = beginning(differenceInWords(fields, varied));
    return isNamed(run) ? { run, name: titleOf(run), facts: [difference] } : { run, name: difference, facts: [] };
  });
  const [{ run: first }] = members;
  // Of all that would be a group of these fields, the one with this run.
  const key = `sweep ${varied.join(" ")} ${members.map(({ run }) => run.id).toSorted()[0]}`;
  return { key, title: titleOfSweep(first, varied), facts: commonInWords(all, varied), rows, isSweep: true };
}

/** Numbers by size; 0 for all else. @type {(a: unknown, b: unknown) => number} */
const bySize = (a, b) => (typeof a === "number" && typeof b === "number" ? a - b : 0);

/**
 * Runs that are compared: those of one sweep by its values, all others in the order that they have.
 * @param {AnyRun[]} runs
 */
export function byValue(runs) {
  if (runs.some((run) => "damaged" in run)) return runs;
  const [sweep] = sweepsOf(/** @type {Run[]} */ (runs));
  if (sweep?.members.length !== runs.length) return runs;
  const compare = (/** @type {Known} */ a, /** @type {Known} */ b) => sweep.varied
    .map((name) => bySize(a.fields[name]?.value, b.fields[name]?.value)).find((difference) => difference !== 0) ?? 0;
  return sweep.members.toSorted(compare).map(({ run }) => run);
}

/** @param {AnyRun[]} runs */
function bySweep(runs) {
  const whole = runs.filter((run) => !("damaged" in run));
  const sweeps = ["training", "race"].flatMap((kind) =>
    sweepsOf(/** @type {Run[]} */ (whole.filter((run) => run.kind === kind))));
  /** @type {Map<string, Group>} */
  const groupByRun = new Map();
  for (const sweep of sweeps) {
    const group = groupOfSweep(sweep);
    sweep.members.forEach(({ run }) => groupByRun.set(run.id, group));
  }
  return inOrder(runs, (run) => groupByRun.get(run.id) ?? null);
}

/**
 * Groups in the order of their first runs; runs that are in none stand between them, by themselves.
 * @type {(runs: AnyRun[], groupFor: (run: AnyRun) => Group | null) => Group[]}
 */
function inOrder(runs, groupFor) {
  /** @type {Set<Group>} */
  const seen = new Set();
  /** @type {AnyRun[] | null} */
  let alone = null;
  /** @type {(Group | AnyRun[])[]} */
  const parts = [];
  for (const run of runs) {
    const group = groupFor(run);
    if (group && seen.has(group)) continue;
    if (group) {
      seen.add(group);
      parts.push(group);
      alone = null;
    } else if (alone) alone.push(run);
    else parts.push((alone = [run]));
  }
  return parts.map((piece) => (Array.isArray(piece) ? groupOf(`alone ${piece[0].id}`, onItsOwn(piece), piece) : piece));
}

/** @param {AnyRun[]} runs */
const onItsOwn = ({ length }) => (length === 1 ? "On its own" : "On their own");

// ---- by race: a race with its branches and its trainings

/** @type {(race: Run) => string[]} */
const trainingsOf = ({ config }) => (config.lanes ?? []).flatMap(({ training_id }) => training_id ?? []);

/**
 * The race to which a run belongs: itself, the one from which it branches off, or the first that used its table.
 * @param {AnyRun} run
 * @param {Map<string, Run>} races by the ids of their trainings and of themselves
 */
function raceOf(run, races) {
  let race = races.get(run.id) ?? null;
  const seen = new Set();
  while (race && !seen.has(race.id)) {
    seen.add(race.id);
    const original = races.get(race.config.branch_from?.race_id ?? "");
    if (!original || original.kind !== "race") break;
    race = original;
  }
  return race;
}

/** @type {(runs: AnyRun[], everyRun: Run[]) => Group[]} */
function byRace(runs, everyRun) {
  /** @type {Map<string, Run>} */
  const races = new Map();
  // Not to another race, each time that it races again.
  for (const race of everyRun.filter(({ kind }) => kind === "race").toReversed()) {
    for (const id of [race.id, ...trainingsOf(race)]) if (!races.has(id)) races.set(id, race);
  }
  /** @type {Map<string, Group>} */
  const groups = new Map();
  const raceOfRun = new Map(runs.map((run) => [run.id, raceOf(run, races)]));
  for (const race of new Set([...raceOfRun.values()].filter((item) => item !== null))) {
    const members = runs.filter((run) => raceOfRun.get(run.id) === race);
    const group = groupOf(`race ${race.id}`, titleOf(race), members, factsOf(race));
    const rows = group.rows.map((row) => (row.run.id === race.id ? { ...row, name: "The race" } : row));
    groups.set(race.id, { ...group, rows });
  }
  return inOrder(runs, (run) => groups.get(raceOfRun.get(run.id)?.id ?? "") ?? null);
}

// ---- by day

const DAY_MS = 24 * 3600 * 1000;

/** @type {(time: string | null, now: number) => string} */
function dayOf(time, now) {
  if (time === null) return "At an unknown time";
  const day = new Date(time);
  const isOn = (/** @type {number} */ moment) => new Date(moment).toDateString() === day.toDateString();
  if (isOn(now)) return "Today";
  if (isOn(now - DAY_MS)) return "Yesterday";
  const year = day.getFullYear() === new Date(now).getFullYear() ? {} : { year: /** @type {const} */ ("numeric") };
  return day.toLocaleDateString([], { weekday: "long", day: "numeric", month: "long", ...year });
}

/** @type {(runs: AnyRun[], now: number) => Group[]} */
const byDay = (runs, now) =>
  [...groupedBy(runs, ({ created_at }) => dayOf(created_at ?? null, now))]
    .map(([day, runsOfDay]) => groupOf(`day ${folded(day)}`, day, runsOfDay));

/** The ways to group, and their titles. */
export const GROUPING_TITLES = { sweep: "By sweep", race: "By race", day: "By day", none: "No groups" };

/**
 * Runs in groups, in which they keep the order of the list.
 * @param {object} list
 * @param {AnyRun[]} list.runs in the order of the list
 * @param {string} list.by
 * @param {Run[]} list.everyRun all that are known, the newest first: a race may be listed elsewhere than its training
 * @param {number} [list.now]
 * @returns {Group[]}
 */
export function groupRuns({ runs, by, everyRun, now = Date.now() }) {
  if (runs.length === 0) return [];
  if (by === "sweep") return bySweep(runs);
  if (by === "race") return byRace(runs, everyRun);
  return by === "day" ? byDay(runs, now) : [groupOf("all", "", runs)];
}
