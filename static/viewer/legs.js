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

  const { links: allLinks, projected, root } = window.hexapodsViewer.robots;
  const TOLD_MS = 100;
  const CLICK_PX = 5;
  const LEG_PX = 26;
  const BODY_PX = 44;
  /** Clicks on the ground beyond are meant for nothing. */
  const FAR_M = 3;

  let wanted = null;

  // ---- projection

  /** The links of all legs on the screen: {lane, leg, from, to, low}. */
  const links = () => allLinks().filter(({ leg }) => leg !== null).map(({ lane, leg, origin, tip }) =>
    ({ lane, leg, from: projected(origin), to: projected(tip), low: tip[2] })).filter(({ from, to }) => from && to);

  const bodies = () => allLinks().filter(({ leg }) => leg === null)
    .map(({ lane, origin }) => ({ lane, at: projected(origin) })).filter(({ at }) => at);

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
    const node = nodeRefFromName?.[root()];
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
