// The features of the page as the server sends them: their folders, and what they declare.
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { features, installFeatures } from "../../static/js/features.js";

/** @import { Feature } from "../../static/js/types.js" */

/** Where they are. */
export const FOLDER = new URL("../../static/features/", import.meta.url);

/** Every feature that has a folder here. @type {Feature[]} */
export const ALL = readdirSync(FOLDER).filter((name) => existsSync(new URL(`${name}/feature.json`, FOLDER))).sort()
  .map((name) => ({
    name, hasCode: existsSync(new URL(`${name}/feature.js`, FOLDER)),
    ...JSON.parse(readFileSync(new URL(`${name}/feature.json`, FOLDER), "utf-8")),
  }));

/** Install those of these names, as a page does. @param {string[]} names */
export async function installOnly(...names) {
  features.value = ALL.filter(({ name }) => names.includes(name));
  await installFeatures();
}

/** Install all. */
export const installAll = () => installOnly(...ALL.map(({ name }) => name));

/** @type {(title: string, depth: string, order: number) => NonNullable<Feature["tabs"]>[string]} */
const tabOf = (title, depth, order) => ({ title, depth, order, about: title, show: "none.js#None", loading: title });

/** A feature with a part of each kind that a link can name. @type {Feature} */
export const EXAMPLE = {
  name: "example",
  fields: {
    page_number: { part: "query", name: "page", is: "whole" },
    is_lit: { part: "query", name: "lit", is: "flag", initial: false },
    experiment: { part: "experiments", name: null, is: "texts" },
    report: { part: "experiments", name: "run", is: "text", isEntry: true },
  },
  hideable: ["card"],
  tabs: {
    "why": { ...tabOf("Why", "try", 40), isInWatch: true },
    "gait": tabOf("Gait", "study", 50),
    "table": tabOf("Table", "study", 60),
    "what-if": { ...tabOf("What if", "study", 70) },
  },
  views: {
    experiments: { title: "Experiments", isInHeader: true, show: "none.js#None", loading: "experiments" },
    lessons: { title: "Lessons", show: "none.js#None", loading: "lessons" },
  },
};
