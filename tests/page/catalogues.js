// The catalogues of the page's texts, as they are stored.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

export const CATALOGUES = "static/messages";

/** @typedef {Record<"page" | "server" | "sentences" | "plates", Record<string, string>>} Catalogue */

/** Catalogue by language. @returns {Record<string, Catalogue>} */
export const catalogues = () => Object.fromEntries(readdirSync(CATALOGUES).map((name) =>
  [name.replace(".json", ""), JSON.parse(readFileSync(join(CATALOGUES, name), "utf-8"))]));
