// Files that the browser downloads: the addresses of a run's, and those that the page makes.
import { addressOf, getVideo, getReplay, idQuery, pathOf } from "./api.js";
import { limitsOf } from "./settings.js";

/** @import { RunKey } from "./api.js" */
/** @import { Run } from "./types.js" */

// ---- files of the server

/** @type {(run: RunKey, rest: string) => string} */
const partOf = (run, rest) => addressOf(`${pathOf(run)}/${rest}`);

/** A file of a run's walk, for other programs. @type {(run: RunKey, rest: string) => string} */
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
  if (run.kind === "experiment") {
    return [
      ["Every trial (CSV)", partOf(run, "trials?format=csv")],
      ["Summary (JSON)", partOf(run, "summary")],
    ];
  }
  // Nothing was recorded of an imported table.
  /** @type {[string, string][]} */
  const walk = run.started_at === null ? [] : [
    ["Joints and feet (CSV)", exportOf(run, "trajectory?format=csv")],
    ["Offline replay (HTML)", exportOf(run, "page")],
  ];
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

/**
 * The printable report of an experiment that has ended.
 * @param {RunKey} run
 */
export const reportAddress = (run) => partOf(run, "report");

/** @type {(run: RunKey, name: string) => string} */
export const fileAddress = (run, name) =>
  partOf(run, `files/${name.split("/").map(encodeURIComponent).join("/")}`);

// ---- files of the page

const KEPT_MS = 60_000;
/** Kept below the longest video that the server renders, since each recorded part is rounded up to a picture [s]. */
const VIDEO_MARGIN_S = 1;

/** @type {(content: Blob, name: string) => void} */
export function saveFile(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
}

/** The playback speed at which all that is recorded fits into a video. @param {[number, number][]} recorded_s [s] */
export function videoSpeed(recorded_s) {
  const length_s = recorded_s.reduce((sum, [begin, end]) => sum + end - begin, 0);
  const longest_s = (limitsOf("video_s").maximum ?? Infinity) - VIDEO_MARGIN_S;
  return Math.max(1, Math.ceil((10 * length_s) / longest_s) / 10);
}

/** Have a video of a run rendered, and save it. @param {Run} run */
export async function saveVideo(run) {
  const { recorded_s } = await getReplay(run.id, "paper", null);
  saveFile(await getVideo(run.id, videoSpeed(recorded_s)), `${run.kind}-${run.id}.mp4`);
}
