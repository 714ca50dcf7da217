// Files of a run's walk for other programs: what the server offers, and what it lacks.
import { addressOf, request } from "../../js/api.js";
import { saveFile } from "../../js/save-file.js";
import { served } from "../../js/store.js";

/** @import { RunKey } from "../../js/api.js" */
/** @import { ExportOption, Run } from "../../js/types.js" */

/** @type {(id: string, rest: string) => string} */
const pathOf = (id, rest) => `runs/${encodeURIComponent(id)}/${rest}`;

/**
 * The files of a run's walk that can be downloaded: [label, address].
 * @param {Pick<Run, "id"> & Partial<Run>} run
 * @returns {[string, string][]}
 */
export function walkFiles({ id, started_at }) {
  // Nothing was recorded of an imported table.
  if (started_at === null) return [];
  return served().exports
    .filter(({ method, install }) => method === "GET" && install === null)
    .map(({ title, address }) => [title, addressOf(pathOf(id, address))]);
}

/** The exports that the server computes only for operators, on request. */
export const rendered = () => served().exports.filter(({ method, install }) => method === "POST" && install === null);

/** What the exports need that the server lacks: the command that installs it, and the files by title. */
export function notInstalled() {
  /** @type {Map<string, string[]>} */
  const titles = new Map();
  for (const { title, install } of served().exports) {
    if (install !== null) titles.set(install, [...(titles.get(install) ?? []), title]);
  }
  return [...titles];
}

/**
 * Have an export of a run computed, in up to minutes, and save it.
 * @type {(run: RunKey, file: ExportOption) => Promise<void>}
 */
export async function saveExport({ kind, id }, { address, ending }) {
  const answer = await request("POST", pathOf(id, address));
  saveFile(await answer.blob(), `${kind}-${id}.${ending}`);
}
