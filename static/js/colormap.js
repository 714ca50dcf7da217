// The viridis colour map, which the 3D stage uses too: equal steps of value look equal.

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
  return { background: `rgb(${rgb.join(" ")})`, color: luminance(rgb) > 0.18 ? "#10141a" : "#fff" };
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
