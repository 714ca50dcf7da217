// The frame of a robot beside the one of the class: plays the run, the moment and the pace that its projector tells it.
import { useEffect } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { page } from "../../../js/page-state.js";
import { followPlayer, openReplay, playReplay, position, seekReplay, setReplaySpeed } from "../../../js/player.js";
import { nameBeside } from "./lane-names.js";
import { Picture, typeAround } from "./picture.js";

/** By how much the picture may be off the other one, in its own time [s]. */
const DRIFT_S = 0.16;
export const MESSAGE = "hexapods:beside";

/**
 * `name`: what the robot is called. `typePx`: size of the type around the frame.
 * @typedef {{
 *   type: string, run_id: string, time_s: number, rate: number, isPlaying: boolean, name: string, typePx: number,
 * }} BesideMessage
 */

followPlayer({ ofStage: () => false });

/** @param {BesideMessage} message */
function follow({ run_id, time_s, rate, isPlaying, name, typePx }) {
  [nameBeside.value, typeAround.value] = [name, typePx];
  setReplaySpeed(rate);
  if (page.run.peek() !== run_id) {
    openReplay(run_id, { time_s, isPlaying });
    return;
  }
  if (Math.abs(position.peek() - time_s) > DRIFT_S) seekReplay(time_s);
  if (isPlaying !== (page.moment.peek() === null)) playReplay(isPlaying);
}

export function Beside() {
  useEffect(() => {
    const onMessage = (/** @type {MessageEvent} */ { origin, source, data }) => {
      if (origin === globalThis.origin && source === parent && data?.type === MESSAGE) follow(data);
    };
    addEventListener("message", onMessage);
    return () => removeEventListener("message", onMessage);
  }, []);
  return html`<main class="beside-frame"><${Picture} isProjected=${true} /></main>`;
}
