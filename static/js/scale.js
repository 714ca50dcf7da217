// Maps numbers to positions on an axis and to colours, picks round ticks, thins points and lays them and labels apart.

/**
 * The position of a value between `low` and `high`, from 0 to 1.
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
export const shareOf = (value, low, high) =>
  high > low ? Math.min(Math.max((value - low) / (high - low), 0), 1) : 0;

/**
 * A share as a CSS length.
 * @param {number} share
 */
export const percent = (share) => `${(100 * share).toFixed(2)}%`;

/**
 * Round numbers from `low` up to `high`, about `count` of them.
 * @param {number} high
 */
export function ticks(high, count = 5, low = 0) {
  if (!(high > low)) return [low];
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5].map((n) => n * power).find((candidate) => candidate >= rough) ?? 10 * power;
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, n) => (first + n) * step);
}

/**
 * The largest value, at least `least`. Lists may be longer than a call may have arguments.
 * @param {number[]} values
 */
export const largest = (values, least = 0) =>
  values.reduce((top, value) => (value > top ? value : top), least);

/**
 * At most `most` items, evenly spaced in their order, with the first and the last.
 * @template Item
 * @param {Item[]} list
 * @param {number} most
 */
export function thinned(list, most) {
  if (list.length <= most) return list;
  return Array.from({ length: most }, (_, n) => list[Math.round((n * (list.length - 1)) / (most - 1))]);
}

/**
 * The labels of an axis that fit beside those before them in the list, each centred on its value as far as both ends of
 * the axis let it.
 * @template {{ at: number, size: number }} Label `at`: its value; `size`: its width [px]
 * @param {Label[]} labels the most important first
 * @param {number} high value at the end of the axis, which begins at 0
 * @param {number} width of the axis [px]
 * @param {number} gap between two labels [px]
 * @returns {(Label & { left: number })[]} with the left edge of each [px]
 */
export function fittingLabels(labels, high, width, gap) {
  /** @type {(Label & { left: number })[]} */
  const placed = [];
  for (const label of labels) {
    const left = Math.min(Math.max(0, shareOf(label.at, 0, high) * width - label.size / 2), width - label.size);
    const isBeside = (/** @type {Label & { left: number }} */ other) =>
      left + label.size + gap <= other.left || other.left + other.size + gap <= left;
    if (left >= 0 && placed.every(isBeside)) placed.push({ ...label, left });
  }
  return placed;
}

const BINS = 64;

/**
 * Offsets at which dots lie beside each other instead of on each other.
 * @param {number[]} shares positions from 0 to 1
 * @returns for each dot its distance from the middle in dots: 0, 1, −1, 2, −2…
 */
export function swarm(shares) {
  /** @type {Map<number, number>} */
  const taken = new Map();
  return shares.map((share) => {
    const bin = Math.round(share * BINS);
    const before = taken.get(bin) ?? 0;
    taken.set(bin, before + 1);
    return before % 2 ? (before + 1) / 2 : -before / 2;
  });
}

// ---- the viridis colour map, which the 3D stage uses too: equal steps of value look equal

const STOPS = [
  [68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140],
  [34, 168, 132], [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37],
];

/**
 * The colour of a share from 0 to 1 as [red, green, blue].
 * @param {number} share
 */
function viridis(share) {
  const position = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1);
  const below = Math.min(Math.floor(position), STOPS.length - 2);
  const rest = position - below;
  return STOPS[below].map((c, i) => Math.round(c + rest * (STOPS[below + 1][i] - c)));
}

/**
 * Background and legible text colour for a value between `low` and `high`.
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
export function valueColours(value, low, high) {
  const rgb = viridis(high > low ? (value - low) / (high - low) : 0);
  // Where black and white are equally far, either has a contrast of 4.58; a dark grey would have less than 4.5.
  return { background: `rgb(${rgb.join(" ")})`, color: luminance(rgb) > 0.179 ? "#000" : "#fff" };
}

/**
 * Relative luminance by WCAG.
 * @param {number[]} rgb
 */
function luminance(rgb) {
  const [r, g, b] = rgb.map((c) => {
    const share = c / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
