// How far the robots of a class walked, by the setting that each of them was given.

/** @import { ResultEntry } from "../../../../js/types.js" */

/** Charts are drawn of so many settings at most, side by side. */
const MOST = 2;

/**
 * A setting with the robots that were given it. `values`: where the setting is no number, its values in order.
 * @typedef {{ name: string, points: [number, number][], values: string[] | null }} SettingDots
 */

/**
 * The settings of which the class has tried several values, each with the distances by value.
 * @param {string[]} names of the settings that the card opens
 * @param {ResultEntry[]} entries
 * @returns {SettingDots[]}
 */
export const settingDots = (names, entries) => names.map((name) => {
  const robots = entries.flatMap(({ run }) => {
    const value = run?.given[name];
    const distance_m = run?.distance_m ?? null;
    return value === undefined || value === null || distance_m === null ? [] : [{ value, distance_m }];
  });
  const isNumber = robots.every(({ value }) => typeof value === "number");
  const values = isNumber ? null : [...new Set(robots.map(({ value }) => String(value)))].sort();
  const points = robots.map(({ value, distance_m }) =>
    /** @type {[number, number]} */ ([values ? values.indexOf(String(value)) : Number(value), distance_m]));
  return { name, points, values };
}).filter(({ points }) => new Set(points.map(([x]) => x)).size > 1).slice(0, MOST);
