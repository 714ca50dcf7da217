// Clicks on the cells of the foot grids, and on the parts of a robot from a file, which the page around this one is
// told; the server hears nothing of them.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   to the parent     {type: "hexapods:click", node, instance}: the name of a node of footgrid.py, and the number of
//                     the cell in its batch; or the name of a node ".../part/3" or ".../foot/2"
(() => {
  "use strict";

  if (parent === window) return;

  const CELLS = /\/grid\/(home|others)\/fills$/;
  const PARTS = /\/(part|foot)\/\d+$/;
  const BINDINGS = [{ button: "left", modifier: null }];

  /** The messages that make the cells and parts among new nodes clickable. */
  const bindingsOf = (messages) => messages
    .filter(({ type, name }) => (type === "BatchedMeshesMessage" && CELLS.test(name))
      || (/Mesh|Glb|Icosphere|Box|Cylinder/.test(type) && PARTS.test(name)))
    .map(({ name }) => ({ type: "SetSceneNodeClickBindingsMessage", name, bindings: BINDINGS, owner: "" }));

  window.Worker = class extends Worker {
    postMessage(message, ...rest) {
      const { type, name, instance_index } = message?.message ?? {};
      if (message?.type !== "send" || type !== "SceneNodeClickMessage") return super.postMessage(message, ...rest);
      parent.postMessage({ type: "hexapods:click", node: name, instance: instance_index }, location.origin);
      return undefined;
    }
  };

  // Before that of labels.js, which draws them.
  addEventListener("hexapods:draw", ({ detail }) => detail.messages.push(...bindingsOf(detail.messages)));
})();
