// Stored robots: saved under a name, renamed, hidden, deleted, and taken in from files.
import { computed, signal } from "@preact/signals";
import { call, getOptions } from "../../js/api.js";
import { tellDeleted } from "../../js/deletions.js";
import { chooseRobot, form } from "../../js/form.js";
import { setEntry, options, served } from "../../js/store.js";
import { messageOf } from "../../js/titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Take } from "../../js/deletions.js" */
/** @import { GaitConfig, Robot, RobotConfig, StoredRobot } from "../../js/types.js" */

/**
 * A file, and what came of it: the sentence of the refusal, or the robot.
 * @typedef {{ key: number, name: string, state: "reading" | "stored" | "refused", words: string, robot?: StoredRobot }}
 *   TakenFile
 */

/** The newest first. @type {Signal<TakenFile[]>} */
export const taken = signal([]);
/** Robot id → why what was asked for was refused. @type {Signal<Record<string, string>>} */
export const refusals = signal({});
/** Those that are stored, hidden ones too. */
export const storedRobots = computed(() => (options.value?.robots ?? []).filter(({ id }) => id !== null));

const pathOf = (/** @type {string} */ id) => `robots/${encodeURIComponent(id)}`;
/**
 * Where a robot is downloaded: its document, or in a format of other programs.
 * @param {string} id
 * @param {string} [format]
 */
export const fileOf = (id, format) => `api/v1/${pathOf(id)}/file${format ? `?format=${format}` : ""}`;

/** The options are asked for again, so that the form knows the robot. */
export async function refresh() {
  options.value = await getOptions();
}

/**
 * Save a robot under a name, and choose it.
 * @type {(robot: RobotConfig, gait: GaitConfig, name: string) => Promise<StoredRobot>}
 */
export async function saveRobot(robot, gait, name) {
  const stored = await call("POST", "robots", { robot, gait, name });
  await refresh();
  return stored;
}

/**
 * Ask for a change of a robot; why it was refused stands beside it.
 * @type {(id: string, ask: () => Promise<unknown>) => Promise<void>}
 */
async function change(id, ask) {
  setEntry(refusals, id, "");
  try {
    await ask();
    await refresh();
  } catch (error) {
    setEntry(refusals, id, messageOf(/** @type {Error} */ (error)));
  }
}

/** @type {(id: string, changes: Partial<Pick<StoredRobot, "name" | "hidden">>) => Promise<void>} */
export const changeRobot = (id, changes) => change(id, () => call("PATCH", pathOf(id), changes));

/** Choose a stored robot. @param {string} id */
export const chooseStored = (id) => chooseRobot(id);

/** Take in a robot that is restored. @type {Take} */
export const takeRestored = async (ask) => {
  await ask();
  await refresh();
};

/** A robot that the form has is replaced by the default one when it is deleted. @param {string} id */
export const deleteRobot = (id) => change(id, async () => {
  const { title = id } = storedRobots.peek().find((robot) => robot.id === id) ?? {};
  // Its dialog is above the message.
  tellDeleted("robots", await call("DELETE", pathOf(id)), `“${title}”`, null);
  if (form.peek().robot === id) chooseRobot(served().robots[0].name);
});

let keys = 0;
/** @type {(key: number, changes: Partial<TakenFile>) => void} */
const setTaken = (key, changes) =>
  (taken.value = taken.value.map((file) => (file.key === key ? { ...file, ...changes } : file)));

/** @param {number} key */
export const dismissFile = (key) => (taken.value = taken.value.filter((file) => file.key !== key));

const MIB = 2 ** 20;

/** Take in files of robots, one after the other. @param {Iterable<File>} files */
export async function takeFiles(files) {
  const waiting = [...files].map((file) => ({ file, key: (keys += 1) }));
  const shown = waiting.map(({ file, key }) => (
    { key, name: file.name, state: /** @type {const} */ ("reading"), words: "is being read…" }));
  taken.value = [...shown.toReversed(), ...taken.value];
  for (const { file, key } of waiting) {
    try {
      const robot = await send(file);
      setTaken(key, { state: "stored", words: `is ${robot.name} here.`, robot });
      await refresh();
    } catch (error) {
      setTaken(key, { state: "refused", words: messageOf(/** @type {Error} */ (error)) });
    }
  }
}

/** @param {File} file @returns {Promise<StoredRobot>} */
function send(file) {
  const most = served().limits.import_bytes[1] ?? Infinity;
  if (file.size > most) {
    throw new Error(`The file has ${Math.ceil(file.size / MIB)} MiB; the most is ${Math.floor(most / MIB)} MiB here.`);
  }
  const name = distinct(file.name.replace(/\.[^.]*$/, ""));
  return call("POST", `robots?${new URLSearchParams({ name, file: file.name })}`, file);
}

/** A name that no robot has: "Rex 2". @param {string} name */
export function distinct(name) {
  const [, most] = served().limits.name;
  const short = name.slice(0, (most ?? Infinity) - 4) || "Robot";
  const used = served().robots.flatMap((robot) => [robot.name, robot.title]).map((robot) => robot.toLowerCase());
  for (let number = 1; ; number += 1) {
    const numbered = number === 1 ? short : `${short} ${number}`;
    if (!used.includes(numbered.toLowerCase())) return numbered;
  }
}

/** @param {Robot} robot */
export const isChosen = ({ id }) => form.value.robot === id;
