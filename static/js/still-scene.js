// A scene that a feature draws in the 3D view of this page, in place of what is played.
import { effect } from "@preact/signals";
import { drawHere, isStill } from "./page.js";
import { SceneState } from "./replay-frames.js";

/** @import { Frames, Message } from "./replay-frames.js" */

/** @type {SceneState | null} */
let state = null;
/** @type {(() => void) | null} */
let stopFollowing = null;

const send = (/** @type {Message[]} */ messages) => drawHere.peek()?.(messages);
const removal = (/** @type {SceneState} */ { world }) => ({ type: "RemoveSceneNodeMessage", name: world, owner: "" });

/** Draw all of it, in place of what the 3D view has. */
function begin() {
  if (!state) return;
  const atOrigin = { type: "SetPositionMessage", name: state.world, position: [0, 0, 0], owner: "" };
  send([removal(state), ...state.restart(), atOrigin]);
}

/** Show a scene: at first in place of what is played, then in place of the scene before. @param {Frames} scene */
export function showStill(scene) {
  // The player takes away what it has drawn.
  isStill.value = true;
  if (state) {
    state.rebase(scene);
    send(state.jump([]));
    return;
  }
  state = new SceneState(scene);
  // The 3D view may come later than the scene, or anew.
  stopFollowing = effect(() => {
    if (drawHere.value) begin();
  });
}

/** Take it away; the player draws again. */
export function endStill() {
  if (state) send([removal(state)]);
  stopFollowing?.();
  [state, stopFollowing] = [null, null];
  isStill.value = false;
}
