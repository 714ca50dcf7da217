// Sentences about a body that is edited: what is impossible about which legs, its reach, and what else changes.
import { listed, sentence } from "../../js/format.js";
import { objections } from "../../js/preview.js";
import { isSame, partInWords } from "../../js/robots.js";
import { served } from "../../js/store.js";
import { gaitTitle, inFormWords } from "../../js/titles.js";

/** @import { GaitConfig, GaitParts, Preview, SettingOption } from "../../js/types.js" */

/** What speaks against a body, with the legs that make it so. @typedef {{ legs: number[], words: string }} Objection */

/** The declaration of a field of the editor. @param {string} field @returns {SettingOption | undefined} */
export function settingFor(field) {
  const { leg_fields, torso_fields } = served();
  return leg_fields[field] ?? torso_fields[field];
}

/** A sentence of the server, in which fields have their names here. @param {string} text */
export const inOwnWords = (text) => sentence(inFormWords(text).replace(/\b[a-z]+(_[a-z]+)*_m\b/g, (field) =>
  settingFor(field)?.title.toLowerCase() ?? partInWords(field)[0]));

/** What a leg cannot reach; "" if it reaches all. @type {(preview: Preview, leg: number) => string} */
export function unreachedBy(preview, leg) {
  const words = preview.legs[leg - 1]?.out_of_reach;
  return words ? `${inOwnWords(words)}.` : "";
}

/** What speaks against a body that can be built. @param {Preview} preview @returns {Objection[]} */
export function objectionsTo(preview) {
  const [first, ...more] = preview.legs.filter(({ out_of_reach }) => out_of_reach !== null).map(({ leg }) => leg);
  const also = more.length ? ` So it is with leg${more.length > 1 ? "s" : ""} ${listed(more.map(String))}.` : "";
  return [
    ...(first ? [{ legs: [first, ...more], words: unreachedBy(preview, first) + also }] : []),
    ...objections({ ...preview, out_of_reach: null }).map((words) => ({ legs: [], words })),
  ];
}

/** The grids that its feet reach; "" if they reach none. @param {Preview} preview */
export function reachInWords({ largest_side_m, safe_side_m }) {
  if (largest_side_m === null) return "";
  const largest = `Its feet reach a foot grid of at most ${largest_side_m}\u00a0m`;
  if (safe_side_m === null || safe_side_m === largest_side_m) return `${largest}.`;
  return `${largest}; up to ${safe_side_m}\u00a0m no step is ever ruled out.`;
}

/**
 * What changes besides: the way, by how much it has turned to the left, and the gait.
 * @param {{ turned_deg: number, beside: GaitParts, gait: GaitConfig, before: GaitConfig }} changes
 */
export function consequencesOf({ turned_deg, beside: { right_leg, left_leg }, gait, before }) {
  const turned = Math.round(turned_deg);
  const side = turned > 0 ? "left" : "right";
  return [
    turned !== 0 && `Ahead is now ${Math.abs(turned)}° to the ${side}: between legs ${right_leg} and ${left_leg}.`,
    !isSame(gait, before) && `Gait: ${gaitTitle(gait)}, in place of ${gaitTitle(before)}.`,
  ].filter((text) => typeof text === "string");
}
