// Archives of runs, and files of Q-tables, over the REST API.
import { addressOf, call, idQuery, pathOf, start } from "../../js/api.js";

/** @import { RunKey } from "../../js/api.js" */
/** @import { Run } from "../../js/types.js" */

/** @param {RunKey} run */
export const archiveAddress = (run) => addressOf(`${pathOf(run)}/export`);
/** Where the archive of several runs is. @param {string[]} ids */
export const exportAddress = (ids) => addressOf(`runs/export?${idQuery(ids)}`);
/**
 * Take in an archive of one run or several.
 * @type {(file: Blob) => Promise<{ items: Run[] }>}
 */
export const importRuns = (file) => start("runs/import", file);
/**
 * Add a training out of the file of a Q-table.
 * @type {(file: Blob, name: string) => Promise<Run>}
 */
export const importTable = (file, name) => call("POST", `trainings/import?${new URLSearchParams({ name })}`, file);
