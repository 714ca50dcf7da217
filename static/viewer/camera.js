// The directed camera: shows the robots in the shot that the page names, follows them as they walk, and flies or cuts
// to the next shot. A viewer who turns the picture, by hand or by keys, has the camera from then on.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   events   hexapods:show {shot?: a shot of shots.js, or null where the viewer has the camera; angle?: the number of
//            one of its angles; lane?: that of the robot of a close shot, from 0; covered?: as labels.js has it}
//            hexapods:taken: the viewer has taken the camera
(() => {
  "use strict";

  const { robots, shots } = window.hexapodsViewer;
  const FLIGHT_S = 1.6;
  /** Time constant with which the camera follows [s]. */
  const FOLLOW_S = 0.5;
  const LONGEST_STEP_S = 0.5;
  /** Robots are never nearer to the edge than this part of the margins. */
  const HARD = 0.4;
  const GAP_PX = 8;
  /** Without motion the picture is cut when robots leave it or fill less of it than this; then it has room ahead. */
  const [LEAST_FILLED, AHEAD] = [0.7, 1.15];
  const [MOVED_M, MOVED_DEG] = [2e-4, 0.01];
  const DRAG_PX = 5;

  const stillness = matchMedia("(prefers-reduced-motion: reduce)");

  let wanted = { shot: null, angle: 0, lane: null };
  let covered = [];
  /** What the shot is of, as a text; another one begins another shot. */
  let key = "";
  /** Names the robots: others are cut to, and so are the first. */
  let cast = "";
  /** Whether the camera is the page's to move. */
  let isDirected = false;
  /** {from, to, elapsed_s}: directions of a flight, and how long it has lasted. */
  let flight = null;
  /** {direction, target, distance, speeds of target and distance}. */
  let view = null;
  /** Margins of the shot only grow: the picture does not jump to and fro. */
  let margins = null;
  let last = 0;

  const viewer = () => window.__viserMutable ?? {};
  const rootNode = () => viewer().nodeRefFromName?.[robots.root()] ?? null;
  const vector = ([x, y, z]) => viewer().camera.position.clone().set(x, y, z);
  const pictureSize = () => {
    const { clientWidth: width, clientHeight: height } = viewer().canvas;
    return { width, height };
  };

  // ---- what is in the picture

  /** Height that labels over the robots take [px]. */
  const labelHeight = () => window.hexapodsViewer.labels.height() + GAP_PX;

  /** The robots of a shot: of a close one that of a lane, or else all. */
  const castOf = (all) => (wanted.lane === null ? all : all.filter(({ lane }) => lane === wanted.lane));

  const pointsOf = (list) => [
    ...list.flatMap(robots.pointsOf), ...(wanted.lane === null ? robots.ghostPoints() : []),
  ];

  /** The boxes of robots in the picture of a view, with their labels over them [px]. */
  const boxesOf = (list, { target, distance }, direction, picture) => {
    const free = { left: 0, top: 0, right: 0, bottom: 0 };
    const { left: wide, top: high } = shots.tangentsOf(direction.fov, picture, free);
    return list.map((robot) => {
      const places = shots.seenFrom(robots.pointsOf(robot), direction, target, distance);
      const xs = places.map(([x]) => (1 + x / wide) * 0.5 * picture.width);
      const ys = places.map(([, y]) => (1 - y / high) * 0.5 * picture.height);
      const [left, right, bottom] = [Math.min(...xs), Math.max(...xs), Math.max(...ys)];
      return { left, right, top: Math.min(...ys) - labelHeight(), bottom };
    });
  };

  /** Grow margins by what lies over the picture, where robots or their labels would be below it. */
  const grownMargins = (before, boxes, { height }) => {
    const after = { ...before };
    for (const cover of covered) {
      const isMet = boxes.some((box) => cover.left < box.right + GAP_PX && box.left < cover.right + GAP_PX
        && cover.top < box.bottom + GAP_PX && box.top < cover.bottom + GAP_PX);
      if (!isMet) continue;
      if (cover.top + cover.bottom < height) after.top = Math.max(after.top, cover.bottom + labelHeight() + GAP_PX);
      else after.bottom = Math.max(after.bottom, height - cover.top + GAP_PX);
    }
    return after;
  };

  // ---- from where it is seen

  /** The view that the camera has, in the frame of the run. */
  const viewOfCamera = () => {
    const { camera, cameraControl } = viewer();
    const toRun = rootNode().matrixWorld.clone().invert();
    const at = camera.position.clone().applyMatrix4(toRun).toArray();
    const target = cameraControl.getTarget(camera.position.clone()).applyMatrix4(toRun).toArray();
    const distance = Math.hypot(...at.map((coordinate, axis) => coordinate - target[axis]));
    return { direction: { ...shots.directionFrom(at, target), fov: camera.fov }, target, distance };
  };

  const eased = (share) => share * share * (3 - 2 * share);

  /** The direction of a moment of the flight: by the shorter way round. */
  const directionNow = () => {
    const { from, to, elapsed_s } = flight;
    const share = eased(Math.min(1, elapsed_s / FLIGHT_S));
    const turn = ((to.azimuth - from.azimuth + 540) % 360) - 180;
    return {
      azimuth: from.azimuth + share * turn,
      elevation: from.elevation + share * (to.elevation - from.elevation),
      fov: from.fov + share * (to.fov - from.fov),
    };
  };

  /** A critically damped spring: the next value and speed, exact for any length of a step. */
  const sprung = (value, speed, goal, elapsed_s) => {
    const rate = 2 / FOLLOW_S;
    const decay = Math.exp(-rate * elapsed_s);
    const offset = value - goal;
    const push = (speed + rate * offset) * elapsed_s;
    return [goal + (offset + push) * decay, (speed - rate * push) * decay];
  };

  /** Begin a shot: by a flight from where the camera is, or by a cut. */
  const begin = (list, isCut) => {
    const to = shots.directionOf(wanted.shot, wanted.angle, pictureSize(), list.map(({ at }) => at));
    margins = null;
    if (isCut || stillness.matches) {
      flight = { from: to, to, elapsed_s: FLIGHT_S };
      view = null;
    } else {
      const from = view ? { ...view.direction } : viewOfCamera().direction;
      view ??= { ...viewOfCamera(), speeds: [0, 0, 0, 0] };
      flight = { from, to, elapsed_s: 0 };
    }
  };

  /** Whether a shot is cut to, where others are flown to. */
  const isCutTo = (before, after) => after === "finish" && before === "race";

  const direct = (list, picture, elapsed_s) => {
    flight.elapsed_s += elapsed_s;
    const direction = directionNow();
    const points = pointsOf(list);
    const goal = solved(points, list, direction, picture);
    const isAt = view === null;
    const isFlying = flight.elapsed_s < FLIGHT_S;
    if (isAt) view = { ...goal, direction, speeds: [0, 0, 0, 0] };
    else if (stillness.matches) cutWhereNeeded(points, goal, direction, picture);
    else follow(goal, elapsed_s);
    view.direction = direction;
    // No robot is cut, however fast it walks; a flight comes to that by and by.
    const least = shots.distanceFor(points, direction, hardTangents(direction, picture), view.target);
    const share = isFlying ? eased(flight.elapsed_s / FLIGHT_S) : 1;
    view.distance += share * Math.max(0, least - view.distance);
  };

  const hardTangents = ({ fov }, picture) =>
    shots.tangentsOf(fov, picture, Object.fromEntries(Object.entries(margins).map(([side, px]) => [side, HARD * px])));

  const solved = (points, list, direction, picture) => {
    const least = shots.marginsOf(picture, labelHeight());
    margins = margins === null ? least : { ...margins, top: Math.max(margins.top, least.top) };
    const solve = () => shots.solve(points, direction, shots.tangentsOf(direction.fov, picture, margins));
    const first = solve();
    margins = grownMargins(margins, boxesOf(list, first, direction, picture), picture);
    return solve();
  };

  const follow = (goal, elapsed_s) => {
    const [values, goals] = [view, goal].map(({ target, distance }) => [...target, distance]);
    const next = values.map((value, n) => sprung(value, view.speeds[n], goals[n], elapsed_s));
    const [x, y, z, distance] = next.map(([value]) => value);
    view = { ...view, target: [x, y, z], distance, speeds: next.map(([, speed]) => speed) };
  };

  const cutWhereNeeded = (points, goal, direction, picture) => {
    const least = shots.distanceFor(points, direction, hardTangents(direction, picture), view.target);
    if (least <= view.distance && goal.distance >= LEAST_FILLED * view.distance) return;
    Object.assign(view, { target: goal.target, distance: AHEAD * goal.distance });
  };

  // ---- the camera

  const isReady = () => {
    const { camera, cameraControl, canvas } = viewer();
    return Boolean(camera?.isPerspectiveCamera && cameraControl && canvas?.clientHeight && rootNode());
  };

  /** Put the camera where it is to be in the picture that is drawn next, as the scene is now. */
  const place = () => {
    if (!isDirected || view === null || !isReady()) return;
    const { camera, cameraControl } = viewer();
    const { matrixWorld } = rootNode();
    const { direction, target, distance } = view;
    const at = vector(shots.positionOf(target, distance, direction)).applyMatrix4(matrixWorld);
    const to = vector(target).applyMatrix4(matrixWorld);
    const isMoved = camera.position.distanceTo(at) > MOVED_M || Math.abs(camera.fov - direction.fov) > MOVED_DEG;
    camera.position.copy(at);
    camera.lookAt(to);
    if (camera.fov !== direction.fov) {
      camera.fov = direction.fov;
      camera.updateProjectionMatrix();
    }
    camera.updateMatrixWorld();
    // For who takes it by hand.
    if (isMoved) cameraControl.setLookAt(at.x, at.y, at.z, to.x, to.y, to.z, false);
  };

  const attach = () => {
    const { scene } = viewer();
    const before = scene.onBeforeRender;
    scene.onBeforeRender = (...parts) => {
      place();
      before.apply(scene, parts);
    };
  };

  let isAttached = false;
  let placed = "";
  const step = (now) => {
    requestAnimationFrame(step);
    const elapsed_s = Math.min((now - last) / 1000, LONGEST_STEP_S);
    last = now;
    if (wanted.shot === null || !isReady()) return;
    if (!isAttached) {
      attach();
      isAttached = true;
    }
    const all = robots.robots();
    const list = castOf(all);
    if (list.length === 0) return;
    const picture = pictureSize();
    const nextCast = `${all.length} ${robots.root()}`;
    const isTall = picture.width < picture.height;
    const nextKey = JSON.stringify([wanted, nextCast, isTall]);
    if (nextKey !== key || !isDirected) {
      const [before, after] = [JSON.parse(key || "[{}]")[0].shot, wanted.shot];
      const isCut = nextCast !== cast || (isDirected && isCutTo(before, after));
      begin(list, isCut);
      [key, cast, isDirected] = [nextKey, nextCast, true];
    }
    direct(list, picture, elapsed_s);
    const text = JSON.stringify([view.direction, view.target, view.distance].flat().map((part) => rounded(part)));
    if (text === placed) return;
    placed = text;
    viewer().requestRender?.();
  };

  const rounded = (part) => (typeof part === "number" ? Math.round(part / MOVED_M)
    : Object.values(part).map((number) => Math.round(number / MOVED_DEG)));

  requestAnimationFrame(step);

  // ---- who has it

  const release = () => {
    isDirected = false;
    view = null;
  };

  addEventListener("hexapods:show", ({ detail }) => {
    if (detail.covered) {
      ({ covered } = detail);
      margins = null;
    }
    if (detail.shot === undefined) return;
    const { shot = null, angle = 0, lane = null } = detail;
    wanted = { shot, angle, lane };
    if (shot === null) release();
  });
  addEventListener("resize", () => (margins = null));

  const takeOver = () => {
    if (!isDirected) return;
    wanted = { ...wanted, shot: null };
    release();
    dispatchEvent(new Event("hexapods:taken"));
  };

  let down = null;
  const isPicture = ({ target }) => target instanceof HTMLCanvasElement;
  const listen = (type, take) => addEventListener(type, take, { capture: true, passive: true });
  listen("pointerdown", (event) => (down = isPicture(event) ? event : null));
  listen("pointerup", () => (down = null));
  listen("pointermove", ({ clientX, clientY, buttons }) => {
    // A click is for what is clicked.
    if (down && buttons && Math.hypot(clientX - down.clientX, clientY - down.clientY) > DRAG_PX) takeOver();
  });
  listen("wheel", (event) => isPicture(event) && takeOver());

  // ---- keys: the client turns the picture by arrows, and is brought nearer and away by plus and minus

  /** Keys by which the client moves its camera; the page has letters for what it does itself. */
  const MOVES = new Set(["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE"]);
  const NEARER = 0.8;
  const DOLLIES = { "+": NEARER, "=": NEARER, "-": 1 / NEARER, "−": 1 / NEARER };

  const dolly = (factor) => {
    const { cameraControl } = viewer();
    cameraControl.dollyTo(factor * cameraControl.distance, false);
  };
  // Before the client, which listens on the document.
  listen("keydown", (event) => {
    const { key: pressed, code, target } = event;
    if (target.closest?.("input, textarea, select, [contenteditable]")) return;
    if (MOVES.has(code)) event.stopPropagation();
    if (event.ctrlKey || event.altKey || event.metaKey || !isReady()) return;
    if (pressed.startsWith("Arrow")) takeOver();
    if (pressed in DOLLIES) {
      takeOver();
      dolly(DOLLIES[pressed]);
    }
  });
})();
