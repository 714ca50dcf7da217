// The scene's labels as elements over the canvas. viser draws its own in one size, black on white in every
// theme, and on top of each other; here they follow the theme and give way to each other.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   events   hexapods:show {lanes?: colours of the lanes, covered?: [{left, top, right, bottom}], what is shown over
//            the picture, in pixels of it}
//            hexapods:draw {messages: of viser}
(() => {
  "use strict";

  const EDGE_PX = 4;
  const GAP_PX = 2;
  const STEM_FROM_PX = 8;

  /** Name of the scene node → {element, anchor, size}; the size is unknown until it is measured. */
  const labels = new Map();
  let covered = [];
  let lanes = [];

  const layer = document.createElement("div");
  layer.className = "labels";
  layer.ariaHidden = "true";

  // ---- the labels, taken out of viser's messages: there they are empty

  const take = (message) => {
    const { type, name } = message;
    if (type === "LabelMessage") {
      remove(name);
      add(name, message.props);
      Object.assign(message.props, { text: "", font_screen_scale: 0 });
    } else if (type === "SceneNodeUpdateMessage" && labels.has(name) && "text" in message.updates) {
      const label = labels.get(name);
      write(label, message.updates.text);
      message.updates.text = "";
    } else if (type === "RemoveSceneNodeMessage") {
      for (const label of labels.keys()) if (label === name || label.startsWith(`${name}/`)) remove(label);
    }
  };

  const add = (name, { text, anchor }) => {
    const label = { name, element: document.createElement("div"), anchor, size: null };
    label.element.hidden = true;
    label.element.dataset.anchor = anchor;
    labels.set(name, label);
    layer.append(label.element);
    write(label, text);
    paint(label);
    if (!layer.isConnected) start();
  };

  const write = (label, text) => {
    label.element.replaceChildren(...text.split("\n").map((line) => {
      const element = document.createElement("div");
      element.textContent = line;
      return element;
    }));
    label.size = null;
  };

  const remove = (name) => {
    labels.get(name)?.element.remove();
    labels.delete(name);
  };

  const paint = ({ name, element }) => {
    const lane = /\/lane(\d+)\/label$/.exec(name)?.[1];
    if (lane && lanes[lane]) element.style.setProperty("--agent", lanes[lane]);
  };

  // ---- messages that the page draws come by the client's queue

  let client;
  /** Drawn before the client has a queue: nobody sends them again. */
  const early = [];

  // A page pushes the same objects whenever it draws them again, so they are copied.
  const copyOf = (message) => {
    const copy = { ...message };
    for (const part of ["props", "updates"]) if (message[part]) copy[part] = { ...message[part] };
    return copy;
  };

  const draw = (messages) => {
    if (!client) {
      early.push(...messages);
      return;
    }
    const copies = messages.map(copyOf);
    copies.forEach(take);
    client.messageQueue.push(...copies);
    client.requestRender?.();
  };

  Object.defineProperty(window, "__viserMutable", {
    configurable: true,
    get: () => client,
    set: (value) => {
      client = value;
      draw(early.splice(0));
    },
  });

  addEventListener("hexapods:draw", ({ detail }) => draw(detail.messages));
  addEventListener("hexapods:show", ({ detail }) => {
    covered = detail.covered ?? covered;
    lanes = detail.lanes ?? lanes;
    labels.forEach(paint);
    window.__viserMutable?.requestRender();
  });

  // ---- their places, after each frame that is drawn

  const start = () => {
    document.body.append(layer);
    addEventListener("resize", () => labels.forEach((label) => (label.size = null)));
    const attach = () => {
      const { scene } = window.__viserMutable ?? {};
      if (scene) scene.onAfterRender = place;
      else requestAnimationFrame(attach);
    };
    attach();
  };

  /** Those that cannot move come last: they are left out where there is no room. */
  const inOrder = () => [...labels.values()].sort((a, b) => isFixed(a) - isFixed(b));
  const isFixed = ({ anchor }) => anchor.startsWith("center");

  /** Size of the picture [px]. */
  const pictureSize = () => {
    const { clientWidth, clientHeight } = window.__viserMutable.canvas;
    return { width: clientWidth, height: clientHeight };
  };

  const place = () => {
    const { camera } = window.__viserMutable;
    const picture = pictureSize();
    const taken = [...covered];
    for (const label of inOrder()) {
      const { element } = label;
      const point = positionOf(label)?.project(camera);
      const isInView = point && Math.abs(point.x) < 1.1 && Math.abs(point.y) < 1.1 && Math.abs(point.z) < 1;
      element.hidden = !isInView;
      if (!isInView) continue;
      label.size ??= sizeOf(element);
      const at = { x: ((point.x + 1) / 2) * picture.width, y: ((1 - point.y) / 2) * picture.height };
      const box = label.size.height > 0 && roomFor(label, at, taken, picture);
      element.hidden = !box;
      if (!box) continue;
      taken.push(box);
      element.style.translate = `${Math.round(box.left)}px ${Math.round(box.top)}px`;
      const stem = Math.round(at.y - box.bottom);
      element.style.setProperty("--stem", `${stem > STEM_FROM_PX ? stem : 0}px`);
      element.style.setProperty("--stem-x", `${Math.round(at.x - box.left)}px`);
    }
  };

  const sizeOf = (element) => {
    const { width, height } = element.getBoundingClientRect();
    return { width: Math.ceil(width), height: Math.ceil(height) };
  };

  /** Where a label is in the world; null until its parent is made. A label has no object of its own. */
  const positionOf = ({ name }) => {
    const { camera, nodePoseData, nodeRefFromName } = window.__viserMutable;
    const parentNode = nodeRefFromName[name.slice(0, name.lastIndexOf("/"))];
    if (!parentNode) return null;
    const position = nodePoseData[name]?.position ?? [0, 0, 0];
    return camera.position.clone().set(...position).applyMatrix4(parentNode.matrixWorld);
  };

  /** The free box that is nearest to a label's point: above or below it; null if there is none. */
  const roomFor = ({ anchor, size: { width, height } }, { x, y }, taken, picture) => {
    const left = Math.max(EDGE_PX, Math.min(x - width / 2, picture.width - width - EDGE_PX));
    const offset = { bottom: -height, center: -height / 2, top: 0 }[anchor.split("-")[0]];
    const boxAt = (top) => ({ left, top, right: left + width, bottom: top + height });
    const blocking = (box) => taken.find((other) => intersects(other, box));
    const search = (direction) => {
      let box = boxAt(Math.round(Math.max(EDGE_PX, Math.min(y + offset, picture.height - height - EDGE_PX))));
      for (let other = blocking(box); other; other = blocking(box)) {
        if (!direction) return null;
        box = boxAt(direction < 0 ? Math.floor(other.top) - GAP_PX - height : Math.ceil(other.bottom) + GAP_PX);
        if (box.top < 0 || box.bottom > picture.height) return null;
      }
      return box;
    };
    if (isFixed({ anchor })) return search(0);
    return offset < 0 ? search(-1) ?? search(1) : search(1) ?? search(-1);
  };

  const intersects = (a, b) =>
    a.left < b.right + GAP_PX && b.left < a.right + GAP_PX && a.top < b.bottom + GAP_PX && b.top < a.bottom + GAP_PX;
})();
