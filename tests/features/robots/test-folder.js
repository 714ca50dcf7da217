// Which files of a folder are sent, and the zip in which they are.
import assert from "node:assert/strict";
import { test } from "node:test";
import { inflateRawSync } from "node:zlib";
import { chosenFiles, filesBelow, filesOfInput, MAX_FILES, namesIn } from "../../../static/features/robots/folder.js";
import { crc32, zipOf } from "../../../static/features/robots/zip.js";

/** @type {(path: string, text?: string) => { path: string, file: File }} */
const fileAt = (path, text = "x") => ({ path, file: new File([text], String(path.split("/").at(-1))) });

/** The paths that are chosen, sorted. @param {{ path: string, file: File }[]} files */
const pathsOf = async (files) => (await chosenFiles(files)).map(({ path }) => path).sort();

test("the documents are sent, and the meshes that they name in whatever way", async () => {
  const urdf = `<robot><mesh filename="package://rex/meshes/Torso.STL"/><mesh filename='C:\\\\cad\\\\my leg.stl'/>
    <mesh filename="../meshes/foot%20left.obj"/><mesh filename="meshes/\${side}_hip.dae"/></robot>`;
  assert.deepEqual(await pathsOf([
    fileAt("urdf/rex.urdf", urdf), fileAt("package.xml", "<package/>"), fileAt("config/joints.yaml", "a: 1"),
    fileAt("meshes/torso.stl"), fileAt("meshes/my leg.stl"), fileAt("meshes/foot left.obj"),
    fileAt("meshes/left_hip.dae"), fileAt("meshes/unused.stl"), fileAt("README.md", "torso.stl"),
    fileAt("photo.jpg"), fileAt(".git/config.xml"), fileAt("node_modules/a.urdf"),
  ]), [
    "config/joints.yaml", "meshes/foot left.obj", "meshes/left_hip.dae", "meshes/my leg.stl", "meshes/torso.stl",
    "package.xml", "urdf/rex.urdf",
  ]);
});

test("the numbers of a glTF go with it", async () => {
  const files = [
    fileAt("a.urdf", "<mesh filename='m/leg.gltf'/>"), fileAt("m/leg.gltf"), fileAt("m/leg.bin"), fileAt("n/other.bin"),
  ];
  assert.deepEqual(await pathsOf(files), ["a.urdf", "m/leg.bin", "m/leg.gltf"]);
});

test("a folder without a document, or with too many files, is refused with what is valid", async () => {
  await assert.rejects(chosenFiles([fileAt("leg.stl"), fileAt("joints.yaml")]),
    /no document of a robot \(\.urdf, \.xml, \.mjcf, \.xacro\)\. It has: leg\.stl and joints\.yaml\./);
  await assert.rejects(chosenFiles([]), /It has: no files/);
  const many = Array.from({ length: MAX_FILES + 1 }, (_, n) => ({ path: `${n}.stl`, file: new File([], "") }));
  await assert.rejects(chosenFiles(many), /more than 10,000 files: choose the folder of one robot/);
  assert.equal((await chosenFiles([fileAt("a.urdf"), ...many.slice(2)])).length, 1);
});

test("names are the last parts of paths, and expressions in them stand for anything", () => {
  const { names, patterns } = namesIn(`file="a/B.stl" b='c\\d.OBJ' "\${x}/$(arg n)_e.stl" nodots`);
  assert.ok(["b.stl", "d.obj"].every((name) => names.has(name)));
  assert.deepEqual([...patterns], ["*_e.stl"]);
});

test("names of meshes whose endings are in expressions, and accents written either way", () => {
  const { names, patterns } = namesIn(`"meshes/\${kind}_leg\${ending}" "Fu\u0308\u00df%20links.stl" "\${plain}"`);

  assert.deepEqual([...patterns], ["*_leg*"]);
  const feet = [...names].filter((name) => name.includes("links"));
  assert.deepEqual(feet, ["f\u00fc\u00df%20links.stl", "f\u00fc\u00df links.stl"]);
});

test("the files of a folder that was chosen lose the folder's own name", () => {
  const file = Object.defineProperty(new File([], "a.urdf"), "webkitRelativePath", { value: "rex/urdf/a.urdf" });
  assert.deepEqual(filesOfInput([file]).map(({ path }) => path), ["urdf/a.urdf"]);
});

/** A folder as browsers tell of it, some entries at a time. @type {(name: string, children: any[]) => any} */
const folder = (name, children) => ({
  name, isFile: false, isDirectory: true,
  createReader: () => {
    const waiting = [...children];
    return { readEntries: (/** @type {(some: any[]) => void} */ take) => take(waiting.splice(0, 2)) };
  },
});
/** @param {string} name */
const entry = (name) => ({
  name, isFile: true, isDirectory: false,
  file: (/** @type {(file: File) => void} */ take) => take(new File([], name)),
});

test("a dropped folder is read to its end, without hidden folders, and not beyond the limit", async () => {
  const root = folder("rex", [
    entry("a.urdf"), entry("b.stl"), folder("meshes", [entry("c.stl")]), folder(".git", [entry("d")]), entry("e"),
  ]);
  const files = await filesBelow(root);
  assert.deepEqual(files.map(({ path }) => path).sort(), ["a.urdf", "b.stl", "e", "meshes/c.stl"]);
  const large = folder("large", Array.from({ length: MAX_FILES + 1 }, (_, n) => entry(`${n}`)));
  await assert.rejects(filesBelow(large), /more than 10,000 files/);
});

test("a zip has each file as it was, deflated where that is smaller, and is always the same", async () => {
  const text = "<robot/>".repeat(100);
  const files = [{ path: "urdf/ä.urdf", data: new Blob([text]) }, { path: "b.stl", data: new Blob(["xyz"]) }];
  const zip = Buffer.from(await (await zipOf(files)).arrayBuffer());
  assert.deepEqual(zip, Buffer.from(await (await zipOf(files)).arrayBuffer()));
  assert.ok(zip.length < text.length);
  const end = zip.length - 22;
  assert.deepEqual([zip.readUInt32LE(end), zip.readUInt16LE(end + 10)], [0x06054b50, 2]);
  let at = zip.readUInt32LE(end + 16);
  const found = [];
  for (let n = 0; n < 2; n += 1) {
    assert.equal(zip.readUInt32LE(at), 0x02014b50);
    const [method, crc, size, length] =
      [zip.readUInt16LE(at + 10), zip.readUInt32LE(at + 16), zip.readUInt32LE(at + 20), zip.readUInt16LE(at + 28)];
    const [name, local] = [zip.toString("utf-8", at + 46, at + 46 + length), zip.readUInt32LE(at + 42)];
    assert.deepEqual([zip.readUInt32LE(local), zip.readUInt16LE(local + 26)], [0x04034b50, length]);
    const data = zip.subarray(local + 30 + length, local + 30 + length + size);
    const content = method === 8 ? inflateRawSync(data) : data;
    assert.equal(crc32(content), crc);
    found.push([name, method, content.toString()]);
    at += 46 + length;
  }
  assert.deepEqual(found, [["urdf/ä.urdf", 8, text], ["b.stl", 0, "xyz"]]);
  assert.equal(crc32(Buffer.from("123456789")), 0xcbf43926);
});
