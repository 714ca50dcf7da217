// A plan of the track from above, where a browser cannot draw in 3D: what of the robots' poses is drawn, and where.
// Lengths are in metres in the frame of the run (x across the track, y along it), and in pixels in the picture.

/** @typedef {number[]} Point [x, y, z] in metres */
/** A link of a robot, as viewer/robots.js tells it; the leg of a torso is null. */
/** @typedef {{ lane: number, leg: number | null, origin: Point, tip: Point }} Link */
/** A robot seen from above; legs from hip to foot. @typedef {{ lane: number, at: Point, legs: Point[][] }} Body */
/**
 * What of the track is in the picture. `isUpright`: the run goes up in it, and the lanes are beside each other; else it
 * goes to the right, and they are below each other. `along` and `across` are where the picture begins, and how long it
 * is [m]; `scale` is pixels in a metre.
 * @typedef {{ isUpright: boolean, along: [number, number], across: [number, number], scale: number }} View
 */

export const FINISH_M = 0.45;
/** Around the robots; the reach and the width of a lane where none is there; how much of a practice is seen [m]. */
const [ROOM_M, REACH_M, LANE_M, PRACTICE_M] = [0.06, 0.25, 0.6, 0.9];
/** What is marked [m], the finest that has room for its numbers [px]; a number keeps clear of the lines [m]. */
const [TICKS_M, TICK_PX, FREE_M] = [[0.1, 0.2, 0.5, 1], 40, 0.06];

const flatDistance = (/** @type {Point} */ a, /** @type {Point} */ b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** The robots of links, by lane. @param {Link[]} links @returns {Body[]} */
export function bodiesOf(links) {
  const torsos = new Map(links.filter(({ leg }) => leg === null).map(({ lane, origin }) => [lane, origin]));
  return [...torsos].sort(([a], [b]) => a - b).map(([lane, at]) => {
    const limbs = links.filter((link) => link.lane === lane && link.leg !== null);
    const legs = [...new Set(limbs.map(({ leg }) => leg))].map((leg) => {
      // Joints from the hip outwards, and the foot: the tip of the last link.
      const chain = limbs.filter((link) => link.leg === leg)
        .sort((a, b) => flatDistance(a.origin, at) - flatDistance(b.origin, at));
      return [...chain.map(({ origin }) => origin), chain[chain.length - 1].tip];
    });
    const angle = (/** @type {Point[]} */ [[x, y]]) => Math.atan2(y - at[1], x - at[0]);
    return { lane, at, legs: legs.sort((a, b) => angle(a) - angle(b)) };
  });
}

/** Distance between lanes [m]. @param {Body[]} bodies */
export function laneWidth(bodies) {
  const xs = bodies.map(({ at }) => at[0]).sort((a, b) => a - b);
  const gaps = xs.slice(1).map((x, n) => x - xs[n]).filter((gap) => gap > ROOM_M);
  return gaps.length ? Math.min(...gaps) : Math.max(LANE_M, 2 * (reachOf(bodies) + ROOM_M));
}

/** How far the feet are from the torso at most [m]. @param {Body[]} bodies */
const reachOf = (bodies) => Math.max(REACH_M,
  ...bodies.flatMap(({ at, legs }) => legs.map((leg) => flatDistance(leg[leg.length - 1], at))));

/**
 * What of the track is shown so that all robots are in the picture, as large as they can be: of a race from its start
 * to its finish line at least; of a practice what is around the robot.
 * @param {Body[]} bodies
 * @param {{ width: number, height: number }} picture [px]
 * @param {boolean} isPractice
 * @returns {View}
 */
export function viewOf(bodies, { width, height }, isPractice) {
  const [xs, ys] = [0, 1].map((axis) => bodies.map(({ at }) => at[axis]));
  const [half, room] = [laneWidth(bodies) / 2, reachOf(bodies) + ROOM_M];
  const [left, right] = xs.length ? [Math.min(...xs) - half, Math.max(...xs) + half] : [-half, half];
  const [low, high] = isPractice ? [ys[0] - PRACTICE_M / 2, ys[0] + PRACTICE_M / 2]
    : [Math.min(0, ...ys) - room, Math.max(FINISH_M, ...ys) + room];
  const [long, wide] = [high - low, right - left];
  const [upright, level] = [Math.min(width / wide, height / long), Math.min(width / long, height / wide)];
  const isUpright = upright > level;
  const scale = Math.max(upright, level);
  // What is free beside it is shown, too.
  const [along, across] = (isUpright ? [height, width] : [width, height]).map((px) => px / scale);
  return {
    isUpright, scale, along: [(low + high - along) / 2, along], across: [(left + right - across) / 2, across],
  };
}

/** Where a point is in the picture [px]. @type {(view: View, point: Point) => [number, number]} */
export function placeOf({ isUpright, along: [from, length], across: [left], scale }, [x, y]) {
  const [run, side] = [(y - from) * scale, (x - left) * scale];
  return isUpright ? [side, length * scale - run] : [run, side];
}

/** Places to the tenth of a pixel, as a path has them. @type {(view: View, points: Point[]) => string} */
export const pathOf = (view, points) =>
  points.map((point) => placeOf(view, point).map((px) => px.toFixed(1)).join(" ")).join("L");

/** The distances that are marked [m]; the start and the finish line have lines of their own. @param {View} view */
export function ticksOf({ along: [from, length], scale }) {
  const tick = TICKS_M.find((size) => size * scale >= TICK_PX) ?? TICKS_M[TICKS_M.length - 1];
  const [first, last] = [Math.ceil(from / tick), Math.floor((from + length) / tick)];
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, n) => Number(((first + n) * tick).toFixed(1)))
    .filter((y) => y !== 0).map((y) => ({ y, hasNumber: Math.abs(y - FINISH_M) > FREE_M }));
}

/**
 * Where names stand so that none is over another: one that would be goes up to a line above that.
 * @template {{ left: number, right: number, y: number }} Name `y`: of its base line [px, down]
 * @param {Name[]} names
 * @param {number} line height of a line [px]
 * @returns {Name[]}
 */
export function apart(names, line) {
  /** @type {Name[]} */
  const placed = [];
  for (const name of names) {
    let { y } = name;
    const over = () => placed.find((other) =>
      other.left < name.right && name.left < other.right && Math.abs(other.y - y) < line);
    for (let other = over(); other; other = over()) y = other.y - line;
    placed.push({ ...name, y });
  }
  return placed;
}

/** The text of the label of each robot, by lane, as the messages have it that are drawn. */
export class LabelTexts {
  constructor() {
    /** Scene node → text. @type {Map<string, string>} */
    this.texts = new Map();
  }

  /** @param {{ type: string, name?: string } & Record<string, any>} message */
  take({ type, name = "", props, updates }) {
    if (type === "LabelMessage") this.texts.set(name, props.text);
    else if (type === "SceneNodeUpdateMessage" && this.texts.has(name)) {
      if ("text" in updates) this.texts.set(name, updates.text);
    } else if (type === "RemoveSceneNodeMessage") {
      for (const label of this.texts.keys()) {
        if (label === name || label.startsWith(`${name}/`)) this.texts.delete(label);
      }
    }
  }

  /** The lines of the label of a lane. @param {number} lane */
  of(lane) {
    const [, text = ""] = [...this.texts].find(([name]) => name.endsWith(`/lane${lane}/label`)) ?? [];
    return text.split("\n");
  }
}
