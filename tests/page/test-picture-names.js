// The names of pictures: the stage, which is everyone's, and a replay, which is one's own; no text has other names.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";

const ROOT = new URL("../../", import.meta.url);
/** Words that stood for either of them before. */
const FORMER = new RegExp([
  "Play again", "Replay it here", "Replay on this page", "[Ww]atch the stage\\b", "[Yy]our own replay",
  "[\"`>]Live\\b", "[\"`>*]On stage\\b", "(?<=[\"`>][^\"`<]*)\\bon stage\\b", "Pause picture", "Play picture",
].join("|"));

/** Lines of files without those that are comments: [path, line]. @param {string} folder @param {RegExp} ends */
const linesOf = (folder, ends) => readdirSync(new URL(folder, ROOT), { recursive: true })
  .map(String).filter((path) => ends.test(path) && !path.includes("vendor"))
  .flatMap((path) => readFileSync(new URL(`${folder}${path}`, ROOT), "utf-8").split("\n")
    .filter((line) => !/^\s*(\/\/|\/?\*)/.test(line)).map((line) => [`${folder}${path}`, line.trim()]));

test("a picture is the stage or a replay, in all texts of the page and the documents", () => {
  const lines = [...linesOf("static/", /\.(js|json)$/), ...linesOf("docs/", /^[^/]*\.md$/)];
  assert.ok(lines.length > 10_000, "they were read");
  assert.deepEqual(lines.filter(([, line]) => FORMER.test(line)), []);
});

test("the names before are recognised", () => {
  for (const line of ['"Play again"', "<b>Live</b>", '"A run on stage"', "*On stage*"]) assert.match(line, FORMER);
  for (const line of ["the run on the stage", '"Its live settings"']) assert.doesNotMatch(line, FORMER);
});
