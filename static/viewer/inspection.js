// A still scene that a feature of the page shows: the camera stands where it fills the picture, and goes round it until
// someone turns it; the page is told where points of it are in the picture, whenever that has changed.
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
//
//   from the parent   {type: "hexapods:inspect", inspection: null, or {world, centre_m, rims_m: [[radius, height]] of
//                     level circles that are to be in view, points: [[x, y, z]], of: their number in the page's
//                     lists, isTurning, turned_deg: by which the page wants it turned, margins_px: {side, top, bottom}
//                     that stay free around it}}
//   to the parent     {type: "hexapods:places", places: {of, points: [{x, y}, or null behind the camera], azimuth_deg}}
//                     {type: "hexapods:touched"}: someone turns it
(() => {
  "use strict";

  if (parent === window) return;

  const ELEVATION_RAD = 0.42;
  /** At first it is seen from its front and left. */
  const FIRST_AZIMUTH_RAD = -2.5;
  const TURN_RAD_PER_S = 0.3;
  /** How much of the picture within the margins is filled. */
  const FILLED = 0.96;
  const CORNERS = 24;
  /** Of a bisection. */
  const STEPS = 40;
  const SAME_PX = 0.25;
  const STEP_LIMIT_S = 0.1;

  let inspection = null;
  /** The camera as the stage had it. */
  let before = null;
  /** What is in view, as a text; another one is brought into view. */
  let framed = "";
  let turned_deg = 0;
  let told = null;
  let last = 0;

  const tell = (message) => parent.postMessage(message, location.origin);
  const viewer = () => window.__viserMutable ?? {};

  /** From the scene to three.js; null until the root of the scene is made. */
  const toThree = () => viewer().nodeRefFromName?.[inspection.world]?.matrixWorld ?? null;
  const vector = ([x, y, z]) => viewer().camera.position.clone().set(x, y, z);

  // ---- the camera

  /** Half the angles of the picture that may be filled, as tangents, and of by how much it is below the middle. */
  const tangents = () => {
    const { camera, canvas: { clientWidth: width, clientHeight: height } } = viewer();
    const { side, top, bottom } = inspection.margins_px;
    const perPixel = Math.tan((camera.fov * Math.PI) / 360) / (height / 2);
    const half = (size, margins) => perPixel * FILLED * Math.max((size - margins) / 2, size / 8);
    return { wide: half(width, 2 * side), high: half(height, top + bottom), lower: (perPixel * (top - bottom)) / 2 };
  };

  /** Points of the circles as a camera at a distance sees them: to the side, up, and how deep. */
  const seenFrom = (distance_m) => {
    const { rims_m, centre_m } = inspection;
    const [sine, cosine] = [Math.sin(ELEVATION_RAD), Math.cos(ELEVATION_RAD)];
    return Array.from({ length: CORNERS }, (_, n) => (2 * Math.PI * n) / CORNERS).flatMap((angle) =>
      rims_m.map(([radius_m, height_m]) => {
        const [side, near, up] = [radius_m * Math.sin(angle), radius_m * Math.cos(angle), height_m - centre_m[2]];
        return { side, up: up * cosine - near * sine, depth: distance_m - near * cosine - up * sine };
      }));
  };

  /** How far up the camera is to be moved at a distance, so that as much is free above the circles as below. */
  const shiftAt = (distance_m, { lower }) => {
    const points = seenFrom(distance_m);
    const height = (shift, most) => most(...points.map(({ up, depth }) => (up - shift) / depth));
    let [low, high] = [-distance_m, distance_m];
    for (let step = 0; step < STEPS; step += 1) {
      const middle = (low + high) / 2;
      if (height(middle, Math.max) + height(middle, Math.min) + 2 * lower > 0) low = middle;
      else high = middle;
    }
    return low;
  };

  /** Whether the circles are in view from a distance, with a camera that is moved up where that helps. */
  const fits = (distance_m, { wide, high, lower }) => {
    let [least, most] = [-Infinity, Infinity];
    for (const { side, up, depth } of seenFrom(distance_m)) {
      if (depth <= 0 || Math.abs(side) > depth * wide) return false;
      least = Math.max(least, up - depth * (high - lower));
      most = Math.min(most, up + depth * (high + lower));
    }
    return least <= most;
  };

  /** From how near the circles are in view. */
  const distanceToFit = (limits) => {
    let [near, far] = [0, 100 * Math.max(...inspection.rims_m.flat())];
    for (let step = 0; step < STEPS; step += 1) {
      const middle = (near + far) / 2;
      if (fits(middle, limits)) far = middle;
      else near = middle;
    }
    return far;
  };

  /** From where it is seen, anticlockwise from behind. */
  const azimuth = () => {
    const { cameraControl, camera } = viewer();
    const inverse = toThree().clone().invert();
    const at = cameraControl.getPosition(camera.position.clone()).applyMatrix4(inverse);
    const target = cameraControl.getTarget(camera.position.clone()).applyMatrix4(inverse);
    return Math.atan2(at.x - target.x, target.y - at.y);
  };

  /** Put the camera where what is shown fills the picture, from the side from which it is seen. */
  const frame = (azimuth_rad) => {
    const { cameraControl, camera, requestRender } = viewer();
    const matrix = toThree();
    const limits = tangents();
    const distance = distanceToFit(limits);
    const [x, y, z] = inspection.centre_m;
    const flat = distance * Math.cos(ELEVATION_RAD);
    const at = vector([
      x + flat * Math.sin(azimuth_rad), y - flat * Math.cos(azimuth_rad), z + distance * Math.sin(ELEVATION_RAD),
    ]).applyMatrix4(matrix);
    const target = vector([x, y, z]).applyMatrix4(matrix);
    Object.assign(camera, { near: distance / 100, far: distance * 100 });
    camera.updateProjectionMatrix();
    cameraControl.setLookAt(at.x, at.y, at.z, target.x, target.y, target.z, false);
    cameraControl.setFocalOffset(0, -shiftAt(distance, limits), 0, false);
    // At once: what is told next is of this place.
    cameraControl.update(0);
    camera.updateMatrixWorld();
    requestRender();
  };

  const keepCamera = () => {
    const { cameraControl, camera } = viewer();
    before = {
      at: cameraControl.getPosition(camera.position.clone()), target: cameraControl.getTarget(camera.position.clone()),
      near: camera.near, far: camera.far,
    };
  };

  const restoreCamera = () => {
    const { cameraControl, camera, requestRender } = viewer();
    if (!before) return;
    const { at, target, near, far } = before;
    Object.assign(camera, { near, far });
    camera.updateProjectionMatrix();
    cameraControl.setLookAt(at.x, at.y, at.z, target.x, target.y, target.z, false);
    cameraControl.setFocalOffset(0, 0, 0, false);
    before = null;
    requestRender();
  };

  // ---- places of points

  const placesNow = () => {
    const { camera, canvas } = viewer();
    const matrix = toThree();
    const points = inspection.points.map((point) => {
      const at = vector(point).applyMatrix4(matrix).project(camera);
      if (Math.abs(at.z) >= 1) return null;
      return { x: ((at.x + 1) / 2) * canvas.clientWidth, y: ((1 - at.y) / 2) * canvas.clientHeight };
    });
    return { of: inspection.of, points, azimuth_deg: (azimuth() * 180) / Math.PI };
  };

  const isSame = (earlier, now) => earlier?.of === now.of && earlier.points.length === now.points.length
    && earlier.points.every((point, n) => {
      const next = now.points[n];
      return point && next ? Math.abs(point.x - next.x) + Math.abs(point.y - next.y) < SAME_PX : point === next;
    });

  const tellPlaces = () => {
    const places = placesNow();
    if (isSame(told, places)) return;
    told = places;
    tell({ type: "hexapods:places", places });
  };

  // ---- while it is shown

  const isReady = () => {
    const { camera, cameraControl, canvas } = viewer();
    return Boolean(camera && cameraControl && canvas?.clientHeight && toThree());
  };

  const turn = (now) => {
    const { cameraControl, requestRender } = viewer();
    const elapsed_s = Math.min((now - last) / 1000, STEP_LIMIT_S);
    const wanted = ((inspection.turned_deg - turned_deg) * Math.PI) / 180;
    turned_deg = inspection.turned_deg;
    const angle = wanted + (inspection.isTurning ? TURN_RAD_PER_S * elapsed_s : 0);
    if (angle === 0) return;
    cameraControl.rotate(angle, 0, false);
    requestRender();
  };

  const keyOf = ({ centre_m, rims_m, margins_px }) => {
    const { clientWidth, clientHeight } = viewer().canvas;
    // The scene is turned upright a little after it is drawn.
    const upright = toThree().elements;
    return JSON.stringify([upright, centre_m, rims_m, margins_px, clientWidth, clientHeight, viewer().camera.fov]);
  };

  const step = (now) => {
    if (!inspection) return;
    requestAnimationFrame(step);
    if (!isReady()) return;
    if (!before) keepCamera();
    const key = keyOf(inspection);
    if (key !== framed) {
      frame(framed ? azimuth() : FIRST_AZIMUTH_RAD);
      framed = key;
    }
    turn(now);
    last = now;
    tellPlaces();
  };

  addEventListener("hexapods:inspect", ({ detail }) => {
    const wasShown = inspection !== null;
    inspection = detail.inspection;
    if (inspection && !wasShown) {
      [framed, told, turned_deg] = ["", null, inspection.turned_deg];
      requestAnimationFrame(step);
    } else if (!inspection && wasShown) restoreCamera();
  });

  for (const type of ["pointerdown", "wheel"]) {
    addEventListener(type, ({ target }) => {
      if (inspection && target instanceof HTMLCanvasElement) tell({ type: "hexapods:touched" });
    }, { capture: true, passive: true });
  }
})();
