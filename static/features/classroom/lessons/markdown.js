// Markdown enough for a preview: paragraphs, lists, strong, emphasis and code. What a room shows the server renders.

/** @typedef {{ kind: "text" | "strong" | "em" | "code", text: string }} Inline */
/** @typedef {{ kind: "paragraph" | "list", parts: Inline[], items: Inline[][] }} Block */

const MARKS = /(\*\*[^*]+\*\*|\*[^*]+\*|`[^`]+`)/;
const ITEM = /^\s*[-*]\s+/;

/** @param {string} text @returns {Inline[]} */
function inline(text) {
  return text.split(MARKS).filter(Boolean).map((piece) => {
    if (/^\*\*.+\*\*$/.test(piece)) return { kind: "strong", text: piece.slice(2, -2) };
    if (/^\*.+\*$/.test(piece)) return { kind: "em", text: piece.slice(1, -1) };
    return /^`.+`$/.test(piece) ? { kind: "code", text: piece.slice(1, -1) } : { kind: "text", text: piece };
  });
}

/** The paragraphs and lists of a text. @param {string} text @returns {Block[]} */
export const paragraphs = (text) => text.split(/\n\s*\n/).map((block) => block.trim()).filter(Boolean).map((block) => {
  const lines = block.split("\n");
  const isList = lines.every((line) => ITEM.test(line));
  return isList
    ? { kind: "list", parts: [], items: lines.map((line) => inline(line.replace(ITEM, ""))) }
    : { kind: "paragraph", parts: inline(lines.join(" ")), items: [] };
});
