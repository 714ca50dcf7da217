// Camera plans: from which side each shot shows the robots, and the nearest camera that has all of them in view. Pure
// functions, which other scripts have as `hexapodsViewer.shots`. Lengths are in metres in the frame of the run: x
// across the track, y along it, z up; angles in degrees: azimuth 0 is behind the robots, 90 on their right.
(() => {
  "use strict";

  const RAD = Math.PI / 180;
  /** By shot the angles that the viewer chooses from: azimuth, elevation, field of view from top to bottom. */
  const WIDE = {
    start: [[143, 13, 30], [32, 14, 30], [90, 12, 30], [0, 60, 30]],
    race: [[34, 18, 30], [145, 16, 30], [90, 16, 30], [0, 60, 30]],
    finish: [[30, 18, 22], [148, 16, 24], [90, 14, 26], [0, 60, 28]],
    // From the left: on the right of the learner is the lane of its tests.
    practice: [[-35, 22, 30], [-145, 16, 30], [-90, 10, 30], [0, 60, 30]],
    close: [[35, 22, 30], [145, 16, 30], [90, 10, 30], [0, 60, 30]],
  };
  /** In a picture that is higher than wide the track runs across. */
  const TALL = {
    start: [[108, 36, 32], [75, 36, 30], [20, 45, 34], [90, 72, 30]],
    race: [[77, 34, 30], [105, 34, 30], [20, 45, 34], [90, 72, 30]],
    finish: [[75, 34, 26], [105, 34, 26], [20, 45, 30], [90, 72, 28]],
    practice: [[-35, 30, 36], [-145, 26, 36], [-90, 14, 36], [-90, 70, 36]],
    close: [[35, 30, 36], [145, 26, 36], [90, 14, 36], [90, 70, 36]],
  };
  /** So many robots are seen more from the side, else they hide each other. */
  const MANY = 5;
  const FOR_MANY = [40, 22];
  /** Moments of inertia across the lanes from which on one side has the robots that lag [m²]. */
  const LEVEL = 0.01;
  const SMALL_PX = 500;
  /** Between these aspects a picture has its robots more from the side the narrower it is, by as much at most [°]. */
  const [NARROW, FULL, MOST_TURN] = [4 / 3, 16 / 9, 11];
  /** From above or right from the side it has them as they are. */
  const [STEEP, SIDEWAYS] = [40, 25];
  const LEAST_SHARE = 0.2;

  /** The number of angles of a shot. */
  const anglesOf = (shot) => WIDE[shot].length;

  /** On which side the robots are that lag: 1 right, −1 left. From there no robot hides another. */
  const sideOf = (places) => {
    const mean = (axis) => places.reduce((sum, place) => sum + place[axis], 0) / (places.length || 1);
    const [x, y] = [mean(0), mean(1)];
    return places.reduce((sum, place) => sum + (place[0] - x) * (y - place[1]), 0) < -LEVEL ? -1 : 1;
  };

  const turned = (azimuth, elevation, aspect) => {
    if (aspect < 1 || elevation > STEEP || Math.abs(Math.abs(azimuth) - 90) < SIDEWAYS) return azimuth;
    const share = Math.min(1, Math.max(0, (FULL - aspect) / (FULL - NARROW)));
    const towards = Math.abs(azimuth) < 90 ? 1 : -1;
    return Math.sign(azimuth) * (Math.abs(azimuth) + towards * share * MOST_TURN);
  };

  /**
   * From where a shot is taken, {azimuth, elevation, fov}: of an angle by its number, of a picture of a size [px], of
   * robots at places.
   */
  const directionOf = (shot, angle, { width, height }, places) => {
    const plans = (width < height ? TALL : WIDE)[shot];
    const plan = plans[angle % plans.length];
    const isOfMany = plan === WIDE.race[0] || plan === WIDE.finish[0];
    const [azimuth, elevation, fov] = isOfMany && places.length >= MANY ? [...FOR_MANY, plan[2]] : plan;
    // Seen from the front, those hide others that lead.
    const side = sideOf(Math.abs(azimuth) > 90 ? places.map(([x, y]) => [x, -y]) : places);
    return { azimuth: side * turned(azimuth, elevation, width / height), elevation, fov };
  };

  /** What stays free around the robots [px]; `label` is the height of the labels over them. */
  const marginsOf = ({ width, height }, label) => {
    if (Math.min(width, height) < SMALL_PX && width >= height) return { left: 8, top: 4 + label, right: 8, bottom: 8 };
    if (width < height) return { left: 10, top: 8 + label, right: 10, bottom: 40 };
    return { left: 36, top: 12 + label, right: 36, bottom: 36 };
  };

  /** Unit vectors of a camera: to its right, up, and back from what it looks at. */
  const axesOf = ({ azimuth, elevation }) => {
    const [a, e] = [azimuth * RAD, elevation * RAD];
    const back = [Math.sin(a) * Math.cos(e), -Math.cos(a) * Math.cos(e), Math.sin(e)];
    const right = [Math.cos(a), Math.sin(a), 0];
    const up = [
      back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
      back[0] * right[1] - back[1] * right[0],
    ];
    return { right, up, back };
  };

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const combined = ({ right, up, back }, x, y, z) =>
    [0, 1, 2].map((axis) => x * right[axis] + y * up[axis] + z * back[axis]);

  /** Tangents of the angles from the middle of the picture to where its margins begin. */
  const tangentsOf = (fov, { width, height }, { left, top, right, bottom }) => {
    const high = Math.tan((fov * RAD) / 2);
    const wide = (high * width) / height;
    // Where margins leave next to nothing, robots stand in them.
    const shrink = (first, second, size) => Math.min(1, ((1 - LEAST_SHARE) * size) / (first + second || 1));
    const [across, down] = [shrink(left, right, width), shrink(top, bottom, height)];
    const part = (margin, size) => 1 - (2 * margin) / size;
    return {
      left: wide * part(left * across, width), right: wide * part(right * across, width),
      top: high * part(top * down, height), bottom: high * part(bottom * down, height),
    };
  };

  /**
   * The nearest camera of a direction that has all points within the margins: what it looks at, in the middle of the
   * picture and as deep as the points are on the average, and its distance from there.
   */
  const solve = (points, direction, tangents) => {
    const axes = axesOf(direction);
    const { left, right, top, bottom } = tangents;
    let [a, b, c, d, depth] = [-Infinity, Infinity, -Infinity, Infinity, 0];
    for (const point of points) {
      const [x, y, z] = [dot(point, axes.right), dot(point, axes.up), dot(point, axes.back)];
      a = Math.max(a, x + right * z);
      b = Math.min(b, x - left * z);
      c = Math.max(c, y + top * z);
      d = Math.min(d, y - bottom * z);
      depth += z / points.length;
    }
    const z = Math.max((a - b) / (left + right), (c - d) / (top + bottom));
    const x = (a - right * z + b + left * z) / 2;
    const y = (c - top * z + d + bottom * z) / 2;
    return { target: combined(axes, x, y, depth), distance: z - depth };
  };

  /** From how far a camera that looks at a target has all points within the margins. */
  const distanceFor = (points, direction, tangents, target) => {
    const axes = axesOf(direction);
    const { left, right, top, bottom } = tangents;
    return Math.max(...points.map((point) => {
      const offset = point.map((coordinate, axis) => coordinate - target[axis]);
      const [x, y, z] = [dot(offset, axes.right), dot(offset, axes.up), dot(offset, axes.back)];
      return z + Math.max(x / right, -x / left, y / top, -y / bottom);
    }));
  };

  /** Tangents of the angles at which a camera sees points, to the right and up. */
  const seenFrom = (points, direction, target, distance) => {
    const axes = axesOf(direction);
    return points.map((point) => {
      const offset = point.map((coordinate, axis) => coordinate - target[axis]);
      const depth = distance - dot(offset, axes.back);
      return [dot(offset, axes.right) / depth, dot(offset, axes.up) / depth];
    });
  };

  /** Where the camera is that looks at a target from a distance. */
  const positionOf = (target, distance, direction) => {
    const { back } = axesOf(direction);
    return target.map((coordinate, axis) => coordinate + distance * back[axis]);
  };

  /** The azimuth and elevation of a camera at a position that looks at a target. */
  const directionFrom = (position, target) => {
    const [x, y, z] = position.map((coordinate, axis) => coordinate - target[axis]);
    return { azimuth: Math.atan2(x, -y) / RAD, elevation: Math.atan2(z, Math.hypot(x, y)) / RAD };
  };

  const shots = {
    anglesOf, sideOf, directionOf, marginsOf, tangentsOf, solve, distanceFor, seenFrom, positionOf,
    directionFrom,
  };
  globalThis.hexapodsViewer = { ...globalThis.hexapodsViewer, shots };
})();
