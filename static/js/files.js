// Files that the browser downloads: the addresses of a run's, and those that the page makes.
import { addressOf, pathOf } from "./api.js";
import { kindOf } from "./features.js";

/** @import { RunKey } from "./api.js" */
/** @import { Run } from "./types.js" */

// ---- files of the server

/** @type {(run: RunKey, rest: string) => string} */
export const partOf = (run, rest) => addressOf(`${pathOf(run)}/${rest}`);

/**
 * The files of a run that can be downloaded: [label, address].
 * @param {RunKey & Partial<Run>} run
 * @returns {[string, string][]}
 */
export function downloads(run) {
  const kind = kindOf(run);
  if (kind) return kind.downloads(run);
  if (run.kind === "race") return [["Recording", partOf(run, "recording")]];
  return [["Curve (CSV)", partOf(run, "curve?format=csv")], ...learned(run)];
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
