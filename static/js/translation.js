// The page in another language than English: its catalogue, and how the texts of templates are looked up in it. Loaded
// where the page's HTML says that language (app/api/pages.py). English texts are the keys of catalogues.
import htm from "htm";
import { nameIn, sentencesIn } from "./server-sentences.js";

/** @import { h as createElement } from "preact" */
/** @import { Say } from "./server-sentences.js" */

/** @typedef {Record<string, string>} Messages English text → the same in the page's language */
/**
 * `mark`: of decimals. `tagOf`: the template tag of htm. `answer`: what the server names, as agents. `plates`: patterns
 * of words of the labels in the 3D view, with what is written for them. `label`: of the run in the picture. `said`:
 * what the server says in a sentence. `name`: a name of a run that the server has made.
 * @typedef {{
 *   messages: Messages, mark: string, plurals: Intl.PluralRules, listed: (items: string[]) => string,
 *   tagOf: (h: typeof createElement) => ReturnType<typeof htm.bind<any>>,
 *   answer: <Answer>(answer: Answer) => Answer,
 *   plates: [string, string][], label: (text: string) => string, said: (text: string) => string,
 *   name: (text: string) => string,
 * }} Translation
 */

/**
 * @param {string} lang
 * @param {Say} t gives a text of the catalogue its values
 * @returns {Promise<Translation>}
 */
export async function translationTo(lang, t) {
  /** @type {Messages} */
  let messages = {};
  /** @type {Messages} */
  let sentences = {};
  /** @type {[string, string][]} */
  let plates = [];
  try {
    const answer = await fetch(new URL(`../messages/${lang}.json`, import.meta.url));
    const catalogue = await answer.json();
    sentences = catalogue.sentences;
    messages = { ...sentences, ...catalogue.server, ...catalogue.page };
    plates = patternsOf(catalogue.plates);
  } catch {
    // In English rather than not at all.
  }
  const parts = new Intl.NumberFormat(lang).formatToParts(0.5);
  const mark = parts.find(({ type }) => type === "decimal")?.value ?? ".";
  const lists = new Intl.ListFormat(lang);
  const said = sentencesIn(sentences, { messages, mark, t });
  return {
    messages, mark, plurals: new Intl.PluralRules(lang), said,
    listed: (items) => lists.format(items), tagOf: (h) => tagIn(h, messages),
    answer: (answer) => named(answer, said), plates,
    label: (text) => labelIn(text, messages, plates),
    name: (text) => nameIn(text, said, mark),
  };
}

// ---- texts that stand in templates

/** Stands for a field of a template in its text. */
const FIELD = "\u0001";
/** Attributes and properties whose texts people read. */
const READ = "aria-label|title|alt|placeholder|label|words|of";
const ATTRIBUTE = new RegExp(`(\\s(?:${READ})=")([^"${FIELD}]*)(")`, "g");
const LETTER = /\p{L}/u;
const HIDDEN_FIELD = /\{(\d+)\}/g;

/** A text between fields as htm has it: without the lines around it. @param {string} piece */
const asDrawn = (piece) => piece.replace(/^\s*\n\s*|\s*\n\s*$/g, "").replace(/\s+/g, " ");

/**
 * The key of a text between two tags, its fields numbered from 0: "Card {0} of {1}"; empty where it has no words.
 * @param {string} text
 */
function keyOf(text) {
  const pieces = text.split(FIELD).map(asDrawn);
  if (!pieces.some((piece) => LETTER.test(piece))) return { key: "", before: "", after: "" };
  const key = pieces.map((piece, n) => (n ? `{${n - 1}}${piece}` : piece)).join("");
  const trimmed = key.trim();
  const start = key.indexOf(trimmed);
  return { key: trimmed, before: key.slice(0, start), after: key.slice(start + trimmed.length) };
}

/** A template as one text, and where its texts between tags are. @param {readonly string[]} statics */
const partsOf = (statics) => statics.join(FIELD).split(/(<[^>]*>)/);

/** Whether a part of a template is a tag. @param {string} part */
const isTag = (part) => part.startsWith("<");

/** The keys of a template's texts. @param {readonly string[]} statics */
export const keysIn = (statics) => partsOf(statics).flatMap((part) =>
  (isTag(part) ? [...part.matchAll(ATTRIBUTE)].map(([, , text]) => text).filter((text) => LETTER.test(text))
    : [keyOf(part).key])).filter(Boolean);

/**
 * A template in another language: its texts, and for each of its fields the number that it had.
 * @param {readonly string[]} statics
 * @param {Messages} messages
 * @returns {{ statics: string[], order: number[] }}
 */
export function translated(statics, messages) {
  let first = 0;
  /** @type {number[]} */
  const order = [];
  const parts = partsOf(statics).map((part) => {
    const begin = first;
    const count = part.split(FIELD).length - 1;
    first += count;
    const inOrder = () => order.push(...Array.from({ length: count }, (_, n) => begin + n));
    if (isTag(part)) {
      inOrder();
      return part.replace(ATTRIBUTE, (_, before, text, after) => before + (messages[text] ?? text) + after);
    }
    const { key, before, after } = keyOf(part);
    const message = key && messages[key];
    if (!message) {
      inOrder();
      return part;
    }
    return (before + message + after).replace(HIDDEN_FIELD, (_, n) => {
      order.push(begin + Number(n));
      return FIELD;
    });
  });
  return { statics: parts.join("").split(FIELD), order };
}

/**
 * The template tag of htm for a language.
 * @param {typeof createElement} h
 * @param {Messages} messages
 * @returns {ReturnType<typeof htm.bind<any>>}
 */
export function tagIn(h, messages) {
  const html = htm.bind(h);
  /** @type {WeakMap<readonly string[], ReturnType<typeof translated> & { template: any }>} */
  const templates = new WeakMap();
  return (/** @type {TemplateStringsArray} */ statics, /** @type {any[]} */ ...fields) => {
    let entry = templates.get(statics);
    if (!entry) {
      const made = translated(statics, messages);
      entry = { ...made, template: made.statics };
      templates.set(statics, entry);
    }
    return html(entry.template, ...entry.order.map((n) => fields[n]));
  };
}

/**
 * Words as patterns of whole words, each with what is written for it.
 * @param {Messages} words
 * @returns {[string, string][]}
 */
export const patternsOf = (words) => Object.entries(words)
  .map(([word, other]) => [`(?<![\\p{L}-])${word}(?![\\p{L}-])`, other]);

/**
 * The label of the picture in another language: what follows a run's name, which stays.
 * @param {string} text
 * @param {Messages} messages
 * @param {[string, string][]} patterns
 */
export const labelIn = (text, messages, patterns) => messages[text] ?? text.replace(/, [^,]*$/, (end) =>
  patterns.reduce((now, [pattern, other]) => now.replace(new RegExp(pattern, "u"), other), end));

// ---- names that the server gives

/** What people read of an answer; all else has identifiers, links and what people typed. */
const TEXTS = new Set([
  "title", "titles", "choice_titles", "description", "about", "adjective", "help", "headerHint", "words", "does",
  "what", "why", "missed", "unexplained", "compares", "criterion", "sentences",
]);

/**
 * An answer of the server in which titles, descriptions and sentences are those of the catalogue.
 * @template Answer
 * @param {Answer} answer
 * @param {(text: string) => string} said
 * @returns {Answer}
 */
export function named(answer, said) {
  /** @type {(value: any, isText: boolean) => any} */
  const each = (value, isText) => {
    if (typeof value === "string") return isText ? said(value) : value;
    if (Array.isArray(value)) return value.map((item) => each(item, isText));
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([name, of]) => [name, each(of, isText || TEXTS.has(name))]));
  };
  return each(answer, false);
}
