// The editor of the robot's body: what is edited and can be undone, what was typed that is no number, and what the
// server tells of it. Nothing is changed in the form until the body is used.
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { isLasting, keepAnswer, previewRobot } from "../../js/api.js";
import {
  addLeg, changeAll, changeLeg, changeTorso, isBox, makeBox, mirrorOf, numbersOf, openBody, partsOf, removeLeg, robotOf,
  sharedPart,
} from "./body.js";
import { consequencesOf, inOwnWords, objectionsTo, settingFor, unreachedBy } from "./body-words.js";
import { bodyFields, form, setField } from "../../js/form.js";
import { bodyIsOpen } from "./dialogs.js";
import { parseSetting } from "../../js/parse.js";
import { isSame, storedRobot } from "../../js/robots.js";
import { limitsOf } from "../../js/settings.js";
import { connection, served } from "../../js/store.js";
import { messageOf } from "../../js/titles.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { Reply, RequestError } from "../../js/api.js" */
/** @import { Body } from "./body.js" */
/** @import { Objection } from "./body-words.js" */
/** @import { FormValue, GaitConfig, Preview, RobotConfig, SettingOption } from "../../js/types.js" */

/** What the server tells: of which question, and under which gait. */
/** @typedef {{ of: string, preview: Preview, gait: GaitConfig }} PreviewAnswer */
/** What the fields change. @typedef {"leg" | "all" | "torso"} Part */

/** After so long the server is asked about the next change [ms]. */
const PAUSE_MS = 120;

/** The body as it is now; null until the server has previewed the robot. @type {Signal<Body | null>} */
export const body = signal(null);
/** As it was opened. @type {Signal<Body | null>} */
export const first = signal(null);
/** The bodies before, the newest last. @type {Signal<Body[]>} */
const past = signal([]);
/** What was changed last: changes of the same are undone together. */
let lastChange = "";
/** The leg that is chosen, from 1. */
export const chosenLeg = signal(1);
export const part = signal(/** @type {Part} */ ("leg"));
export const isMirrored = signal(true);
/** What was typed in a field, by `keyOf`. @type {Signal<Record<string, string>>} */
const typed = signal({});

/** @type {Signal<Reply<PreviewAnswer>>} */
const reply = signal({ answer: null, error: null, again: false });
/** The last preview, also of an earlier body. @type {Signal<PreviewAnswer | null>} */
export const previewAnswer = signal(null);

// ---- what the server tells of the body

/** The question about the body that is shown. */
const question = computed(() => {
  if (!bodyIsOpen.value || connection.value !== "live") return "";
  const now = body.value;
  if (!now) return JSON.stringify({ asked: bodyFields(), own: null });
  const robot = now === first.value ? form.value.robot : robotOf(now);
  return JSON.stringify({ asked: { ...bodyFields(), robot, gait: now.gait }, own: now.own });
});

/** A gait that does not divide the legs as they are now is asked for by its groups. @param {string} of */
async function ask(of) {
  const { asked: robot, own: ownGait } = JSON.parse(of);
  try {
    return { of, preview: await previewRobot(robot), gait: robot.gait };
  } catch (error) {
    if (!ownGait || isSame(ownGait, robot.gait) || !isLasting(/** @type {RequestError} */ (error))) throw error;
    return { of, preview: await previewRobot({ ...robot, gait: ownGait }), gait: ownGait };
  }
}

/** Keep what the server tells while the editor is open, until the function that is returned is called. */
export function followBody() {
  const stops = [
    keepAnswer(() => question.value, ask, reply, () => PAUSE_MS),
    effect(() => {
      const { answer } = reply.value;
      if (!answer) return;
      previewAnswer.value = answer;
      if (body.peek() || answer.of !== question.peek()) return;
      first.value = openBody(wholeRobot(form.peek().robot), form.peek().gait, answer.preview);
      body.value = first.value;
    }),
    effect(() => {
      if (!isAwaited.value) return;
      if (!canUse.value) isAwaited.value = false;
      else if (isPreviewed.value) untracked(finish);
    }),
    bodyIsOpen.subscribe(clear),
  ];
  return () => stops.forEach((stop) => stop());
}

/** A stored robot as what it is made of: its body is another one's when it is changed. @param {RobotConfig} robot */
const wholeRobot = (robot) => storedRobot(robot, served().robots)?.body ?? robot;

/** Forget the body that was edited. */
function clear() {
  batch(() => {
    body.value = null;
    first.value = null;
    previewAnswer.value = null;
    past.value = [];
    typed.value = {};
    isAwaited.value = false;
    chosenLeg.value = 1;
    part.value = "leg";
  });
  lastChange = "";
}

/** Why the robot cannot be opened; null if it can. */
export const openingError = computed(() => (body.value ? null : reply.value.error && messageOf(reply.value.error)));

/** Whether the server has previewed the body as it is now. */
export const isPreviewed = computed(() => previewAnswer.value?.of === question.value && !reply.value.error);

/** Whether the robot cannot be built as it is. */
export const isRefused = computed(() => reply.value.error !== null);

/** What is wrong with the body, or speaks against it. @type {ReadonlySignal<Objection[]>} */
export const objectionsAt = computed(() => {
  const { error } = /** @type {{ error: RequestError | null }} */ (reply.value);
  if (error) return [{ legs: error.legs, words: inOwnWords(error.message) }];
  return previewAnswer.value ? objectionsTo(previewAnswer.value.preview) : [];
});

/** What is impossible about a leg; "" if nothing is. @param {number} leg */
export const impossibleAt = (leg) => (isRefused.value || !previewAnswer.value
  ? objectionsAt.value.find(({ legs }) => legs.includes(leg))?.words ?? ""
  : unreachedBy(previewAnswer.value.preview, leg));

/** What the editor would change besides the body. */
export const consequences = computed(() => {
  const [now, answer] = [body.value, previewAnswer.value];
  if (!now || !answer || !isPreviewed.value) return [];
  const turned_deg = answer.preview.forward_deg - now.up_deg;
  return consequencesOf({ turned_deg, beside: now.own, gait: answer.gait, before: form.value.gait });
});

// ---- changes

/** @type {(next: Body, key: string) => void} */
function change(next, key) {
  const now = body.peek();
  if (!now || next === now) return;
  if (key !== lastChange) past.value = [...past.peek(), now];
  lastChange = key;
  // A gait that was found not to divide the legs is not asked for again.
  const isReplaced = next.gait === now.gait && isPreviewed.peek() && isSame(previewAnswer.peek()?.gait, now.own);
  body.value = isReplaced ? { ...next, gait: next.own } : next;
}

/** Let the next change be undone by itself. */
export const endChange = () => (lastChange = "");

export const canUndo = computed(() => past.value.length > 0 || Object.keys(mistakes.value).length > 0);

/** Take back what was typed and is no number, or else the last change. */
export const undo = () => batch(() => {
  const isTyped = Object.keys(mistakes.peek()).length > 0;
  typed.value = {};
  lastChange = "";
  const before = past.peek().at(-1);
  if (isTyped || !before) return;
  past.value = past.peek().slice(0, -1);
  body.value = before;
  chosenLeg.value = Math.min(chosenLeg.peek(), before.legs.length);
});

/** @param {number} leg */
export const chooseLeg = (leg) => batch(() => {
  chosenLeg.value = leg;
  part.value = "leg";
});

/** The leg that follows another as its mirror image, if they are mirrored. @param {number} leg */
export const followerOf = (leg) => (isMirrored.value && body.value ? mirrorOf(body.value, leg) : null);

const STEP_M = 0.001;
/** @param {number} value_m */
const snapped = (value_m) => Number((Math.round(value_m / STEP_M) * STEP_M).toFixed(3));

/**
 * Move a leg's mount to a place of the picture. `mirror`: the leg that follows.
 * @type {(leg: number, place: { x_m: number, y_m: number }, mirror: number | null) => void}
 */
export function moveTo(leg, { x_m, y_m }, mirror) {
  const now = body.peek();
  if (now) change(changeLeg(now, leg, { x_m: snapped(x_m), y_m: snapped(y_m) }, mirror), `move ${leg}`);
}

/** Move a leg's mount, and turn it, from where it is. @type {(leg: number, by: Record<string, number>) => void} */
export function moveBy(leg, by) {
  const now = body.peek();
  if (!now) return;
  const parts = partsOf(now, leg);
  const places = Object.entries(by).map(([name, step]) =>
    [name, name === "yaw_deg" ? Math.round(parts[name] + step) : snapped(parts[name] + step)]);
  const key = `${"yaw_deg" in by ? "turn" : "move"} ${leg}`;
  change(changeLeg(now, leg, Object.fromEntries(places), followerOf(leg)), key);
}

/** The legs that there may be. */
const legLimits = () => {
  const { minimum, maximum } = limitsOf("legs");
  return { least: minimum ?? 0, most: maximum ?? Infinity };
};

/** Legs are numbered anew, and what was typed would be another one's. */
const CORRECT_FIRST = "Correct first what is typed below.";
/** Why no leg can be added, or the chosen one not removed; "" if it can. */
export const noMoreLegs = computed(() => {
  if (Object.keys(mistakes.value).length) return CORRECT_FIRST;
  return (body.value?.legs.length ?? 0) < legLimits().most ? "" : `A robot has at most ${legLimits().most} legs.`;
});
export const noFewerLegs = computed(() => {
  if (Object.keys(mistakes.value).length) return CORRECT_FIRST;
  const follower = followerOf(chosenLeg.value);
  const gone = follower === null || follower === chosenLeg.value ? 1 : 2;
  const { least } = legLimits();
  return (body.value?.legs.length ?? 0) - gone >= least ? "" : `A robot has at least ${least} legs.`;
});

export function addOne() {
  const now = body.peek();
  if (!now || noMoreLegs.value) return;
  endChange();
  const { body: next, leg } = addLeg(now, isMirrored.peek(), legLimits().most);
  change(next, "add");
  endChange();
  chooseLeg(leg);
}

export function removeChosen() {
  const now = body.peek();
  if (!now || noFewerLegs.value) return;
  endChange();
  change(removeLeg(now, chosenLeg.peek(), followerOf(chosenLeg.peek())), "remove");
  endChange();
  chooseLeg(Math.min(chosenLeg.peek(), now.legs.length - 1, body.peek()?.legs.length ?? 1));
}

export const boxTorso = () => {
  endChange();
  if (body.value) change(makeBox(body.value), "box");
};

/** Take groups with which it stands. */
export function takeBetter() {
  const [now, better] = [body.peek(), previewAnswer.peek()?.preview.better];
  if (!now || !better) return;
  const { gait } = /** @type {{ gait: any }} */ (better);
  change({ ...now, gait, own: gait }, "groups");
}

// ---- fields

/** Numbers that each leg has of its own. */
const OF_ONE_LEG = ["x_m", "y_m", "yaw_deg"];

/** The fields of what is chosen, by name. @returns {[string, SettingOption][]} */
export function shownFields() {
  const { leg_fields, torso_fields } = served();
  if (part.value === "leg") return Object.entries(leg_fields);
  if (part.value === "all") return Object.entries(leg_fields).filter(([field]) => !OF_ONE_LEG.includes(field));
  const otherFields = body.value && isBox(body.value) ? ["torso_radius_m"] : ["torso_length_m", "torso_width_m"];
  return Object.entries(torso_fields).filter(([field]) => !otherFields.includes(field));
}

/** The values of a field: of the chosen leg, of all legs, or the torso's. @param {string} field */
export function valuesOf(field) {
  const now = body.value;
  if (!now) return [];
  if (part.value === "torso") return [sharedPart(now, field)];
  const legs = part.value === "all" ? numbersOf(now) : [chosenLeg.value];
  return [...new Set(legs.map((leg) => partsOf(now, leg)[field]))].toSorted((a, b) => a - b);
}

/** @param {string} field */
const keyOf = (field) => `${part.value === "leg" ? `leg ${chosenLeg.value}` : part.value}: ${field}`;
/** @param {string} key */
const fieldOf = (key) => key.slice(key.indexOf(":") + 2);
/** The declaration of what a key is of. @param {string} key */
const settingOf = (key) => /** @type {SettingOption} */ (settingFor(fieldOf(key)));

/** Where in the editor something is that was typed → why it is no valid number. */
export const mistakes = computed(() => {
  /** @type {Record<string, string>} */
  const errors = {};
  for (const [key, text] of Object.entries(typed.value)) {
    const { mistake } = parseSetting(text, settingOf(key));
    if (mistake !== undefined) errors[key] = mistake;
  }
  return errors;
});

/** A field that is not valid, in words: "Leg 2, femur". @param {string} key */
export function placeInWords(key) {
  const [of] = key.split(":");
  const words = { all: "All legs", torso: "Torso" }[of] ?? `L${of.slice(1)}`;
  return `${words}, ${settingOf(key).title.toLowerCase()}`;
}

/** Show a field that is not valid. @param {string} key */
export function goToMistake(key) {
  const [of] = key.split(":");
  batch(() => {
    if (of.startsWith("leg")) chooseLeg(Number(of.slice("leg ".length)));
    else part.value = /** @type {Part} */ (of);
  });
  setTimeout(() => document.getElementById(`body-${fieldOf(key)}`)?.focus());
}

const SHOWN_DIGITS = 4;
/** @param {number} value */
const written = (value) => String(Number(value.toFixed(SHOWN_DIGITS)));

/** The text of a field, and why it is not valid. @param {string} field */
export function shownIn(field) {
  const [value, other] = valuesOf(field);
  const byValue = value === null || value === undefined || other !== undefined ? "" : written(value);
  const text = typed.value[keyOf(field)];
  if (text === undefined) return { text: byValue, mistake: null };
  const parsed = parseSetting(text, settingOf(keyOf(field)));
  if (parsed.mistake !== undefined) return { text, mistake: parsed.mistake };
  // Typed text is replaced only when the value has become another one.
  return { text: written(Number(parsed.value)) === byValue ? text : byValue, mistake: null };
}

/** Take a number for what is chosen. @type {(field: string, value: number) => void} */
export function setPart(field, value) {
  const now = body.peek();
  if (!now) return;
  const key = keyOf(field);
  if (part.value === "torso") change(changeTorso(now, { [field]: value }), key);
  else if (part.value === "all") change(changeAll(now, field, value), key);
  else change(changeLeg(now, chosenLeg.peek(), { [field]: value }, followerOf(chosenLeg.peek())), key);
}

/** Take a number from a slider. @type {(field: string, value: number) => void} */
export const slideTo = (field, value) => batch(() => {
  const { [keyOf(field)]: _, ...otherTexts } = typed.peek();
  typed.value = otherTexts;
  setPart(field, value);
});

/** Take what was typed; it stays as it is. @type {(field: string, text: string) => void} */
export const typeIn = (field, text) => batch(() => {
  typed.value = { ...typed.peek(), [keyOf(field)]: text };
  const { value, mistake } = parseSetting(text, settingOf(keyOf(field)));
  if (mistake === undefined && typeof value === "number") setPart(field, value);
});

// ---- the end

/** Whether the body is used as soon as the server has previewed it. */
const isAwaited = signal(false);

/** Whether the body can be used: it can be built, and nothing typed is no number. */
export const canUse = computed(() =>
  body.value !== null && !isRefused.value && connection.value === "live" && Object.keys(mistakes.value).length === 0);

/** Close the editor; the form stays as it is. */
export const cancel = () => (bodyIsOpen.value = false);

/** Write the body into the form, once the server has previewed it. */
export const useBody = () => (isAwaited.value = canUse.value);

/** Write it, and the gait where it is another one; a body that was not changed stays as the form has it. */
function finish() {
  const [now, answer] = [body.peek(), previewAnswer.peek()];
  if (!now || !answer) return;
  const isOther = now !== first.peek();
  const isOtherGait = !isSame(answer.gait, form.peek().gait);
  batch(() => {
    if (isOther) setField("robot", /** @type {FormValue} */ (robotOf(now)));
    if (isOther && isOtherGait) setField("gait", /** @type {FormValue} */ (answer.gait));
    cancel();
  });
}
