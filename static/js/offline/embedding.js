// The page around that of a file: what it says by messages is done and answered. docs/exports.md has the interface.
import { commandOf, InvalidCommand } from "./commands.js";

/** @import { Player } from "./replay-player.js" */

/** What every message from this page tells. @param {Player} player */
const stateOf = (player) => {
  const { time_s, duration_s, paused, speed, clock, follow } = player;
  const { camera: kept, isLive: live } = player.view;
  const camera = kept && { position: kept.position, look_at: kept.look_at };
  return { time_s, duration_s, paused, speed, clock, follow, camera, live };
};

/** Names the message that is answered, if that has a name. @type {(id: unknown) => object} */
const answerTo = (id) => (id === undefined ? {} : { id });

/**
 * Obey the page around this one, and tell it the state; nothing happens where there is none. The page around may be
 * any: nothing but moment, speed, clock and camera can be set, and nothing else is told.
 * @param {Player} player
 * @param {string[]} errors sentences on what is not valid in the address
 */
export function followParent(player, errors) {
  if (parent === window) return;
  /** @param {object} message @param {string} origin of who is to get it; any may */
  const tell = (message, origin = "*") => parent.postMessage(message, origin);
  addEventListener("message", ({ source, origin, data }) => {
    if (source !== parent) return;
    // A page that is a file, or in a sandbox, has an origin without a name, which no message can be addressed to.
    const asker = origin === "null" || origin === "" || origin === "file://" ? "*" : origin;
    try {
      const command = commandOf(data, player.limits);
      if (command === null) return;
      player.obey(command);
      player.view.use();
      tell({ type: "hexapods:state", ...answerTo(data.id), ...stateOf(player) }, asker);
    } catch (error) {
      if (!(error instanceof InvalidCommand)) throw error;
      tell({ type: "hexapods:error", ...answerTo(data.id), error: error.message }, asker);
    }
  });
  player.addEventListener("timeupdate", () => tell({ type: "hexapods:timeupdate", ...stateOf(player) }));
  player.addEventListener("ready", () => {
    tell({ type: "hexapods:ready", ...stateOf(player) });
    for (const error of errors) tell({ type: "hexapods:error", error });
  });
}
