// The editor of the robot's body: what is typed stays, changes are undone one by one, and the form changes at the end.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import * as editor from "../../../static/features/robots/body-editor.js";
import { partsOf } from "../../../static/features/robots/body.js";
import { inOwnWords, reachInWords } from "../../../static/features/robots/body-words.js";
import { form, openForm, setField } from "../../../static/js/form.js";
import { bodyIsOpen } from "../../../static/features/robots/dialogs.js";
import { page } from "../../../static/js/page-state.js";
import { connection, options } from "../../../static/js/store.js";
import { OPTIONS } from "../../page/options.js";

const BUILT = { femur_m: 0.08, torso_radius_m: 0.1, torso_length_m: null, torso_width_m: null };
const ANGLES = [45, 135, 225, 315];
/** @type {(angle: number) => object} */
const legAt = (angle) => ({
  group: 0, out_of_reach: null,
  built: {
    x_m: 0.1 * Math.cos((angle * Math.PI) / 180), y_m: 0.1 * Math.sin((angle * Math.PI) / 180), yaw_deg: angle,
    foot_out_m: 0.15, femur_m: 0.08,
  },
});
/** What the server answers: each request's body is kept. @type {any[]} */
const requests = [];
/** @type {(body: any) => [number, any]} */
let answer;
const OWN = { right_leg: 1, left_leg: 2, groups: [[1, 3], [2, 4]] };
/** @type {(changes?: object) => any} */
const preview = (changes = {}) => ({
  built: BUILT, legs: ANGLES.map(legAt), forward_deg: 90, gait: OWN, groups: [], better: null, tips: false,
  table_fits: true, out_of_reach: null, ...changes,
});

const settled = () => new Promise((resolve) => { setTimeout(resolve, 300); });

/** Open the editor, and wait for what the server tells. */
async function open() {
  bodyIsOpen.value = true;
  await settled();
}

Object.assign(globalThis, {
  fetch: async (/** @type {URL} */ _url, /** @type {{ body: string }} */ { body }) => {
    requests.push(JSON.parse(body));
    const [status, content] = answer(requests.at(-1));
    const text = await Promise.resolve(JSON.stringify(content));
    return { ok: status < 400, status, text: () => Promise.resolve(text) };
  },
});
editor.followBody();

beforeEach(() => {
  bodyIsOpen.value = false;
  requests.length = 0;
  answer = () => [200, preview()];
  options.value = OPTIONS;
  connection.value = "live";
  page.form.value = new URLSearchParams();
  openForm();
  setField("robot", "dog");
  setField("gait", "wave");
});

/** @type {(leg: number) => Record<string, number>} */
const parts = (leg) => partsOf(/** @type {any} */ (editor.body.value), leg);

test("it begins with the robot of the form; unchanged it leaves the form as it is", async () => {
  await open();
  assert.deepEqual([requests[0].robot, requests[0].gait], ["dog", "wave"]);
  assert.equal(editor.canUse.value, true);
  editor.useBody();
  assert.deepEqual([form.value.robot, bodyIsOpen.value], ["dog", false]);
});

test("a body that was changed is written into the form when it is used", async () => {
  await open();
  editor.moveBy(1, { y_m: 0.005 });
  editor.useBody();
  assert.equal(form.value.robot, "dog");
  await settled();
  const { robot } = /** @type {{ robot: any }} */ (form.value);
  assert.deepEqual([robot.preset, robot.legs.length, robot.legs[0].y_m, robot.legs[1].y_m], ["dog", 4, 0.076, 0.076]);
  assert.equal(form.value.gait, "wave");
});

test("changes of one kind are undone together, others one by one", async () => {
  await open();
  editor.moveBy(1, { x_m: 0.005 });
  editor.moveBy(1, { x_m: 0.005 });
  editor.moveBy(1, { yaw_deg: 5 });
  assert.deepEqual([parts(1).yaw_deg, parts(2).yaw_deg], [50, 130]);
  editor.undo();
  editor.slideTo("femur_m", 0.1);
  assert.deepEqual([parts(1).x_m, parts(2).x_m, parts(2).femur_m], [0.081, -0.081, 0.1]);
  editor.undo();
  assert.deepEqual([parts(1).x_m, parts(1).femur_m], [0.081, 0.08]);
  editor.undo();
  assert.equal(parts(1).x_m, 0.070711);
  assert.equal(editor.canUndo.value, false);
});

test("what is typed stays; no number holds the use of the body, and is undone first", async () => {
  await open();
  editor.typeIn("femur_m", "0,09");
  assert.deepEqual([parts(1).femur_m, editor.shownIn("femur_m").text], [0.09, "0,09"]);
  editor.typeIn("femur_m", "long");
  await settled();
  assert.equal(editor.shownIn("femur_m").text, "long");
  assert.equal(parts(1).femur_m, 0.09);
  assert.deepEqual(Object.keys(editor.mistakes.value).map(editor.placeInWords), ["Leg 1, femur"]);
  assert.deepEqual([editor.canUse.value, editor.noMoreLegs.value !== ""], [false, true]);
  editor.undo();
  assert.deepEqual([editor.shownIn("femur_m").text, editor.canUse.value], ["0.09", true]);
});

test("a gait that does not divide the legs is replaced by its groups, and that is told", async () => {
  await open();
  answer = ({ gait }) => (gait === "wave" ? [422, { detail: "No wave." }] : [200, preview({ forward_deg: 100 })]);
  editor.moveBy(1, { x_m: 0.005 });
  await settled();
  assert.deepEqual(editor.consequences.value, [
    "Ahead is now 10° to the left: between legs 1 and 2.", "Gait: Groups 1+3, 2+4, in place of The wave.",
  ]);
  editor.useBody();
  assert.deepEqual(form.value.gait, OWN);
});

test("what cannot be built is told at its legs, and cannot be used", async () => {
  await open();
  answer = () => [422, { detail: "The feet of legs 1 and 2 are in one place.", legs: [1, 2] }];
  editor.moveBy(1, { x_m: -0.07 });
  await settled();
  assert.match(editor.impossibleAt(2), /in one place/);
  assert.deepEqual([editor.impossibleAt(3), editor.canUse.value], ["", false]);
});

test("legs that do not reach their grid are told together, each at its leg", async () => {
  await open();
  const legs = ANGLES.map(legAt).map((leg, number) =>
    ({ ...leg, leg: number + 1, out_of_reach: number < 2 ? `leg ${number + 1} cannot reach cell 1` : null }));
  answer = () => [200, preview({ legs, out_of_reach: "leg 1 cannot reach cell 1" })];
  editor.slideTo("femur_m", 0.01);
  await settled();
  const [{ words, legs: at }] = editor.objectionsAt.value;
  assert.deepEqual([words, at], ["Leg 1 cannot reach cell 1. So it is with leg 2.", [1, 2]]);
  assert.equal(editor.impossibleAt(2), "Leg 2 cannot reach cell 1.");
  assert.equal(editor.canUse.value, true);
});

test("fields have their names of the editor in what the server says, and reach is told by the grid", () => {
  assert.equal(inOwnWords("choose a smaller grid_side_m, a lower step_height_m, or its own foot_out_m"),
    "Choose a smaller Grid side, a lower step height, or its own foot from joint");
  assert.equal(reachInWords(preview({ largest_side_m: null, safe_side_m: null })), "");
  assert.equal(reachInWords(preview({ largest_side_m: 0.125, safe_side_m: 0.035 })),
    "Its feet reach a foot grid of at most 0.125\u00a0m; up to 0.035\u00a0m no step is ever ruled out.");
});

test("legs are added and removed within the limits that the server declares", async () => {
  await open();
  editor.removeChosen();
  assert.equal(editor.noFewerLegs.value, "A robot has at least 3 legs.");
  assert.equal(editor.body.value?.legs.length, 4);
  editor.isMirrored.value = false;
  editor.removeChosen();
  assert.equal(editor.body.value?.legs.length, 3);
  editor.isMirrored.value = true;
  editor.addOne();
  assert.equal(editor.body.value?.legs.length, 4);
  editor.cancel();
  assert.equal(form.value.robot, "dog");
});

test("all legs at once, and a torso that becomes a box", async () => {
  await open();
  editor.part.value = "all";
  assert.deepEqual(editor.shownFields().map(([field]) => field), ["foot_out_m", "femur_m"]);
  editor.typeIn("femur_m", "0.1");
  assert.deepEqual(ANGLES.map((_, number) => parts(number + 1).femur_m), [0.1, 0.1, 0.1, 0.1]);
  editor.part.value = "torso";
  assert.deepEqual(editor.shownFields().map(([field]) => field), ["torso_radius_m"]);
  editor.boxTorso();
  assert.deepEqual(editor.shownFields().map(([field]) => field), ["torso_length_m", "torso_width_m"]);
});
