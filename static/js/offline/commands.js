// What the page of a file can be told to do, by messages or in its address: each value is checked, and an error names
// what is valid. docs/exports.md has the interface.

/** The camera's coordinates may be as far from what it follows, and its place from what it looks at as near [m]. */
const [FARTHEST_M, NEAREST_M] = [100, 0.01];
/** What the camera may follow, but lanes, which are numbered from 1. */
export const [DIRECTED, LEADER, FREE] = ["directed", "leader", "free"];
const PREFIX = "hexapods:";
/** What a message may be, and the members that it has beside `type` and `id`. */
const COMMANDS = {
  play: [], pause: [], seek: ["time_s"], step: ["direction"], speed: ["speed"],
  camera: ["position", "look_at", "follow"], clock: ["clock"], state: [],
};

/**
 * What is valid in this file. @typedef {{ lanes: number, clocks: string[] }} Limits
 * Place and target of the camera [m], and what it follows.
 * @typedef {{ position?: number[], look_at?: number[], follow?: string | number }} CameraPlace
 */
/**
 * @typedef {{ name: "play" | "pause" | "state" } | { name: "seek", time_s: number }
 *   | { name: "step", direction: 1 | -1 } | { name: "speed", speed: number }
 *   | { name: "camera", camera: CameraPlace } | { name: "clock", clock: string }} Command
 */

/** A message or an address that is not valid; the message names what is. */
export class InvalidCommand extends Error {}

/** @param {string} sentence @returns {never} */
const refuse = (sentence) => {
  throw new InvalidCommand(sentence);
};

/** @param {unknown} value */
const shown = (value) => JSON.stringify(value) ?? String(value);

/** @param {string[]} names */
const either = (names) => (names.length > 1 ? `${names.slice(0, -1).join(", ")} or ${names.at(-1)}` : names[0]);

/** @type {(name: string, value: unknown) => number} */
const numberIn = (name, value) => {
  if (typeof value === "number" && Number.isFinite(value)) return value;
  return refuse(`${name} must be a number, not ${shown(value)}`);
};

/** @type {(name: string, value: unknown) => number[]} */
const placeIn = (name, value) => {
  const isPlace = Array.isArray(value) && value.length === 3
    && value.every((number) => typeof number === "number" && Math.abs(number) <= FARTHEST_M);
  if (isPlace) return value;
  return refuse(`${name} must be three numbers, x, y and z in metres, from −100 to 100, not ${shown(value)}`);
};

/** @type {(value: unknown, limits: Limits) => string} */
const followIn = (value, { lanes }) => {
  const targets = [DIRECTED, LEADER, FREE, ...Array.from({ length: lanes }, (_, lane) => String(lane + 1))];
  if (targets.includes(String(value))) return String(value);
  return refuse(`follow must be ${either(targets)}, not ${shown(value)}`);
};

/** @type {(value: unknown, limits: Limits) => string} */
const clockIn = (value, { clocks }) =>
  clocks.find((clock) => clock === value)
    ?? refuse(`clock must be ${either(clocks)} in this file, not ${shown(value)}`);

/** @type {(speed: number) => number} */
const speedIn = (speed) => (speed > 0 ? speed : refuse(`speed must be above 0, not ${speed}`));

/** @type {(camera: Record<string, unknown>, limits: Limits) => CameraPlace} */
const cameraIn = ({ position, look_at, follow }, limits) => {
  /** @type {CameraPlace} */
  const camera = {};
  if (position !== undefined) camera.position = placeIn("position", position);
  if (look_at !== undefined) camera.look_at = placeIn("look_at", look_at);
  if (follow !== undefined) camera.follow = followIn(follow, limits);
  const { position: from, look_at: to } = camera;
  if (from && to && Math.hypot(...from.map((x, axis) => x - to[axis])) < NEAREST_M) {
    refuse(`position and look_at must be at least ${NEAREST_M} m apart`);
  }
  return camera;
};

/**
 * The command of a message; null if it is none of this interface's.
 * @param {any} message
 * @param {Limits} limits
 * @returns {Command | null}
 * @throws {InvalidCommand}
 */
export function commandOf(message, limits) {
  const type = message?.type;
  if (typeof type !== "string" || !type.startsWith(PREFIX)) return null;
  const name = /** @type {keyof typeof COMMANDS} */ (type.slice(PREFIX.length));
  if (!Object.hasOwn(COMMANDS, name)) {
    refuse(`type must be ${either(Object.keys(COMMANDS).map((valid) => PREFIX + valid))}, not ${shown(type)}`);
  }
  const unknown = Object.keys(message).find((member) => !["type", "id", ...COMMANDS[name]].includes(member));
  if (unknown !== undefined) {
    refuse(COMMANDS[name].length ? `${type} has ${either(COMMANDS[name])}, not ${shown(unknown)}`
      : `${type} has no other members, such as ${shown(unknown)}`);
  }
  switch (name) {
    case "seek": return { name, time_s: numberIn("time_s", message.time_s) };
    case "speed": return { name, speed: speedIn(numberIn("speed", message.speed)) };
    case "camera": return { name, camera: cameraIn(message, limits) };
    case "clock": return { name, clock: clockIn(message.clock, limits) };
    case "step": {
      const { direction } = message;
      if (direction !== 1 && direction !== -1) refuse(`direction must be 1 or -1, not ${shown(direction)}`);
      return { name, direction };
    }
    default: return { name };
  }
}

/** @param {string} text */
const numberOf = (text) => (text.trim() === "" ? NaN : Number(text));

/**
 * The commands in an address, and a sentence for each value that is not valid, which is left out.
 * @param {string} query
 * @param {Limits} limits
 */
export function commandsIn(query, limits) {
  const parameters = new URLSearchParams(query);
  /** @type {Command[]} */
  const commands = [];
  /** @type {string[]} */
  const errors = [];
  /** @type {(name: string, command: (text: string) => Command | null) => void} */
  const take = (name, command) => {
    const text = parameters.get(name);
    if (text === null) return;
    try {
      const taken = command(text);
      if (taken) commands.push(taken);
    } catch (error) {
      if (!(error instanceof InvalidCommand)) throw error;
      errors.push(`${error.message} (in the address)`);
    }
  };
  const places = /** @type {const} */ (["position", "look_at"]);
  const camera = Object.fromEntries(places.filter((name) => parameters.has(name)).map((name) =>
    [name, placeText(/** @type {string} */ (parameters.get(name)))]));
  take("clock", (clock) => ({ name: "clock", clock: clockIn(clock, limits) }));
  take("speed", (text) => ({ name: "speed", speed: speedIn(addressed("speed", text)) }));
  take("t", (text) => ({ name: "seek", time_s: addressed("t", text) }));
  take("follow", (follow) => ({ name: "camera", camera: cameraIn({ follow }, limits) }));
  if (Object.keys(camera).length) {
    take(Object.keys(camera)[0], () => ({ name: "camera", camera: cameraIn(camera, limits) }));
  }
  take("theme", (theme) =>
    (["light", "dark"].includes(theme) ? null : refuse(`theme must be light or dark, not ${shown(theme)}`)));
  take("play", (text) =>
    (["", "1"].includes(text) ? { name: "play" } : refuse(`play must be 1 or have no value, not ${shown(text)}`)));
  return { commands, errors };
}

/** @type {(name: string, text: string) => number} */
const addressed = (name, text) => {
  const number = numberOf(text);
  return Number.isFinite(number) ? number : refuse(`${name} must be a number, not ${shown(text)}`);
};

/** Numbers between commas, or the text where it has others. @param {string} text */
const placeText = (text) => {
  const numbers = text.split(",").map(numberOf);
  return numbers.every(Number.isFinite) ? numbers : text;
};
