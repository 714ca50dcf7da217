// The robots in the picture: keeps the poses of their links as the page draws them, and tells how much room each takes.
// Other scripts read it as `hexapodsViewer.robots`. All lengths are in metres, in the frame of the run: x across the
// track, y along it, z up.
(() => {
  "use strict";

  /** Batches of links of legs are named by the legs of their instances: ".../legs-1-2-3-4-5-6". */
  const LEGS = /\/legs((?:-\d+)+)$/;
  const TORSO = /\/torso$/;
  /** Translucent robots: of another run, and of the newest test of a practice. */
  const GHOST = /\/(?:ghost-robots|robots2?-evaluated)\/\d+\/ghost-/;
  /** That of a test stays where it came, and the learner walks on: beyond this it is left out of the picture. */
  const NEAR_M = 1;
  /** Half of what a link is thick, of the robot's reach. */
  const THICKNESS = 0.06;
  const CORNERS = 8;
  /** Half of what a link is thick, of the torso's radius. */
  const THICK = 0.2;

  /** What `robots` tells; null when something has moved since. */
  let known = null;
  /** Name of a batch → {legs, isTorso, tip, radius, top, positions, wxyzs, scales}. */
  const batches = new Map();
  /** How far each end of a link has been from the torso, and over the feet: robots of a scene are of one kind. */
  const reaches = new Map();
  /** The greatest height of a torso over the feet. */
  let standing = 0;

  const floats = (bytes) => (bytes instanceof Float32Array ? bytes
    : new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength)));

  /** The vertex that is farthest from the link's origin: the foot of a tibia, the next joint of the others. */
  const tipOf = (vertices) => {
    let best = [0, 0, 0];
    let far = 0;
    for (let at = 0; at + 2 < vertices.length; at += 3) {
      const [x, y, z] = [vertices[at], vertices[at + 1], vertices[at + 2]];
      if (x * x + y * y + z * z > far) [best, far] = [[x, y, z], x * x + y * y + z * z];
    }
    return best;
  };

  /** How far a mesh reaches to the side of its origin, and over it. */
  const reachOf = (vertices) => {
    let [radius, top] = [0, 0];
    for (let at = 0; at + 2 < vertices.length; at += 3) {
      radius = Math.max(radius, Math.hypot(vertices[at], vertices[at + 1]));
      top = Math.max(top, vertices[at + 2]);
    }
    return { radius, top };
  };

  const add = (name, { vertices, batched_positions, batched_wxyzs, batched_scales }) => {
    const legs = LEGS.exec(name)?.[1].split("-").filter(Boolean).map(Number) ?? null;
    const isTorso = TORSO.test(name);
    if (!legs && !isTorso && !GHOST.test(name)) return;
    const points = floats(vertices);
    if (isTorso) {
      reaches.clear();
      standing = 0;
    }
    batches.set(name, {
      legs, isTorso, tip: tipOf(points), ...reachOf(points), positions: floats(batched_positions),
      wxyzs: floats(batched_wxyzs), scales: batched_scales ? floats(batched_scales) : null,
    });
  };

  const take = ({ type, name, props, updates }) => {
    known = null;
    if (type === "BatchedMeshesMessage") add(name, props);
    else if (type === "SceneNodeUpdateMessage" && batches.has(name)) {
      const batch = batches.get(name);
      if (updates.batched_positions) batch.positions = floats(updates.batched_positions);
      if (updates.batched_wxyzs) batch.wxyzs = floats(updates.batched_wxyzs);
      if (updates.batched_scales) batch.scales = floats(updates.batched_scales);
    } else if (type === "RemoveSceneNodeMessage") {
      for (const batch of batches.keys()) if (batch === name || batch.startsWith(`${name}/`)) batches.delete(batch);
    }
  };

  addEventListener("hexapods:draw", ({ detail }) => detail.messages.forEach(take));

  // ---- poses

  const rotated = ([w, x, y, z], [a, b, c]) => {
    const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
  };

  /** Origin and tip of each instance of a batch that is shown. */
  const instances = (batch) => Array.from({ length: batch.positions.length / 3 }, (_, index) => {
    const origin = [...batch.positions.slice(3 * index, 3 * index + 3)];
    const tip = rotated([...batch.wxyzs.slice(4 * index, 4 * index + 4)], batch.tip);
    return { index, origin, tip: tip.map((coordinate, axis) => coordinate + origin[axis]) };
  }).filter(({ index }) => batch.scales === null || batch.scales[index] > 0);

  /** All links: {name of the batch, place of the link in it, lane, leg, origin, tip}; of a torso the leg is null. */
  const links = () => [...batches].flatMap(([name, batch]) => (batch.legs || batch.isTorso
    ? instances(batch).map(({ index, origin, tip }) => {
      const [count, leg] = batch.legs ? [batch.legs.length, batch.legs[index % batch.legs.length]] : [1, null];
      return { name, place: index % count, lane: Math.floor(index / count), leg, origin, tip };
    }) : []));

  // ---- the room that they take

  const grown = (before, values) =>
    ({ least: values.map((value, axis) => Math.min(value, before?.least[axis] ?? value)),
      most: values.map((value, axis) => Math.max(value, before?.most[axis] ?? value)) });

  /** Take where the ends of a robot's links are from its torso. */
  const stretch = ({ at, ends, low }) => {
    for (const [name, [x, y, z]] of ends) reaches.set(name, grown(reaches.get(name), [x - at[0], y - at[1], z - low]));
    standing = Math.max(standing, at[2] - low);
  };

  /** The robots by lane: {lane, at: place of the torso, ends of links by name, low: height of the lowest foot}. */
  const robots = () => (known ??= measured());
  const measured = () => {
    const lanes = new Map();
    for (const { name, place, lane, leg, origin, tip } of links()) {
      const robot = lanes.get(lane) ?? { lane, at: null, lines: [], ends: new Map() };
      if (leg === null) robot.at = origin;
      else {
        robot.lines.push([origin, tip]);
        robot.ends.set(`${name} ${place}`, tip);
      }
      lanes.set(lane, robot);
    }
    const shown = [...lanes.values()].filter(({ at }) => at !== null).sort((a, b) => a.lane - b.lane);
    for (const robot of shown) robot.low = Math.min(robot.at[2], ...[...robot.ends.values()].map(([, , z]) => z));
    // What a robot has needed once is kept: the picture does not breathe with its legs.
    shown.forEach(stretch);
    return shown;
  };

  /** Radius of the torso, and the height of its top, the antenna, over its middle. */
  const torso = () => {
    const torsos = [...batches.values()].filter(({ isTorso }) => isTorso);
    const [radius, top] = ["radius", "top"].map((part) => Math.max(0, ...torsos.map((batch) => batch[part])));
    return { radius, top };
  };

  const circle = ([x, y], radius, z) => Array.from({ length: CORNERS }, (_, n) => {
    const angle = (2 * Math.PI * n) / CORNERS;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle), z];
  });

  /** Points around what a robot has needed so far, as one of its kind: corners around each end of a link. */
  const pointsOf = ({ at, low }) => {
    const { radius, top } = torso();
    const reach = Math.max(radius, ...[...reaches.values()].flatMap(({ least, most }) =>
      [least[0], least[1], most[0], most[1]].map(Math.abs)));
    const room = THICKNESS * reach;
    const corners = [...reaches.values()].flatMap(({ least, most }) =>
      [least[0] - room, most[0] + room].flatMap((x) => [least[1] - room, most[1] + room].flatMap((y) =>
        [least[2] - room, most[2] + room].map((z) => [at[0] + x, at[1] + y, low + Math.max(0, z)]))));
    const height = Math.max(standing, at[2] - low);
    return [...corners, ...circle(at, radius, low + height), [at[0], at[1], low + height + top]];
  };

  /** Points of the translucent robots that are near one of the others. */
  const ghostPoints = () => {
    const isNear = ([x, y]) => robots().some(({ at }) => Math.hypot(at[0] - x, at[1] - y) < NEAR_M);
    return [...batches].flatMap(([name, batch]) => (GHOST.test(name)
      ? instances(batch).filter(({ origin }) => isNear(origin)).flatMap(({ origin, tip }) => [origin, tip]) : []));
  };

  /** The scene node in whose frame the poses are; null while there are no robots. */
  const root = () => {
    const [name] = batches.keys();
    return name ? name.split("/").slice(0, 3).join("/") : null;
  };

  // ---- where they are in the picture [px]

  /** A point of the run in pixels of the picture; null behind the camera. */
  const projected = (point) => {
    const { camera, canvas, nodeRefFromName } = window.__viserMutable ?? {};
    const node = nodeRefFromName?.[root()];
    if (!camera || !node) return null;
    const at = camera.position.clone().set(...point).applyMatrix4(node.matrixWorld).project(camera);
    if (Math.abs(at.z) >= 1) return null;
    return { x: ((at.x + 1) / 2) * canvas.clientWidth, y: ((1 - at.y) / 2) * canvas.clientHeight };
  };

  const boxAround = (points, room_px) => {
    const [xs, ys] = [points.map(({ x }) => x), points.map(({ y }) => y)];
    return {
      left: Math.min(...xs) - room_px, top: Math.min(...ys) - room_px,
      right: Math.max(...xs) + room_px, bottom: Math.max(...ys) + room_px,
    };
  };

  /** Boxes around the links of each robot, its torso and its antenna: [{lane, boxes}]. */
  const outlines = () => robots().map(({ lane, at, lines }) => {
    const [x, y, z] = at;
    const { radius, top } = torso();
    const [middle, beside] = [projected(at), projected([x + radius, y, z])];
    const room_px = middle && beside ? THICK * Math.hypot(beside.x - middle.x, beside.y - middle.y) : 0;
    const boxesOf = (shapes, room) => shapes.map((points) => points.map(projected))
      .filter((points) => points.every((point) => point !== null)).map((points) => boxAround(points, room));
    const solid = boxesOf([...lines, circle(at, radius, z)], room_px);
    return { lane, boxes: [...solid, ...boxesOf([[at, [x, y, z + top]]], room_px / 2)] };
  });

  window.hexapodsViewer = {
    ...window.hexapodsViewer, robots: { robots, links, pointsOf, ghostPoints, root, projected, outlines },
  };
})();
