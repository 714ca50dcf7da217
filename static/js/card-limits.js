// The settings that the open card of a linked lesson lets be changed. It is courtesy: the server locks rooms alone.
import { computed, signal } from "@preact/signals";
/** @import { Bounds, SettingOption } from "./types.js" */

/** By name the bounds of the settings that the card opens; null without a card that runs something. */
export const cardMay = signal(/** @type {Record<string, Partial<Bounds>> | null} */ (null));
/** Whether the user has opened all settings of the lesson. */
export const isFreed = signal(false);

const limits = computed(() => (isFreed.value ? null : cardMay.value));

/** Whether the card closes settings. */
export const closesSome = computed(() => limits.value !== null);

/** No card opens these: a class has them from its room, and one alone chooses them. */
const ALWAYS_OPEN = ["seed", "pace", "name"];

/** Whether the card keeps a field of the form as it is. @param {string} field */
export const isClosed = (field) =>
  limits.value !== null && !(field in limits.value) && !ALWAYS_OPEN.includes(field);

/**
 * A setting of the form, within the bounds of the card.
 * @template {SettingOption | undefined} Setting
 * @param {string} field
 * @param {Setting} setting
 * @returns {Setting}
 */
export function bounded(field, setting) {
  const bounds = limits.value?.[field];
  if (!bounds || !setting) return setting;
  const { minimum = null, maximum = null, choices = null } = bounds;
  return {
    ...setting,
    ...(minimum === null ? {} : { minimum, excludes_minimum: setting.excludes_minimum && minimum === setting.minimum }),
    ...(maximum === null ? {} : { maximum, excludes_maximum: setting.excludes_maximum && maximum === setting.maximum }),
    ...(choices === null ? {} : { choices: choices.map(String) }),
  };
}

/** Whether the card lets a choice of a field be chosen. @param {string} field @param {unknown} choice */
export function isAllowed(field, choice) {
  const choices = limits.value?.[field]?.choices ?? null;
  return choices === null || choices.some((one) => one === choice);
}
