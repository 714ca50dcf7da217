// Chooses the files of a folder that describe a robot, by the rule of docs/robot-files.md: all documents, and the
// meshes that one of them names. Nothing else of it leaves this computer.
import { listed } from "../../js/format.js";
import { zipOf } from "./zip.js";

/** A file of a folder: its path in it, with slashes. @typedef {{ path: string, file: File }} FolderFile */
/** What was dropped, as far as it is read. @typedef {{ isFile: boolean, isDirectory: boolean, name: string }} Entry */

/** As hexapods/imports/documents/folder.py. */
export const MAX_FILES = 10_000;
const MAX_DEPTH = 40;
const [MAX_DOCUMENT_BYTES, MAX_DOCUMENTS_BYTES] = [2 ** 22, 2 ** 24];
const ROBOT_DOCUMENTS = [".urdf", ".xml", ".mjcf", ".xacro"];
const DOCUMENTS = [...ROBOT_DOCUMENTS, ".yaml", ".yml"];
const MESHES = [".stl", ".obj", ".dae", ".gltf", ".glb", ".bin", ".ply", ".msh", ".3ds"];
const SKIPPED = ["__MACOSX", "node_modules"];

/** @type {(path: string, endings: string[]) => boolean} */
const endsWith = (path, endings) => endings.some((ending) => path.toLowerCase().endsWith(ending));
/** @param {string} name */
const isSkipped = (name) => name.startsWith(".") || SKIPPED.includes(name);
/** @param {string} path */
const folderOf = (path) => path.slice(0, path.lastIndexOf("/") + 1);
/** A name as names are compared: without regard to case, accents composed. @param {string} name */
const plain = (name) => name.normalize("NFC").toLowerCase();
/** The last part of a path of any system. @param {string} path */
const lastPart = (path) => plain(path.split(/[/\\]/).at(-1) ?? "");
/** A name without `%20` and the like. @param {string} name */
function decoded(name) {
  try {
    return plain(decodeURIComponent(name));
  } catch {
    return name;
  }
}

class TooManyFiles extends Error {
  constructor() {
    super(`It has more than ${MAX_FILES.toLocaleString("en")} files: choose the folder of one robot, with its meshes.`);
  }
}

/**
 * The names of files that may appear in a document, in lower case; of those with expressions patterns.
 * @param {string} text
 */
export function namesIn(text) {
  const [names, patterns] = [new Set(), new Set()];
  for (const piece of text.match(/[^"'<>\r\n]+/g) ?? []) {
    const path = piece.trim().replace(/\$\{[^}]*\}|\$\([^)]*\)/g, "*");
    for (const word of new Set([path, ...path.split(/\s+/)])) {
      const name = lastPart(word);
      if (!name.includes(".") && !(name.includes("*") && word.includes("/"))) continue;
      for (const spelling of [name, decoded(name)]) (spelling.includes("*") ? patterns : names).add(spelling);
    }
  }
  return { names, patterns };
}

/** Whether a name is one of a pattern, in which `*` stands for anything. @param {string} pattern */
const asExpression = (pattern) =>
  pattern.split("*").map((text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join(".*");

/**
 * The documents of a folder, and the meshes that they name.
 * @param {FolderFile[]} files
 * @returns {Promise<FolderFile[]>}
 * @throws {Error} if there are too many files, or none describes a robot
 */
export async function chosenFiles(files) {
  const kept = files.filter(({ path }) => !path.split("/").some(isSkipped));
  if (kept.length > MAX_FILES) throw new TooManyFiles();
  const depth = (/** @type {FolderFile} */ { path }) => path.split("/").length;
  const documents = kept.filter(({ path, file }) => endsWith(path, DOCUMENTS) && file.size <= MAX_DOCUMENT_BYTES)
    .toSorted((a, b) => depth(a) - depth(b) || (a.path < b.path ? -1 : 1));
  if (!documents.some(({ path }) => endsWith(path, ROBOT_DOCUMENTS))) {
    const names = kept.slice(0, 6).map(({ path }) => path);
    throw new Error(`It has no document of a robot (${ROBOT_DOCUMENTS.join(", ")}). It has: ${
      names.length ? listed(names) : "no files"}${kept.length > names.length ? ", and more" : ""}.`);
  }
  const [names, patterns] = [new Set(), new Set()];
  /** @type {FolderFile[]} */
  const chosen = [];
  let bytes = 0;
  for (const document of documents) {
    bytes += document.file.size;
    if (bytes > MAX_DOCUMENTS_BYTES) break;
    chosen.push(document);
    const found = namesIn(await document.file.text());
    found.names.forEach((name) => names.add(name));
    found.patterns.forEach((pattern) => patterns.add(pattern));
  }
  const named = new RegExp(`^(?:${[...patterns].map(asExpression).join("|") || "(?!)"})$`);
  const meshes = kept.filter(({ path }) => endsWith(path, MESHES));
  const isNamed = (/** @type {FolderFile} */ { path }) => names.has(lastPart(path)) || named.test(lastPart(path));
  chosen.push(...meshes.filter(isNamed));
  // A glTF keeps its numbers beside it.
  const folders = new Set(chosen.filter(({ path }) => endsWith(path, [".gltf"])).map(({ path }) => folderOf(path)));
  const buffers = meshes.filter((mesh) =>
    endsWith(mesh.path, [".bin"]) && folders.has(folderOf(mesh.path)) && !chosen.includes(mesh));
  return [...chosen, ...buffers];
}

/**
 * A folder's robot as a zip, under the folder's name.
 * @param {string} name
 * @param {FolderFile[]} files
 */
export async function packFolder(name, files) {
  const chosen = await chosenFiles(files);
  return new File([await zipOf(chosen.map(({ path, file }) => ({ path, data: file })))], `${name}.zip`);
}

// ---- what the browser tells of folders

/** The files of a folder that was chosen by a button. @param {Iterable<File>} files @returns {FolderFile[]} */
export const filesOfInput = (files) => [...files].map((file) => ({
  path: file.webkitRelativePath.split("/").slice(1).join("/") || file.name, file,
}));

/** @type {(entry: FileSystemDirectoryEntry) => Promise<FileSystemEntry[]>} */
async function entriesIn(entry) {
  const reader = entry.createReader();
  /** @type {FileSystemEntry[]} */
  const all = [];
  // A reader gives some at a time, and none at the end.
  for (;;) {
    const some = await new Promise((resolve, reject) => {
      reader.readEntries(resolve, reject);
    });
    if (!some.length) return all;
    all.push(...some);
  }
}

/**
 * The files below a folder that was dropped, without those of hidden folders.
 * @param {FileSystemDirectoryEntry} root
 * @returns {Promise<FolderFile[]>}
 * @throws {Error} if there are too many
 */
export async function filesBelow(root) {
  /** @type {FolderFile[]} */
  const files = [];
  /** @type {{ entry: FileSystemEntry, path: string }[]} */
  const waiting = (await entriesIn(root)).map((entry) => ({ entry, path: entry.name }));
  for (let next = waiting.pop(); next; next = waiting.pop()) {
    const { entry, path } = next;
    if (isSkipped(entry.name)) continue;
    if (entry.isFile) {
      const file = await new Promise((resolve, reject) => {
        /** @type {FileSystemFileEntry} */ (entry).file(resolve, reject);
      });
      files.push({ path, file });
    } else if (path.split("/").length <= MAX_DEPTH) {
      const below = await entriesIn(/** @type {FileSystemDirectoryEntry} */ (entry));
      waiting.push(...below.map((child) => ({ entry: child, path: `${path}/${child.name}` })));
    }
    if (files.length + waiting.length > MAX_FILES) throw new TooManyFiles();
  }
  return files;
}
