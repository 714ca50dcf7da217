// Files that the browser downloads: the addresses of a run's, and those that the page makes.
import { addressOf, idQuery, pathOf, postExport } from "./api.js";
import { kindOf } from "./features.js";
import { served } from "./store.js";

/** @import { RunKey } from "./api.js" */
/** @import { ExportOption, Run } from "./types.js" */

// ---- files of the server

/** @type {(run: RunKey, rest: string) => string} */
export const partOf = (run, rest) => addressOf(`${pathOf(run)}/${rest}`);

/** Where a file of a run's walk is, for other programs. @type {(run: RunKey, rest: string) => string} */
const exportOf = ({ id }, rest) => addressOf(`runs/${encodeURIComponent(id)}/${rest}`);

/** @param {RunKey} run */
export const archiveAddress = (run) => partOf(run, "export");
/** Where the archive of several runs is. @param {string[]} ids */
export const exportAddress = (ids) => addressOf(`runs/export?${idQuery(ids)}`);

/**
 * The files of a run that can be downloaded: [label, address].
 * @param {RunKey & Partial<Run>} run
 * @returns {[string, string][]}
 */
export function downloads(run) {
  const kind = kindOf(run);
  if (kind) return kind.downloads(run);
  // Nothing was recorded of an imported table.
  /** @type {[string, string][]} */
  const walk = run.started_at === null ? [] : served().exports
    .filter(({ method, install }) => method === "GET" && install === null)
    .map(({ title, address }) => [title, exportOf(run, address)]);
  if (run.kind === "race") return [["Recording", partOf(run, "recording")], ...walk];
  return [["Curve (CSV)", partOf(run, "curve?format=csv")], ...learned(run), ...walk];
}

/**
 * Downloads of the learned state. A training that was interrupted, failed or never began has stored none.
 * @param {RunKey & Partial<Run>} run
 * @returns {[string, string][]}
 */
function learned(run) {
  if (!run.result) return [];
  const npz = partOf(run, "q-table?format=npz");
  if (!run.result.q_table_sha256) return [["Learned state (npz)", npz]];
  return [["Q-table (CSV)", partOf(run, "q-table?format=csv")], ["Q-table (npz)", npz]];
}

/** @type {(run: RunKey, name: string) => string} */
export const fileAddress = (run, name) =>
  partOf(run, `files/${name.split("/").map(encodeURIComponent).join("/")}`);

// ---- files of the page

const KEPT_MS = 60_000;

/** @type {(content: Blob, name: string) => void} */
export function saveFile(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
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

/** Have an export of a run computed, and save it. @type {(run: RunKey, file: ExportOption) => Promise<void>} */
export async function saveExport(run, { address, ending }) {
  saveFile(await postExport(run.id, address), `${run.kind}-${run.id}.${ending}`);
}
