// viser's client without a server: it is told that it is connected to an empty scene, which js/offline/player.js draws.
// Dispatches `hexapods:connected` when it is. Assumptions about the client: hexapods/drawing/viser_internals.
(() => {
  "use strict";

  window.Worker = class extends Worker {
    postMessage(message, ...rest) {
      if (message?.type !== "set_server") return super.postMessage(message, ...rest);
      setTimeout(() => {
        for (const data of [
          { type: "connected" },
          { type: "message_batch", messages: [{ type: "ReplayDoneMessage" }] },
        ]) {
          this.dispatchEvent(new MessageEvent("message", { data }));
        }
        dispatchEvent(new Event("hexapods:connected"));
      });
      return undefined;
    }
  };
})();
