// Preparations of viser's client that every page with it needs before it runs. Dispatches `hexapods:connected` when the
// client shows its scene. Assumptions about it are listed and tested in hexapods/drawing/viser_internals.
(() => {
  "use strict";

  // ---- the Content-Security-Policy forbids code from strings. viser's sorter of Gaussian splats makes
  // some when it loads; as the stage has no splats, it gets functions that do nothing
  window.Function = new Proxy(Function, {
    apply: () => () => () => {},
    construct: () => () => () => {},
  });

  // ---- the client is told that it is connected to an empty scene, which the page draws: no websocket is opened
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
