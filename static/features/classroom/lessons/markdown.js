// Markdown enough for a preview: paragraphs, lists, strong, emphasis and code. What a room shows the server renders.

/** @typedef {{ kind: "text" | "strong" | "em" | "code", text: string }} Inline */
/** @typedef {{ kind: "paragraph" | "list", parts: Inline[], items: Inline[][] }} Block */

const MARKS = /(\*\*[^*]+\*\*|\*[^*]+\*|`[^`]+`)/;
const ITEM = /^\s*[-*]\s+/;

/** @param {string} text @returns {Inline[]} */
function inline(text) {
  return text.split(MARKS).filter(Boolean).map((part) => {
    if (/^\*\*.+\*\*$/.test(part)) return { kind: "strong", text: part.slice(2, -2) };
    if (/^\*.+\*$/.test(part)) return { kind: "em", text: part.slice(1, -1) };
    return /^`.+`$/.test(part) ? { kind: "code", text: part.slice(1, -1) } : { kind: "text", text: part };
  });
}

/** The paragraphs and lists of a text. @param {string} text @returns {Block[]} */
export const paragraphs = (text) => text.split(/\n\s*\n/).map((part) => part.trim()).filter(Boolean).map((part) => {
  const lines = part.split("\n");
  const isList = lines.every((line) => ITEM.test(line));
  return isList
    ? { kind: "list", parts: [], items: lines.map((line) => inline(line.replace(ITEM, ""))) }
    : { kind: "paragraph", parts: inline(lines.join(" ")), items: [] };
});
