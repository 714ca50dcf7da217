// Places on an axis: from a number to a share of the width, and round numbers to write beside it.

/** A value's place between `low` and `high`, from 0 to 1. */
export const shareOf = (value, low, high) =>
  high > low ? Math.min(Math.max((value - low) / (high - low), 0), 1) : 0;

export const percent = (share) => `${(100 * share).toFixed(2)}%`;

/** Round numbers from 0 up to `high`, about `count` of them. */
export function ticks(high, count = 5) {
  if (!(high > 0)) return [0];
  const rough = high / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((n) => n * power).find((one) => one >= rough);
  return Array.from({ length: Math.floor(high / step + 1e-9) + 1 }, (_, n) => n * step);
}

/** The largest, and no less than `least`; lists may be longer than a call may have arguments. */
export const largest = (values, least = 0) => values.reduce((top, value) => (value > top ? value : top), least);

/** At most so many, evenly out of all in their order, and the first and the last. */
export function thinned(list, most) {
  if (list.length <= most) return list;
  return Array.from({ length: most }, (_, n) => list[Math.round((n * (list.length - 1)) / (most - 1))]);
}

const BINS = 64;

/**
 * Where dots lie beside each other instead of on each other.
 * @param shares places from 0 to 1
 * @returns for each how many dots it is away from the middle: 0, 1, −1, 2, −2…
 */
export function swarm(shares) {
  const taken = new Map();
  return shares.map((share) => {
    const bin = Math.round(share * BINS);
    const before = taken.get(bin) ?? 0;
    taken.set(bin, before + 1);
    return before % 2 ? (before + 1) / 2 : -before / 2;
  });
}
