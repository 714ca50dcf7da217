// What was dropped on the page, pasted, or chosen by a button: the file or the folder of one robot, which is read.
import { filesBelow, filesOfInput, packFolder } from "./folder.js";
import { openFile } from "./reading.js";
import { takeFiles } from "./stored-robots.js";
import { robotsAreOpen } from "./dialogs.js";
import { wantDialog } from "../../js/features.js";

/** @typedef {File | FileSystemEntry} Content */

const SAVED = /\.json$/i;
const DOCUMENT_OR_MESH = /\.(urdf|xml|mjcf|xacro|ya?ml|stl|obj|dae|gltf|glb|bin|ply|msh|3ds)$/i;

/** @type {(content: Content) => content is FileSystemEntry} */
const isEntry = (content) => "isDirectory" in content;
/** @param {FileSystemEntry} entry @returns {Promise<File>} */
const fileOf = (entry) => new Promise((resolve, reject) => {
  /** @type {FileSystemFileEntry} */ (entry).file(resolve, reject);
});

/** Take what was dropped or pasted. @param {Content[]} contents */
export async function takeDropped(contents) {
  const folders = contents.filter((content) => isEntry(content) && content.isDirectory);
  if (folders.length) {
    const folder = /** @type {FileSystemDirectoryEntry} */ (folders[0]);
    openFile(folder.name, async () => packFolder(folder.name, await filesBelow(folder)));
    return;
  }
  takeRobotFiles(await Promise.all(contents.map((content) => (isEntry(content) ? fileOf(content) : content))));
}

/** Take the files of a folder that was chosen. @param {Iterable<File>} files */
export function takeFolder(files) {
  const all = [...files];
  if (!all.length) return;
  const name = all[0].webkitRelativePath.split("/")[0] || "robot";
  openFile(name, () => packFolder(name, filesOfInput(all)));
}

/**
 * Take files of a robot: one as it is, several as those of a folder. Robots that were saved elsewhere are stored.
 * @param {File[]} files
 */
export function takeRobotFiles(files) {
  const [saved, others] = [files.filter(({ name }) => SAVED.test(name)), files.filter(({ name }) => !SAVED.test(name))];
  if (saved.length) {
    wantDialog("robots");
    robotsAreOpen.value = true;
    takeFiles(saved);
  }
  if (!others.length) return;
  robotsAreOpen.value = false;
  const [file] = others;
  if (others.length === 1 || !others.every(({ name }) => DOCUMENT_OR_MESH.test(name))) {
    openFile(file.name, () => Promise.resolve(file));
    return;
  }
  const document = others.find(({ name }) => /\.(urdf|xacro|xml|mjcf)$/i.test(name)) ?? file;
  const name = document.name.replace(/\.[^.]*$/, "");
  openFile(name, () => packFolder(name, others.map((entry) => ({ path: entry.name, file: entry }))));
}
