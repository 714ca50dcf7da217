// The body that is edited as a scene: drawn by the server, and shown in a 3D view of the editor's own.
import { effect, signal } from "@preact/signals";
import { call, keepAnswer } from "../../js/api.js";
import { shownTheme } from "../../js/page.js";
import { SceneState, unpack } from "../../js/replay-frames.js";
import { previewAnswer } from "./body-editor.js";
import { bodyIsOpen } from "./dialogs.js";
import { arrowPoints, extentOf, numberPoint, viewOf } from "./sketch-geometry.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Reply } from "../../js/api.js" */
/** @import { Frames } from "../../js/replay-frames.js" */
/** @import { Reading } from "./reading.js" */

/** A point of the picture [px]. @typedef {{ x: number, y: number }} Place */
/** @typedef {{ reading: Reading, scene: Frames }} BodyScene */

/** After an answer the server is asked about the next body so late [ms]. */
const PAUSE_MS = 60;
const MARGINS = { side: 8, top: 22, bottom: 8 };

/** @type {Signal<Reply<BodyScene>>} */
const reply = signal({ answer: null, error: null, again: false });
/** The body that is shown. @type {Signal<BodyScene | null>} */
export const bodyScene = signal(null);
/** By how much a person has turned it [°]. */
export const turned_deg = signal(0);
/** Where its arrow and the numbers of its legs are, and whence it is seen; null until that is told. */
/** @type {Signal<{ arrow: (Place | null)[], numbers: (Place | null)[], azimuth_deg: number } | null>} */
export const bodyPlaces = signal(null);

/** The body that the server has previewed last, with its gait: one that cannot be built is not shown. */
function question() {
  const answer = previewAnswer.value;
  if (!bodyIsOpen.value || !answer) return "";
  return JSON.stringify({ robot: JSON.parse(answer.of).asked.robot, gait: answer.gait });
}

/** @param {string} key @returns {Promise<BodyScene>} */
async function ask(key) {
  const reading = /** @type {Reading} */ (await call("POST", "robots/readings", JSON.parse(key)));
  return { reading, scene: await unpack(reading.scene) };
}

/**
 * Show the body in a frame of the 3D view, until the function that is returned is called.
 * @param {HTMLIFrameElement} frame
 */
export function showBodyIn(frame) {
  /** @type {SceneState | null} */
  let state = null;
  let lists = 0;
  const isConnected = signal(false);
  const send = (/** @type {object} */ message) => frame.contentWindow?.postMessage(message, location.origin);
  const onMessage = (/** @type {MessageEvent} */ { origin, source, data }) => {
    if (origin !== location.origin || source !== frame.contentWindow) return;
    if (data?.type === "hexapods:status") isConnected.value = true;
    if (data?.type === "hexapods:places") takePlaces(data.places);
  };
  addEventListener("message", onMessage);
  const stops = [
    keepAnswer(question, ask, reply, () => PAUSE_MS),
    effect(() => {
      if (reply.value.answer) bodyScene.value = reply.value.answer;
    }),
    effect(() => send({ type: "hexapods:show", theme: shownTheme.value, isConnected: isConnected.value })),
    effect(() => {
      const shown = bodyScene.value;
      if (!isConnected.value || !shown) return;
      if (state) state.rebase(shown.scene);
      const messages = state ? state.jump([]) : shown.scene.frames.flatMap((drawn) => drawn.messages);
      state ??= new SceneState(shown.scene);
      send({ type: "hexapods:draw", messages });
    }),
    effect(() => {
      const shown = bodyScene.value;
      if (!isConnected.value || !shown) return;
      const extent = extentOf(shown.scene);
      const points = [
        ...arrowPoints(extent, 0), ...shown.reading.feet.map(({ at_m }) => numberPoint(at_m, extent)),
      ];
      lists += 1;
      send({ type: "hexapods:inspect", inspection: {
        world: shown.scene.world, ...viewOf(extent), points, of: lists, isTurning: false,
        turned_deg: turned_deg.value, margins_px: MARGINS,
      } });
    }),
  ];
  return () => {
    stops.forEach((stop) => stop());
    removeEventListener("message", onMessage);
    [bodyScene.value, bodyPlaces.value] = [null, null];
  };
}

const ARROW_POINTS = 7;

/** @param {{ points: (Place | null)[], azimuth_deg: number }} places */
function takePlaces({ points, azimuth_deg }) {
  bodyPlaces.value = { arrow: points.slice(0, ARROW_POINTS), numbers: points.slice(ARROW_POINTS), azimuth_deg };
}
