// The English texts of the page's modules, which are the keys of its catalogues, found in their syntax trees.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { parse } from "espree";
import { keysIn } from "../../static/js/translation.js";

const FOLDERS = ["static/js", "static/features"];

/** The page's modules. */
export const modules = () => FOLDERS.flatMap((folder) =>
  readdirSync(folder, { recursive: true, encoding: "utf-8" }).filter((path) => path.endsWith(".js"))
    .map((path) => join(folder, path)));

/**
 * The value of a text that may be joined of several; undefined where it is not known before it runs.
 * @param {any} node
 * @returns {string | undefined}
 */
function textOf(node) {
  if (node?.type === "Literal" && typeof node.value === "string") return node.value;
  if (node?.type === "TemplateLiteral" && !node.expressions.length) return node.quasis[0].value.cooked;
  if (node?.type !== "BinaryExpression" || node.operator !== "+") return undefined;
  const [left, right] = [textOf(node.left), textOf(node.right)];
  return left === undefined || right === undefined ? undefined : left + right;
}

/** The keys of a call: of `t` its text, of `count` its noun with a number. @param {any} call */
function keysOfCall({ callee, arguments: [first, second] }) {
  const text = textOf(callee.name === "t" ? first : second);
  if (text === undefined) return [];
  if (callee.name === "t") return [text];
  return callee.name === "count" ? [`{number} {number|${text}|${text}s}`] : [];
}

/**
 * The keys below a node of a module's syntax tree.
 * @param {any} node
 * @returns {string[]}
 */
function keysBelow(node) {
  if (Array.isArray(node)) return node.flatMap(keysBelow);
  if (node === null || typeof node !== "object") return [];
  const isTemplate = node.type === "TaggedTemplateExpression" && node.tag.name === "html";
  const own = isTemplate ? keysIn(node.quasi.quasis.map((/** @type {any} */ { value }) => value.cooked))
    : node.type === "CallExpression" ? keysOfCall(node) : [];
  return [...own, ...Object.values(node).flatMap(keysBelow)];
}

/** The keys of a module, in its order. @param {string} path */
export const keysOfModule = (path) => [...new Set(keysBelow(
  parse(readFileSync(path, "utf-8"), { ecmaVersion: "latest", sourceType: "module" })))];

/** The placeholders of a text: "{name}", "{steps|}". @param {string} text */
export const placeholdersOf = (text) =>
  [...new Set([...text.matchAll(/\{(\w+)[|}]/g)].map(([, name]) => name))].sort();
