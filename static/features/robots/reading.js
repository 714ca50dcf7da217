// The robot of a file as it was read, before it is stored: what was found and guessed, what a person decides, and its
// file read again with that. It is drawn in the 3D view of this page alone.
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { canStart, pending, runPrimaryAction } from "../../js/actions.js";
import { call, patiently } from "../../js/api.js";
import { form } from "../../js/form.js";
import { change, page } from "../../js/page-state.js";
import { toast } from "../../js/page.js";
import { unpack } from "../../js/replay-frames.js";
import { endStill, showStill } from "../../js/still-scene.js";
import { served, setEntry } from "../../js/store.js";
import { messageOf } from "../../js/titles.js";
import { decided, wrongNumber } from "./reading-choices.js";
import { readingInWords } from "./reading-words.js";
import { extentOf } from "./sketch-geometry.js";
import { chooseStored, distinct, refresh } from "./stored-robots.js";

/** @import { Signal } from "@preact/signals" */
/** @import { GaitConfig, StoredRobot } from "../../js/types.js" */
/** @import { Extent } from "./sketch-geometry.js" */

/** A decision is null where what was found holds. */
/**
 * @typedef {Partial<{
 *   file: string | null, forward: string | number | null, feet: string[] | null, keyframe: string | null,
 *   home_rad: Record<string, number> | null, gait: GaitConfig | null, servo_torque_nm: number | null,
 *   servo_kp: number | null, servo_kv: number | null, scale: number | null, mass_kg: number | null, up: string | null,
 *   angle_unit: string | null, body_height_m: number | null, arguments: Record<string, string> | null,
 * }>} ReadingChoices
 */
/** @typedef {{ leg: number, azimuth_deg: number, joints: string[], foot: string }} FoundLeg */
/**
 * @typedef {{
 *   name: string, gait: GaitConfig, groups: number[][], legs: FoundLeg[], mass_kg: number, body_height_m: number,
 *   body_heights_m: [number, number] | null, forward_deg: number, keyframes: string[], reaches_grid: boolean,
 * }} FoundRobot
 */
/** @typedef {{ kind: "guess" | "repair", topic: string, text: string, parts: string[] }} Sentence */
/** @typedef {Sentence & { offer: ReadingChoices | null }} ReadingNote */
/** @typedef {{ name: string, leg: number, foot: string | null, at_m: number[], low_m: number[] }} ReadingPart */
/** A foot of a leg; where no legs were found, what could be one, of leg 0. */
/** @typedef {{ name: string, leg: number, at_m: number[], radius_m: number }} ReadingFoot */
/**
 * `document`: path in the zip of what was read; `documents`: of all that could be the robot.
 * @typedef {{
 *   id: string, file: string, document: string | null, documents: string[], choices: ReadingChoices,
 *   problem: string | null, robot: FoundRobot | null, feet: ReadingFoot[], arguments: Record<string, string>,
 *   notes: ReadingNote[], parts: ReadingPart[], scene: string,
 * }} Reading
 */

/** A stored robot. @typedef {{ id: string, name: string }} Stored */

/** Stands for a reading in the page's state until it has an id. */
const NEW = "new";
/** Changes within so long are read together [ms]. */
const PAUSE_MS = 150;
const MIB = 2 ** 20;
const NOT_FOUND = 404;

/** What the server has read; null until then. @type {Signal<Reading | null>} */
export const reading = signal(null);
/** How far its parts reach. @type {Signal<Extent>} */
export const extent = signal({ radius_m: 1, height_m: 1, rims_m: [] });
/** What a person has decided, perhaps not read yet. @type {Signal<ReadingChoices>} */
export const choices = signal({});
/** Those with which it was read that is shown. @type {Signal<ReadingChoices>} */
const readChoices = signal({});
/** The decisions before, the newest last. @type {Signal<ReadingChoices[]>} */
const past = signal([]);
/** The name of what is being read for the first time; null once it is. @type {Signal<string | null>} */
export const opening = signal(null);
/** Why it cannot be read, or the last decision not be taken; "" if nothing is wrong. */
export const refusal = signal("");
/** Whether the file is read with what was decided. */
export const isReading = signal(false);
/** Whether it is being stored. */
export const isStoring = computed(() => Boolean(pending.value.robot));
/** The stored robot that is corrected; null for one that is not stored. @type {Signal<Stored | null>} */
export const corrected = signal(null);
/** The name under which it will be stored. */
export const robotName = signal("");
/** What screen readers are told of the newest reading. */
export const readingAnnounced = signal("");

/** Reads the file anew, where the server has forgotten it. @type {(() => Promise<Reading>) | null} */
let openAnew = null;
/** Counts what was opened: answers about what was open before are not taken. */
let openings = 0;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

// ---- opening

/**
 * Read a robot, and show it.
 * @param {string} name what the page calls it until then
 * @param {() => Promise<Reading>} read
 * @param {Stored | null} [stored] that is corrected
 */
async function open(name, read, stored = null) {
  openings += 1;
  const number = openings;
  clear();
  batch(() => {
    opening.value = name;
    corrected.value = stored;
    robotName.value = stored?.name ?? "";
    change({ view: "race", reading: NEW, hidden: page.hidden.peek().filter((part) => part !== "panel") });
  });
  openAnew = read;
  try {
    // The server reads few files at once.
    const answer = await patiently(read, () => number === openings);
    if (answer) await take(answer, number);
  } catch (error) {
    if (number === openings) refusal.value = messageOf(/** @type {Error} */ (error));
  }
  if (number === openings) opening.value = null;
}

/** Read the robot of a file. @param {string} name @param {() => Promise<File>} make the file to be sent */
export const openFile = (name, make) => {
  /** @type {Promise<File> | null} */
  let file = null;
  return open(name, async () => {
    file ??= make();
    return send(await file);
  });
};

/** Read a stored robot's file again. @param {Stored} robot */
export const openStored = (robot) =>
  open(robot.name, () => call("POST", `robots/${encodeURIComponent(robot.id)}/reading`), robot);

/** @param {File} file @returns {Promise<Reading>} */
function send(file) {
  const most = served().limits.import_bytes[1] ?? Infinity;
  if (file.size > most) {
    throw new Error(`The file has ${Math.ceil(file.size / MIB)} MiB; the most is ${Math.floor(most / MIB)} MiB here.`);
  }
  return call("POST", `robots/readings?${new URLSearchParams({ file: file.name })}`, file);
}

/**
 * Take in what was read.
 * @param {Reading} answer
 * @param {number} number of the opening
 * @param {ReadingChoices} [read] what was decided
 */
async function take(answer, number, read = answer.choices) {
  const scene = await unpack(answer.scene);
  if (number !== openings) return;
  batch(() => {
    extent.value = extentOf(scene);
    if (reading.peek() === null) choices.value = read;
    readChoices.value = read;
    if (answer.robot && !robotName.peek()) robotName.value = distinct(answer.robot.name);
    reading.value = answer;
    page.reading.value = answer.id;
    readingAnnounced.value = readingInWords(answer);
  });
  // By itself: the player takes away what it has drawn before.
  showStill(scene);
}

/** Leave it. Nothing of it is kept on this page. */
export function closeReading() {
  openings += 1;
  clear();
  page.reading.value = null;
}

/** Forget what was read. */
function clear() {
  clearTimeout(timer);
  batch(() => {
    reading.value = null;
    choices.value = {};
    past.value = [];
    [opening.value, refusal.value, robotName.value, readingAnnounced.value] = [null, "", "", ""];
    isReading.value = false;
    corrected.value = null;
  });
  openAnew = null;
  endStill();
}

/** Follow the page's state: "back" closes what is open, and a link opens what the server has read. */
export const followReading = () => effect(() => {
  const id = page.reading.value;
  untracked(() => {
    const isOpen = opening.peek() !== null || reading.peek() !== null || refusal.peek() !== "";
    if (id === null && isOpen) closeReading();
    else if (id === NEW && !isOpen) page.reading.value = null;
    else if (id !== null && id !== NEW && reading.peek()?.id !== id && opening.peek() === null) {
      open("The robot", () => call("POST", `robots/readings/${encodeURIComponent(id)}`, { choices: {} }));
    }
  });
});

// ---- deciding

export const canUndo = computed(() => past.value.length > 0);

/** Decide something, and have the file read with it. @param {ReadingChoices} changes */
export function decide(changes) {
  past.value = [...past.peek(), choices.peek()];
  setChoices({ ...choices.peek(), ...changes });
}

/** Take back the last decision. */
export function undoDecision() {
  const before = past.peek().at(-1);
  if (!before) return;
  past.value = past.peek().slice(0, -1);
  setChoices(before);
}

/** @param {ReadingChoices} wanted */
function setChoices(wanted) {
  choices.value = wanted;
  refusal.value = "";
  clearTimeout(timer);
  if (!wrongNumber(wanted.feet)) timer = setTimeout(readAgain, PAUSE_MS);
}

/** Have the file read with the newest decisions; one request at a time. */
async function readAgain() {
  if (isReading.peek() || !reading.peek()) return;
  const number = openings;
  isReading.value = true;
  /** @type {ReadingChoices | null} */
  let sent = null;
  while (number === openings && sent !== choices.peek() && !wrongNumber(choices.peek().feet)) {
    sent = choices.peek();
    try {
      const wanted = sent;
      const answer = await patiently(() => readWith(wanted), () => number === openings && wanted === choices.peek());
      if (answer) await take(answer, number, wanted);
    } catch (error) {
      if (number === openings && sent === choices.peek()) refusal.value = messageOf(/** @type {Error} */ (error));
    }
  }
  if (number === openings) isReading.value = false;
}

/** @param {ReadingChoices} wanted @returns {Promise<Reading>} */
async function readWith(wanted) {
  const ask = (/** @type {string} */ id) =>
    call("POST", `robots/readings/${encodeURIComponent(id)}`, { choices: decided(wanted) });
  try {
    return await ask(/** @type {Reading} */ (reading.peek()).id);
  } catch (error) {
    if (/** @type {{ status?: number }} */ (error).status !== NOT_FOUND || !openAnew) throw error;
    return ask((await openAnew()).id);
  }
}

// ---- storing

/** Whether what is seen can be stored: it is read as it was decided, and is a robot. */
export const canStore = computed(() => Boolean(reading.value?.robot) && !isReading.value && !isStoring.value &&
  readChoices.value === choices.value && robotName.value.trim() !== "");

/** Whether a training can be started with it. */
export const canTrain = computed(() => canStore.value && canStart.value);

/** Store what is seen; null if that was refused. @returns {Promise<StoredRobot | null>} */
async function store() {
  const [read, before, name] = [reading.peek(), corrected.peek(), robotName.peek().trim()];
  if (!canStore.peek() || !read) return null;
  setEntry(pending, "robot", true);
  try {
    const wanted = decided(choices.peek());
    const renamed = name === before?.name ? {} : { name };
    const stored = before
      ? await call("PATCH", `robots/${encodeURIComponent(before.id)}`, { choices: wanted, ...renamed })
      : await call("POST", "robots", { reading: read.id, choices: wanted, name });
    await refresh();
    return stored;
  } catch (error) {
    refusal.value = messageOf(/** @type {Error} */ (error));
    return null;
  } finally {
    setEntry(pending, "robot", false);
  }
}

/** Store it, and leave it. */
export async function keepRobot() {
  const before = corrected.peek();
  const wasChosen = before !== null && form.peek().robot === before.id;
  const stored = await store();
  if (!stored) return;
  if (wasChosen) chooseStored(stored.id);
  closeReading();
  toast(`${stored.name} is kept.`);
}

/** Store it, choose it for the next run, and start that. */
export async function trainRobot() {
  if (!canTrain.peek()) return;
  const stored = await store();
  if (!stored) return;
  chooseStored(stored.id);
  closeReading();
  await runPrimaryAction();
}
