// The scene's labels as elements over the canvas. viser draws its own in one size, black on white in every
// theme, and on top of each other; here they follow the theme and give way to each other.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   events   hexapods:show {lanes?: colours of the lanes, names?: what their robots are called in place of the names of
//            their agents, labelPx?: size of the type on a projector, covered?: [{left, top, right, bottom}], what is
//            shown over the picture, in pixels of it}
//            hexapods:draw {messages: of viser}
(() => {
  "use strict";

  const EDGE_PX = 4;
  const GAP_PX = 4;
  const STEM_FROM_PX = 8;
  /** By how much of its width a label gives way to the side, what that costs of its distance, and to be below. */
  const SHIFTS = [0, -0.3, 0.3, -0.6, 0.6, -0.9, 0.9, -1.1, 1.1];
  const [SIDEWAYS, BELOW_PX] = [0.8, 40];

  /** Name of the scene node → {element, anchor, text, size}; the size is unknown until it is measured. */
  const labels = new Map();
  let covered = [];
  /** Height of the highest label of a robot so far [px]. */
  let highest = 0;
  let lanes = [];
  let names = [];
  /** Patterns of words of labels with what is written for them in the page's language. */
  let words = [];
  let mark = ".";
  let labelPx = null;

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

  /** The text of a label with the name that its robot has here; at the photo finish its place is before that. */
  const named = ({ name, text }) => {
    const called = names[laneOf(name)];
    return called ? text.replace(/^(\d+\. )?.*/, (_, place = "") => `${place}${called}`) : text;
  };

  /** A label in the page's language; of a robot its first line is a name, and stays. */
  const translated = (label) => {
    const [first, ...others] = named(label).split("\n");
    const inWords = (line) => words.reduce((now, [word, other]) => now.replace(new RegExp(word, "u"), other), line)
      .replace(/(\d)\.(\d)/g, `$1${mark}$2`);
    return [laneOf(label.name) === null ? inWords(first) : first, ...others.map(inWords)].join("\n");
  };

  const write = (label, text) => {
    label.text = text;
    label.element.replaceChildren(...translated(label).split("\n").map((line) => {
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

  /** The lane whose robot a label names; null of others. */
  const laneOf = (name) => /\/lane(\d+)\/label$/.exec(name)?.[1] ?? null;

  const paint = ({ name, element }) => {
    const lane = laneOf(name);
    if (lane !== null && lanes[lane]) element.style.setProperty("--agent", lanes[lane]);
  };

  const rename = (next) => {
    if (String(next) === String(names)) return;
    names = next;
    labels.forEach((label) => write(label, label.text));
  };

  const resize = (px) => {
    if (px === labelPx) return;
    labelPx = px;
    document.documentElement.style.setProperty("--label", `${px}px`);
    measureAnew();
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
    if (String(detail.words ?? []) !== String(words)) {
      [words, mark] = [detail.words ?? [], detail.mark ?? "."];
      labels.forEach((label) => write(label, label.text));
    }
    rename(detail.names ?? names);
    resize(detail.labelPx ?? labelPx);
    window.__viserMutable?.requestRender();
  });

  // ---- their places, after each frame that is drawn

  const start = () => {
    document.body.append(layer);
    addEventListener("resize", measureAnew);
    const attach = () => {
      const { scene } = window.__viserMutable ?? {};
      if (scene) scene.onAfterRender = place;
      else requestAnimationFrame(attach);
    };
    attach();
  };

  const measureAnew = () => {
    highest = 0;
    labels.forEach((label) => (label.size = null));
  };

  /** Those of the robots come first, and last the words on the ground, which are left out where there is no room. */
  const inOrder = () => [...labels.values()].sort((a, b) => rankOf(a) - rankOf(b));
  const rankOf = (label) => (isFixed(label) ? 2 : laneOf(label.name) === null ? 1 : 0);
  const isFixed = ({ anchor }) => anchor.startsWith("center");

  /** Size of the picture [px]. */
  const pictureSize = () => {
    const { clientWidth, clientHeight } = window.__viserMutable.canvas;
    return { width: clientWidth, height: clientHeight };
  };

  const place = () => {
    const { camera } = window.__viserMutable;
    const picture = pictureSize();
    const robots = window.hexapodsViewer.robots.outlines().flatMap(({ boxes }) => boxes);
    const taken = [...covered, ...robots];
    for (const label of inOrder()) {
      const { element } = label;
      const point = positionOf(label)?.project(camera);
      const isInView = point && Math.abs(point.x) < 1.1 && Math.abs(point.y) < 1.1 && Math.abs(point.z) < 1;
      element.hidden = !isInView;
      if (!isInView) continue;
      measure(label);
      const at = { x: ((point.x + 1) / 2) * picture.width, y: ((1 - point.y) / 2) * picture.height };
      const box = label.size.height > 0 && roomFor(label, at, taken, picture);
      element.hidden = !box;
      if (!box) continue;
      taken.push(box);
      move(label, box, at);
    }
  };

  /** Measure a label whose text is new. */
  const measure = (label) => {
    if (label.size) return;
    const { width, height } = label.element.getBoundingClientRect();
    label.size = { width: Math.ceil(width), height: Math.ceil(height) };
    if (laneOf(label.name) !== null) highest = Math.max(highest, label.size.height);
  };

  /** Put a label into its box, with a stem to what it names where that is not right beside it. */
  const move = ({ element }, box, at) => {
    element.style.translate = `${Math.round(box.left)}px ${Math.round(box.top)}px`;
    const stem = Math.round(at.y - box.bottom);
    const isOver = at.x >= box.left && at.x <= box.right;
    element.style.setProperty("--stem", `${isOver && stem > STEM_FROM_PX ? stem : 0}px`);
    element.style.setProperty("--stem-x", `${Math.round(at.x - box.left)}px`);
  };

  /** Where a label is in the world; null until its parent is made. A label has no object of its own. */
  const positionOf = ({ name }) => {
    const { camera, nodePoseData, nodeRefFromName } = window.__viserMutable;
    const parentNode = nodeRefFromName[name.slice(0, name.lastIndexOf("/"))];
    if (!parentNode) return null;
    const position = nodePoseData[name]?.position ?? [0, 0, 0];
    return camera.position.clone().set(...position).applyMatrix4(parentNode.matrixWorld);
  };

  /** The free box that is nearest to where a label belongs; null if there is none. */
  const roomFor = (label, { x, y }, taken, picture) => {
    const { anchor, size: { width, height } } = label;
    const boxAt = (left, top) => ({ left, top, right: left + width, bottom: top + height });
    const blocking = (box) => taken.find((other) => intersects(other, box));
    const isIn = (box) => box.left >= 0 && box.top >= 0 && box.right <= picture.width && box.bottom <= picture.height;
    const within = (value, most) => Math.max(EDGE_PX, Math.min(value, most - EDGE_PX));
    const offset = { bottom: -height, center: -height / 2, top: 0 }[anchor.split("-")[0]];
    const top = Math.round(within(y + offset, picture.height - height));
    if (isFixed(label)) {
      const box = boxAt(Math.round(x - width / 2), Math.round(y + offset));
      return isIn(box) && !blocking(box) ? box : null;
    }
    /** From a place up or down, until it is free. */
    const search = (left, direction) => {
      let box = boxAt(left, top);
      for (let other = blocking(box); other; other = blocking(box)) {
        box = boxAt(left, direction < 0 ? Math.floor(other.top) - GAP_PX - height : Math.ceil(other.bottom) + GAP_PX);
        if (!isIn(box)) return null;
      }
      return box;
    };
    const lefts = SHIFTS.map((shift) => Math.round(within(x - width / 2 + shift * width, picture.width - width)));
    const boxes = lefts.flatMap((left) => [search(left, -1), search(left, 1)]).filter(Boolean);
    const costOf = (box) => Math.abs(box.top - top) + SIDEWAYS * Math.abs(box.left - lefts[0])
      + (box.top > top && offset < 0 ? BELOW_PX : 0);
    return boxes.reduce((best, box) => (best === null || costOf(box) < costOf(best) ? box : best), null);
  };

  const intersects = (a, b) =>
    a.left < b.right + GAP_PX && b.left < a.right + GAP_PX && a.top < b.bottom + GAP_PX && b.top < a.bottom + GAP_PX;

  window.hexapodsViewer = { ...window.hexapodsViewer, labels: { height: () => highest } };
})();
