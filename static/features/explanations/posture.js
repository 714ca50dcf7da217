// The state of the table that was chosen with a click. A click in the table puts a ghost of the robot into that state,
// in the 3D view; one on a foot grid in the 3D view chooses the present state and that move.
import { batch, computed, effect, signal } from "@preact/signals";
import { getReplayFrames, keepAnswer } from "../../js/api.js";
import { clickedCell, drawHere } from "../../js/page.js";
import { sceneCount } from "../../js/picture.js";
import { decode } from "../../js/replay-frames.js";
import { clock, conditionsShown } from "../../js/on-stage.js";
import { chosenLane, explanation, followStage, stageMoment } from "./steps.js";
import { scene } from "../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Frames, Message } from "../../js/replay-frames.js" */
/** @import { Reply } from "../../js/api.js" */
/** @import { FootCells, Move } from "../../js/types.js" */
/** @import { Click } from "../../js/page.js" */

/**
 * @typedef {object} ChosenState
 * @property {string} run_id
 * @property {number} lane
 * @property {number[]} cells the cell of each pair
 * @property {Move} move
 * @property {"table" | "scene"} from where the click was
 */

/** @type {Signal<ChosenState | null>} */
export const chosenState = signal(null);
/** The messages that draw the ghost. @type {Signal<Reply<Frames>>} */
export const ghost = signal({ answer: null, error: null, again: false });

/** Why no ghost can be shown now; null where one can. @type {Signal<string | null>} */
export const whyNoGhost = computed(() => {
  if (!drawHere.value) return "The 3D view has not loaded yet";
  // It stands on the foot grid, which the first step brings.
  return scene.value?.action_values ? null : "There is no ghost before the first step";
});

/** Choose a state in the table. @type {(cells: number[], move: Move) => void} */
export function chooseState(cells, move) {
  const at = stageMoment.peek();
  if (at) chosenState.value = { run_id: at.run_id, lane: at.lane, cells, move, from: "table" };
}

export const giveUpState = () => (chosenState.value = null);

/**
 * The lane and the move that a cell of a foot grid is; null if it is none. Its batches are those of
 * hexapods/drawing/footgrid.py: `home` has a cell of each leg, `others` all others, leg by leg.
 * @param {Pick<Click, "node" | "instance">} cell
 * @param {FootCells} grid
 * @returns {{ lane: number, move: Move } | null}
 */
export function moveAt({ node, instance }, { pairs, cell_names }) {
  const [, lane, batchName] = /\/lane(\d+)\/grid\/(home|others)\/fills$/.exec(node) ?? [];
  if (lane === undefined || !(instance >= 0)) return null;
  const count = cell_names.length - 1;
  const isHome = batchName === "home";
  const leg = 1 + (isHome ? instance : Math.floor(instance / count));
  const pair = pairs.findIndex((legs) => legs.includes(leg));
  return pair < 0 ? null : { lane: Number(lane), move: [pair, isHome ? 0 : 1 + (instance % count)] };
}

/** The state that a lane is in; null until it is known. @param {number} lane @returns {number[] | null} */
function presentCells(lane) {
  const values = scene.value?.action_values;
  if (values?.lane === lane) return values.current;
  const { answer } = explanation.value;
  const isOfLane = answer && answer.run_id === scene.value?.run_id && (answer.lane ?? 0) === lane;
  return isOfLane ? answer.observation : null;
}

/** Keep the ghost in the 3D view, and answer clicks there, until the function that is returned is called. */
export function followChosenState() {
  const stops = [effect(giveUpElsewhere), followView(), effect(answerClick), keepGhost(), drawGhost()];
  return () => {
    giveUpState();
    clickedCell.value = null;
    stops.forEach((stop) => stop());
  };
}

/** Another run or lane is looked at. */
function giveUpElsewhere() {
  const at = stageMoment.value;
  const chosen = chosenState.value;
  if (chosen && (at?.run_id !== chosen.run_id || at.lane !== chosen.lane)) giveUpState();
}

/** A scene that begins anew has no ghost. */
function followView() {
  /** @type {unknown[]} */
  let before = [];
  return effect(() => {
    const now = [drawHere.value, sceneCount.value];
    if (now.some((cell, number) => cell !== before[number])) giveUpState();
    before = now;
  });
}

function answerClick() {
  const click = clickedCell.value;
  const grid = scene.value?.action_values;
  const at = stageMoment.value;
  if (!click || !grid || !at) return;
  const clickedMove = moveAt(click, grid);
  if (!clickedMove || click.run_id !== at.run_id) {
    clickedCell.value = null;
    return;
  }
  const { lane, move } = clickedMove;
  batch(() => {
    chosenLane.value = lane;
    followStage();
  });
  const cells = presentCells(lane);
  if (!cells) return;
  batch(() => {
    clickedCell.value = null;
    chosenState.value = { run_id: at.run_id, lane, cells, move, from: "scene" };
  });
}

const keepGhost = () => keepAnswer(
  () => {
    const chosen = chosenState.value;
    if (chosen?.from !== "table" || whyNoGhost.value !== null) return "";
    // Legs may be lost meanwhile.
    return JSON.stringify({ ...chosen, clock: clock.value, conditions: conditionsShown.value });
  },
  async (key) => {
    const { run_id, lane, cells, clock: timedBy } = JSON.parse(key);
    const query = { lane: `${lane}`, cells: cells.join(), time_s: `${scene.peek()?.time_s ?? 0}`, clock: timedBy };
    return decode(await getReplayFrames(run_id, "posture", query));
  },
  ghost,
  () => 0,
);

/** Draw the ghost that was answered, and remove the one before. */
function drawGhost() {
  /** The scene node that it is in. @type {string | null} */
  let node = null;
  /** @type {Message[] | null} */
  let drawn = null;
  const remove = () => {
    if (node) drawHere.peek()?.([{ type: "RemoveSceneNodeMessage", name: node, owner: "" }]);
    node = null;
  };
  const stop = effect(() => {
    const isWanted = chosenState.value?.from === "table";
    const messages = (isWanted && ghost.value.answer?.frames[0].messages) || null;
    if (messages === drawn) return;
    drawn = messages;
    if (node !== messages?.[0].name) remove();
    if (!messages) return;
    drawHere.peek()?.(messages);
    node = messages[0].name;
  });
  return () => {
    stop();
    remove();
  };
}
