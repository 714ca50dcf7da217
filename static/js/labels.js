// Places the labels of a chart so that no two overlap: captions at their lines, labels at the ends of lines.

/** @typedef {{ left: number, top: number, width: number, height: number }} Box [px] */

/** @type {(a: Box, b: Box) => boolean} */
export const overlap = (a, b) =>
  a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;

/** @type {(value: number, low: number, high: number) => number} */
const within = (value, low, high) => Math.max(low, Math.min(value, high));

/** @type {(box: Box, bounds: Box) => Box} */
const shifted = (box, { left, width }) => ({ ...box, left: within(box.left, left, left + width - box.width) });

/**
 * Captions where they are wanted, within the bounds; null for one that would overlap another before it.
 * @param {Box[]} wanted the most important first
 * @param {Box} bounds
 */
export function placeCaptions(wanted, bounds) {
  /** @type {Box[]} */
  const placed = [];
  return wanted.map((one) => {
    const box = shifted(one, bounds);
    if (placed.some((other) => overlap(box, other))) return null;
    placed.push(box);
    return box;
  });
}

/**
 * Captions each at one of several places, which lie within the bounds; null for one that would overlap another before
 * it at all of them. Of the places that are free it is the first that covers least.
 * @param {Box[][]} places of each caption, the most important first; of each the best place first
 * @param {Box} bounds
 * @param {(box: Box) => number} covering how much a caption would cover
 */
export function chooseCaptions(places, bounds, covering) {
  /** @type {Box[]} */
  const placed = [];
  return places.map((own) => {
    const free = own.map((one) => shifted(one, bounds))
      .filter((box) => box.top >= bounds.top && box.top + box.height <= bounds.top + bounds.height)
      .filter((box) => !placed.some((other) => overlap(box, other)));
    const counts = free.map(covering);
    const box = free[counts.indexOf(Math.min(...counts))] ?? null;
    if (box) placed.push(box);
    return box;
  });
}

/**
 * Whether a line of points, ascending, passes through a box.
 * @param {[number, number][]} points [px]
 * @param {Box} box
 */
export function passes(points, { left, top, width, height }) {
  const right = left + width;
  return points.some(([x1, y1], n) => {
    const [x0, y0] = points[Math.max(0, n - 1)];
    if (x1 < left || x0 > right) return false;
    const slope = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0;
    const ends = [y0 + slope * Math.max(0, left - x0), y1 - slope * Math.max(0, x1 - right)];
    return Math.max(...ends) > top && Math.min(...ends) < top + height;
  });
}

/**
 * Labels as near as possible to where they are wanted, moved up or down from each other and from obstacles,
 * but never past each other; null for one that the bounds have no room for.
 * @param {Box[]} wanted
 * @param {Box[]} obstacles
 * @param {Box} bounds
 */
export function placeLabels(wanted, obstacles, bounds) {
  const inOrder = wanted.map((one, number) => ({ number, box: shifted(one, bounds) }));
  inOrder.sort((a, b) => a.box.top - b.box.top);
  const boxes = inOrder.map(({ box }) => box);
  const downwards = nearest(boxes, obstacles, bounds, false);
  const upwards = nearest([...boxes].reverse(), obstacles, bounds, true).reverse();
  const [near] = [downwards, upwards].filter((some) => !some.includes(null))
    .sort((a, b) => distance(a, boxes) - distance(b, boxes));
  const placed = near ?? stacked(boxes, obstacles, bounds);
  /** @type {(Box | null)[]} */
  const found = wanted.map(() => null);
  inOrder.forEach(({ number }, n) => (found[number] = placed[n]));
  return found;
}

/** @type {(placed: (Box | null)[], wanted: Box[]) => number} */
const distance = (placed, wanted) =>
  wanted.reduce((sum, { top }, n) => sum + Math.abs((placed[n]?.top ?? top) - top), 0);

/** @type {(a: Box, b: Box) => boolean} */
const inOneColumn = (a, b) => a.left < b.left + b.width && b.left < a.left + a.width;

/**
 * Each at the free place nearest to its own that is below those before it, or else above.
 * @param {Box[]} boxes
 * @param {Box[]} obstacles
 * @param {Box} bounds
 * @param {boolean} isAbove
 */
function nearest(boxes, obstacles, bounds, isAbove) {
  /** @type {Box[]} */
  const placed = [];
  return boxes.map((box) => {
    const before = placed.filter((one) => inOneColumn(one, box));
    const bottom = bounds.top + bounds.height - box.height;
    const low = isAbove ? bounds.top : Math.max(bounds.top, ...before.map((one) => one.top + one.height));
    const high = isAbove ? Math.min(bottom, ...before.map((one) => one.top - box.height)) : bottom;
    const taken = [...obstacles, ...placed];
    const top = [box.top, ...taken.flatMap((one) => [one.top - box.height, one.top + one.height])]
      .map((one) => within(one, low, high))
      .sort((a, b) => Math.abs(a - box.top) - Math.abs(b - box.top))
      .find((one) => !taken.some((other) => overlap({ ...box, top: one }, other)));
    if (top === undefined || low > high) return null;
    placed.push({ ...box, top });
    return { ...box, top };
  });
}

/**
 * All from the top down without gaps, which needs the least room.
 * @param {Box[]} boxes
 * @param {Box[]} obstacles
 * @param {Box} bounds
 */
function stacked(boxes, obstacles, bounds) {
  const taken = [...obstacles];
  return boxes.map((box) => {
    let { top } = bounds;
    for (;;) {
      const blocking = taken.filter((other) => overlap({ ...box, top }, other));
      if (!blocking.length) break;
      top = Math.max(...blocking.map((other) => other.top + other.height));
    }
    if (top + box.height > bounds.top + bounds.height) return null;
    taken.push({ ...box, top });
    return { ...box, top };
  });
}
