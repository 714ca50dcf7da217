// Files that are taken in as runs: archives of runs, and Q-tables.
import { signal } from "@preact/signals";
import { count } from "../../js/format.js";
import { served } from "../../js/store.js";
import { titleOf } from "../../js/run-words.js";
import { messageOf } from "../../js/titles.js";
import * as api from "./api.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Run } from "../../js/types.js" */

/**
 * A file, and what came of it.
 * @typedef {{ key: number, name: string, state: "busy" | "done" | "refused", words: string }} Imported
 */

/** The newest last. @type {Signal<Imported[]>} */
export const imports = signal([]);

const MIB = 2 ** 20;
let keys = 0;

/** @param {number} key */
export const dismissImport = (key) => (imports.value = imports.value.filter((entry) => entry.key !== key));

/** @type {(key: number, changes: Partial<Imported>) => void} */
const setImport = (key, changes) =>
  (imports.value = imports.value.map((entry) => (entry.key === key ? { ...entry, ...changes } : entry)));

/**
 * Take in files one after the other; each tells what came of it.
 * @param {Iterable<File>} files
 */
export async function importFiles(files) {
  const waiting = [...files].map((file) => ({ file, key: (keys += 1) }));
  imports.value = [
    ...imports.value.filter(({ state }) => state === "refused"),
    ...waiting.map(({ file, key }) => (
      { key, name: file.name, state: /** @type {const} */ ("busy"), words: "is being taken in…" })),
  ];
  for (const { file, key } of waiting) {
    try {
      setImport(key, { state: "done", words: describe(await send(file)) });
    } catch (error) {
      setImport(key, { state: "refused", words: messageOf(/** @type {Error} */ (error)) });
    }
  }
}

/** @type {(file: File) => Promise<Run[]>} */
async function send(file) {
  const most = served().limits.import_bytes[1] ?? Infinity;
  if (file.size > most) {
    throw new Error(`The file has ${Math.ceil(file.size / MIB)} MiB; the most is ${Math.floor(most / MIB)} MiB here.`);
  }
  if (file.name.toLowerCase().endsWith(".npz")) {
    const name = file.name.slice(0, served().limits.name[1] ?? undefined);
    return [await api.importTable(file, name)];
  }
  return (await api.importRuns(file)).items;
}

/** @type {(runs: Run[]) => string} */
function describe(runs) {
  const [run] = runs;
  const isOne = runs.length === 1;
  return isOne ? `is here as the ${run.kind} “${titleOf(run)}”.` : `has brought ${count(runs.length, "run")}.`;
}
