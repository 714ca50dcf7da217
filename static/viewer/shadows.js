// Moves the shadows under robots: a disc below each torso, and one below the lowest point of each leg, which is the
// smaller the higher that is. Frames of a run do not say where they are: the poses of links that are drawn do.
// Their nodes and meshes are made by hexapods/drawing/contact_shadows.py.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   events   hexapods:draw {messages: of viser}, to which it adds
(() => {
  "use strict";

  /** A batch of a robot's links: the robots' node, its number, and of legs their numbers. */
  const PART = /^(.*)\/(\d+)\/(?:ghost-)?(?:torso|legs((?:-\d+)+))$/;
  const SHADOWS = /^(.*)\/(?:ghost-)?shadows$/;
  const GROUND = /\/lane\d+\/ground$/;
  const BUMPS = /^(.*\/ground)\/bumps\d+$/;

  const ABOVE_M = 0.0062;
  const TORSO_REACH = 1.9;
  const FOOT_M = 0.036;
  const LEAST_FOOT = 0.35;
  /** From here on a foot casts the least shadow. */
  const HIGH_M = 0.06;
  /** Of the torso of a robot to which these lengths belong. */
  const USUAL_M = 0.1;
  const LEAST_SIZE = 0.2;

  /** Node of robots → {torsos, legs: batches by number, shadows: name of their node or null, isMoved}. */
  const groups = new Map();
  /** Node of a lane's ground → {x_m, heights: {xs, ys, at}, or null until it is needed, bumps by name}. */
  const grounds = new Map();

  const floats = (bytes) => (bytes instanceof Float32Array || !bytes ? bytes
    : new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength)));

  // ---- shapes

  const DIRECTIONS = [-1, 0, 1].flatMap((x) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((z) => [x, y, z])))
    .filter((direction) => direction.some(Boolean));

  /** The vertices of a mesh that are farthest out in some direction: one of them is about the lowest in any pose. */
  const outermost = (vertices) => {
    const best = DIRECTIONS.map(() => ({ far: -Infinity, at: 0 }));
    for (let at = 0; at + 2 < vertices.length; at += 3) {
      DIRECTIONS.forEach(([x, y, z], n) => {
        const far = x * vertices[at] + y * vertices[at + 1] + z * vertices[at + 2];
        if (far > best[n].far) best[n] = { far, at };
      });
    }
    return [...new Set(best.map(({ at }) => at))].map((at) => [...vertices.slice(at, at + 3)]);
  };

  const rotated = ([w, x, y, z], [a, b, c]) => {
    const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
  };

  const pointOf = ({ positions, wxyzs }, index, point) =>
    rotated(wxyzs.subarray(4 * index, 4 * index + 4), point)
      .map((coordinate, axis) => coordinate + positions[3 * index + axis]);

  /** The lowest point of a link. */
  const lowestOf = (batch, index) => batch.corners.reduce((lowest, corner) => {
    const point = pointOf(batch, index, corner);
    return lowest && lowest[2] <= point[2] ? lowest : point;
  }, null);

  const isShown = ({ scales }, index) => !scales || scales[index] > 0;

  // ---- messages

  const groupAt = (root) => {
    if (!groups.has(root)) groups.set(root, { torsos: new Map(), legs: new Map(), shadows: null, isMoved: false });
    return groups.get(root);
  };

  const takePart = ([, root, number, legs], { vertices, batched_positions, batched_wxyzs, batched_scales }) => {
    const group = groupAt(root);
    group.isMoved = true;
    (legs ? group.legs : group.torsos).set(Number(number), {
      legs: legs?.split("-").filter(Boolean).map(Number), corners: outermost(floats(vertices)),
      positions: floats(batched_positions), wxyzs: floats(batched_wxyzs), scales: floats(batched_scales),
    });
  };

  const movePart = ([, root, number, legs], updates) => {
    const group = groups.get(root);
    const batch = (legs ? group?.legs : group?.torsos)?.get(Number(number));
    if (!batch) return;
    const { batched_positions, batched_wxyzs, batched_scales } = updates;
    if (batched_positions) batch.positions = floats(batched_positions);
    if (batched_wxyzs) batch.wxyzs = floats(batched_wxyzs);
    if (batched_scales !== undefined) batch.scales = floats(batched_scales);
    group.isMoved ||= Boolean(batched_positions || batched_wxyzs || batched_scales !== undefined);
  };

  const groundAt = (name) => {
    if (!grounds.has(name)) grounds.set(name, { x_m: 0, bumps: new Map(), heights: null });
    return grounds.get(name);
  };

  const moveAll = () => groups.forEach((group) => (group.isMoved = true));

  const forget = (name) => {
    const isGone = (node) => node === name || node.startsWith(`${name}/`);
    for (const root of groups.keys()) if (isGone(root)) groups.delete(root);
    for (const ground of grounds.keys()) {
      if (isGone(ground)) {
        grounds.delete(ground);
        moveAll();
      }
    }
  };

  const take = (message) => {
    const { type, name = "" } = message;
    if (type === "RemoveSceneNodeMessage") forget(name);
    else if (type === "SceneNodeUpdateMessage") {
      const part = PART.exec(name);
      if (part) movePart(part, message.updates);
    } else if (type === "BatchedMeshesMessage") {
      const part = PART.exec(name);
      if (part) takePart(part, message.props);
    } else if (type === "BatchedGlbMessage") {
      const root = SHADOWS.exec(name)?.[1];
      if (root) Object.assign(groupAt(root), { shadows: name, isMoved: true });
    } else if (type === "MeshMessage" && BUMPS.test(name)) {
      const ground = groundAt(BUMPS.exec(name)[1]);
      ground.bumps.set(name, floats(message.props.vertices));
      ground.heights = null;
      moveAll();
    } else if (type === "SetPositionMessage" && GROUND.test(name)) groundAt(name).x_m = message.position[0];
  };

  // ---- the height of rough ground, from the grid of points that is drawn

  const heightsOf = (ground) => {
    const points = [...ground.bumps.values()];
    const sorted = (axis) => [...new Set(points.flatMap((vertices) =>
      Array.from({ length: vertices.length / 3 }, (_, n) => vertices[3 * n + axis])))].sort((a, b) => a - b);
    const [xs, ys] = [sorted(0), sorted(1)];
    const [columns, rows] = [xs, ys].map((values) => new Map(values.map((value, n) => [value, n])));
    const at = new Float32Array(xs.length * ys.length);
    for (const vertices of points) {
      for (let n = 0; n < vertices.length; n += 3) {
        at[rows.get(vertices[n + 1]) * xs.length + columns.get(vertices[n])] = vertices[n + 2];
      }
    }
    return { xs, ys, at };
  };

  /** The ground of the lane that is at a place across the track, if it is rough. */
  const roughAt = (x) => {
    let nearest = null;
    for (const ground of grounds.values()) {
      if (!nearest || Math.abs(ground.x_m - x) < Math.abs(nearest.x_m - x)) nearest = ground;
    }
    if (!nearest?.bumps.size) return null;
    nearest.heights ??= heightsOf(nearest);
    return nearest;
  };

  /** Of a point of the track the height of its ground, and how steep that is towards x and y. */
  const groundUnder = (x, y) => {
    const rough = roughAt(x);
    if (!rough) return { z: 0, east: 0, north: 0 };
    const { xs, ys, at } = rough.heights;
    const cell = (values, value) => {
      const side = (values.at(-1) - values[0]) / (values.length - 1);
      const place = Math.min(Math.max((value - values[0]) / side, 0), values.length - 1.001);
      return { n: Math.floor(place), share: place % 1, side };
    };
    const [across, along] = [cell(xs, x - rough.x_m), cell(ys, y)];
    const height = (right, up) => at[(along.n + up) * xs.length + across.n + right];
    const low = height(0, 0) + across.share * (height(1, 0) - height(0, 0));
    const high = height(0, 1) + across.share * (height(1, 1) - height(0, 1));
    return {
      z: low + along.share * (high - low),
      east: (height(1, 0) - height(0, 0) + height(1, 1) - height(0, 1)) / (2 * across.side),
      north: (high - low) / along.side,
    };
  };

  // ---- where shadows are

  /** Centre and halves of the sides of the torso, in its own frame; its antenna is its last part. */
  const outlineOf = (group) => {
    const numbers = [...group.torsos.keys()].sort((a, b) => a - b);
    const corners = (numbers.length > 1 ? numbers.slice(0, -1) : numbers)
      .flatMap((number) => group.torsos.get(number).corners);
    const [low, high] = [Math.min, Math.max].map((most) =>
      [0, 1].map((axis) => most(...corners.map((corner) => corner[axis]))));
    return {
      middle: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, 0],
      halves: [(high[0] - low[0]) / 2, (high[1] - low[1]) / 2],
    };
  };

  const placeTorso = (shadow, batch, lane, { middle, halves }) => {
    const [x, y] = pointOf(batch, lane, middle);
    const [ahead_x, ahead_y] = pointOf(batch, lane, [middle[0], middle[1] + 1, 0]);
    const half_rad = Math.atan2(x - ahead_x, ahead_y - y) / 2;
    // A large disc lies over all bumps.
    const highest = (roughAt(x)?.heights.at ?? []).reduce((most, height) => Math.max(most, height), 0);
    shadow.place([x, y, highest + ABOVE_M], ...halves.map((half) => half * TORSO_REACH));
    shadow.turn(Math.cos(half_rad), 0, 0, Math.sin(half_rad));
  };

  const placeFoot = (shadow, [x, y, z], size) => {
    const ground = groundUnder(x, y);
    const share = Math.max(LEAST_FOOT, 1 - Math.max(0, z - ground.z) / (HIGH_M * size));
    shadow.place([x, y, ground.z + ABOVE_M], FOOT_M * size * share, FOOT_M * size * share);
    // From the vertical to the normal of the ground.
    const w = 1 + Math.hypot(ground.east, ground.north, 1);
    const length = Math.hypot(w, ground.east, ground.north);
    shadow.turn(w / length, ground.north / length, -ground.east / length, 0);
  };

  /** Of each leg of a robot its lowest point, by the legs' order; null of those that are not drawn. */
  const feetOf = (group, lane) => {
    const feet = new Map();
    for (const batch of group.legs.values()) {
      batch.legs.forEach((leg, n) => {
        const index = lane * batch.legs.length + n;
        const point = isShown(batch, index) ? lowestOf(batch, index) : null;
        const before = feet.get(leg) ?? null;
        feet.set(leg, before && (!point || before[2] <= point[2]) ? before : point);
      });
    }
    return [...feet.keys()].sort((a, b) => a - b).map((leg) => feet.get(leg));
  };

  const shadowsOf = (group) => {
    const torso = group.torsos.get(Math.min(...group.torsos.keys()));
    const robots = torso.positions.length / 3;
    const outline = outlineOf(group);
    const size = Math.max(LEAST_SIZE, (outline.halves[0] + outline.halves[1]) / 2 / USUAL_M);
    const feet = Array.from({ length: robots }, (_, lane) => feetOf(group, lane));
    const count = robots + feet.flat().length;
    const [positions, wxyzs, scales] = [3, 4, 3].map((width) => new Float32Array(count * width));
    let at = 0;
    const shadow = {
      place: (position, across, along) => {
        positions.set(position, 3 * at);
        scales.set([across, along, 1], 3 * at);
      },
      turn: (...wxyz) => wxyzs.set(wxyz, 4 * at),
    };
    for (let lane = 0; lane < robots; lane += 1) {
      shadow.turn(1, 0, 0, 0);
      if (isShown(torso, lane)) placeTorso(shadow, torso, lane, outline);
      at += 1;
      for (const foot of feet[lane]) {
        shadow.turn(1, 0, 0, 0);
        if (foot && isShown(torso, lane)) placeFoot(shadow, foot, size);
        at += 1;
      }
    }
    return { batched_positions: positions, batched_wxyzs: wxyzs, batched_scales: scales };
  };

  // Before labels.js, which draws them.
  addEventListener("hexapods:draw", ({ detail }) => {
    detail.messages.forEach(take);
    const moved = [];
    for (const group of groups.values()) {
      if (!group.isMoved || !group.shadows || !group.torsos.size) continue;
      group.isMoved = false;
      moved.push({ type: "SceneNodeUpdateMessage", name: group.shadows, updates: shadowsOf(group), owner: "" });
    }
    // A page may draw the same list again.
    if (moved.length) detail.messages = [...detail.messages, ...moved];
  });
})();
