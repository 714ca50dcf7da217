// Files of a run that the browser downloads from the server.
import { addressOf, pathOf } from "./api.js";
import { kindOf } from "./features.js";

/** @import { RunKey } from "./api.js" */
/** @import { Run } from "./types.js" */

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
