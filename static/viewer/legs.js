// The legs of the robots in the picture: projects the poses that are drawn, and tells the page around this one which
// leg or body was clicked, or the ground. viser's own click bindings would light bodies up under the pointer.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   from the parent   {type: "hexapods:show", legsOf?: a lane from 0, or null}: whose legs it wants to be told of
//   to the parent     {type: "hexapods:pick", pick: {lane, what: "leg" | "body" | "ground", leg, x, y}}
//                     {type: "hexapods:legs", legs: [{leg, x, y}]}, several times a second; places in pixels
(() => {
  "use strict";

  if (parent === window) return;

  /** Batches of links of legs are named by the legs of their instances: ".../legs-1-2-3-4-5-6". */
  const LEGS = /\/legs((?:-\d+)+)(?:\/|$)/;
  const TORSO = /\/torso(?:\/|$)/;
  const TOLD_MS = 100;
  const CLICK_PX = 5;
  const LEG_PX = 26;
  const BODY_PX = 44;
  /** Clicks on the ground beyond are meant for nothing. */
  const FAR_M = 3;

  /** Name of a batch → {kind, legs, tip, positions, wxyzs}. */
  const batches = new Map();
  let wanted = null;

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

  const take = (message) => {
    const { type, name } = message;
    if (type === "BatchedMeshesMessage") {
      const legs = LEGS.exec(name)?.[1].split("-").filter(Boolean).map(Number) ?? null;
      if (!legs && !TORSO.test(name)) return;
      const { vertices, batched_positions, batched_wxyzs } = message.props;
      batches.set(name, {
        legs, tip: tipOf(floats(vertices)), positions: floats(batched_positions), wxyzs: floats(batched_wxyzs),
      });
    } else if (type === "SceneNodeUpdateMessage" && batches.has(name)) {
      const { batched_positions, batched_wxyzs } = message.updates;
      if (batched_positions) batches.get(name).positions = floats(batched_positions);
      if (batched_wxyzs) batches.get(name).wxyzs = floats(batched_wxyzs);
    } else if (type === "RemoveSceneNodeMessage") {
      for (const batch of batches.keys()) if (batch === name || batch.startsWith(`${name}/`)) batches.delete(batch);
    }
  };

  addEventListener("hexapods:draw", ({ detail }) => detail.messages.forEach(take));

  // ---- projection

  const rotated = ([w, x, y, z], [a, b, c]) => {
    const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
  };

  /** A point of the world in pixels of the picture; null behind the camera. */
  const projected = (name, point) => {
    const { camera, canvas, nodeRefFromName } = window.__viserMutable ?? {};
    const node = nodeRefFromName?.[name.slice(0, name.lastIndexOf("/"))];
    if (!camera || !node) return null;
    const at = camera.position.clone().set(...point).applyMatrix4(node.matrixWorld).project(camera);
    if (Math.abs(at.z) >= 1) return null;
    return { x: ((at.x + 1) / 2) * canvas.clientWidth, y: ((1 - at.y) / 2) * canvas.clientHeight };
  };

  const parts = (batch, index) => ({
    origin: [...batch.positions.slice(3 * index, 3 * index + 3)],
    wxyz: [...batch.wxyzs.slice(4 * index, 4 * index + 4)],
  });

  /** The links of all legs on the screen: {lane, leg, from, to}. */
  const links = () => [...batches].flatMap(([name, batch]) => {
    if (!batch.legs) return [];
    return Array.from({ length: batch.positions.length / 3 }, (_, index) => {
      const { origin, wxyz } = parts(batch, index);
      const tip = rotated(wxyz, batch.tip).map((coordinate, axis) => coordinate + origin[axis]);
      const [from, to] = [projected(name, origin), projected(name, tip)];
      return {
        lane: Math.floor(index / batch.legs.length), leg: batch.legs[index % batch.legs.length], from, to, low: tip[2],
      };
    }).filter(({ from, to }) => from && to);
  });

  const bodies = () => [...batches].flatMap(([name, batch]) => (batch.legs ? []
    : Array.from({ length: batch.positions.length / 3 }, (_, lane) =>
      ({ lane, at: projected(name, parts(batch, lane).origin) })).filter(({ at }) => at)));

  const distanceTo = ({ from, to }, { x, y }) => {
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    const share = Math.min(1, Math.max(0, ((x - from.x) * dx + (y - from.y) * dy) / (dx * dx + dy * dy || 1)));
    return Math.hypot(x - from.x - share * dx, y - from.y - share * dy);
  };

  const nearest = (list, far_px) =>
    list.reduce((best, candidate) => (candidate.distance < (best?.distance ?? far_px) ? candidate : best), null);

  const pickAt = (point) => {
    const toBody = ({ at }) => Math.hypot(point.x - at.x, point.y - at.y);
    const body = nearest(bodies().map((candidate) => ({ ...candidate, distance: toBody(candidate) })), BODY_PX);
    const leg = nearest(links().map((link) => ({ ...link, distance: distanceTo(link, point) })), LEG_PX);
    if (body && (!leg || body.distance < BODY_PX / 2)) return { ...point, lane: body.lane, what: "body", leg: null };
    if (leg) return { ...point, lane: leg.lane, what: "leg", leg: leg.leg };
    return isGround(point) ? { ...point, lane: 0, what: "ground", leg: null } : null;
  };

  /** Whether the ray through a point of the picture meets the ground of the track. */
  const isGround = ({ x, y }) => {
    const { camera, canvas, nodeRefFromName } = window.__viserMutable ?? {};
    const [name] = batches.keys();
    const node = name && nodeRefFromName?.[name.slice(0, name.lastIndexOf("/"))];
    if (!camera || !node) return false;
    const toTrack = node.matrixWorld.clone().invert();
    const from = camera.position.clone().setFromMatrixPosition(camera.matrixWorld).applyMatrix4(toTrack);
    const [u, v] = [(2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight];
    const through = camera.position.clone().set(u, v, 0.5).unproject(camera).applyMatrix4(toTrack);
    const share = from.z / (from.z - through.z || 1e-9);
    const [east, north] = ["x", "y"].map((axis) => from[axis] + share * (through[axis] - from[axis]));
    return share > 0 && Math.hypot(east, north) < FAR_M;
  };

  // ---- what the page is told

  const tell = (message) => parent.postMessage(message, location.origin);

  let down = null;
  addEventListener("pointerdown", ({ clientX, clientY, button, target }) => {
    down = button === 0 && target instanceof HTMLCanvasElement ? { x: clientX, y: clientY } : null;
  }, true);
  addEventListener("pointerup", ({ clientX, clientY }) => {
    const isClick = down && Math.hypot(clientX - down.x, clientY - down.y) < CLICK_PX;
    const pick = isClick ? pickAt({ x: clientX, y: clientY }) : null;
    down = null;
    if (pick) tell({ type: "hexapods:pick", pick });
  }, true);

  /** Of each leg the lowest end of its links, where its number stands. */
  const feetOf = (lane) => {
    const lowest = new Map();
    for (const link of links()) {
      if (link.lane === lane && link.low < (lowest.get(link.leg)?.low ?? Infinity)) lowest.set(link.leg, link);
    }
    const places = [...lowest].map(([leg, { to }]) => ({ leg, x: Math.round(to.x), y: Math.round(to.y) }));
    return places.sort((a, b) => a.leg - b.leg);
  };

  let timer = null;
  addEventListener("hexapods:show", ({ detail: { legsOf = null } }) => {
    if (legsOf === wanted) return;
    wanted = legsOf;
    clearInterval(timer);
    timer = wanted === null ? null : setInterval(() => tell({ type: "hexapods:legs", legs: feetOf(wanted) }), TOLD_MS);
  });
})();
