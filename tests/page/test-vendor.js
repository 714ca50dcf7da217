// The vendored modules are the packages whose types are checked against, and the importmap names them all.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";

const ROOT = new URL("../../", import.meta.url);
const PACKAGES = {
  "preact.js": "preact/dist/preact.mjs",
  "preact-hooks.js": "preact/hooks/dist/hooks.mjs",
  "preact-signals.js": "@preact/signals/dist/signals.module.js",
  "preact-signals-core.js": "@preact/signals-core/dist/signals-core.module.js",
  "htm.js": "htm/dist/htm.module.js",
};

/** @param {string} path */
const read = (path) => readFileSync(new URL(path, ROOT), "utf8");
/** @param {string} text */
const withoutSourceMap = (text) => text.replace(/\n?\/\/# sourceMappingURL=.*/, "").trim();

for (const [file, path] of Object.entries(PACKAGES)) {
  test(`${file} is ${path}`, () => {
    assert.equal(withoutSourceMap(read(`static/vendor/${file}`)), withoutSourceMap(read(`node_modules/${path}`)));
  });
}

test("the importmap resolves every vendored module", () => {
  const [, map] = read("static/index.html").match(/<script type="importmap">(.*?)<\/script>/s) ?? [];
  const files = Object.values(JSON.parse(map).imports).map((path) => path.replace("./static/vendor/", ""));
  const vendored = readdirSync(new URL("static/vendor/", ROOT)).filter((name) => name.endsWith(".js"));
  assert.deepEqual(files.sort(), vendored.sort());
});
