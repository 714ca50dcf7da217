// Files that are dropped anywhere on the page, or pasted: the feature that takes files gets them.
import { signal } from "@preact/signals";
import { fileTaker, imported } from "../features.js";
import { isOperator } from "../selectors.js";
import { html, Icon } from "./elements.js";

const TEXT = "input, textarea, select, [contenteditable]";
/** While files are dragged, browsers tell of it at least so often [ms]. */
const GONE_MS = 800;

const isOver = signal(false);
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/** Show that files can be dropped, until nothing is heard of them. */
function showTarget() {
  isOver.value = true;
  clearTimeout(timer);
  timer = setTimeout(() => (isOver.value = false), GONE_MS);
}

/** Whether files are dragged that can be dropped here. @param {DragEvent} event */
const isWanted = ({ dataTransfer }) =>
  isOperator.value && Boolean(fileTaker.value) && (dataTransfer?.types ?? []).includes("Files");

/**
 * What was dropped or pasted: entries of the file system, which may be folders; files where there are none. Read at
 * once, since it is gone after the event.
 * @param {DataTransfer} data
 * @returns {(File | FileSystemEntry)[]}
 */
export function contentsOf({ items, files }) {
  const entries = [...items].filter(({ kind }) => kind === "file").map((item) => item.webkitGetAsEntry?.() ?? null);
  const there = entries.filter((entry) => entry !== null);
  return there.length && there.length === entries.length ? there : [...files];
}

/** @param {unknown[]} contents */
async function hand(contents) {
  const { name, files } = fileTaker.value ?? {};
  if (name && files && contents.length) (await imported(name, files.call))(contents);
}

/** Take files from now on. */
export function listenForFiles() {
  const onDrag = (/** @type {DragEvent} */ event) => {
    if (!isWanted(event)) return;
    event.preventDefault();
    showTarget();
  };
  addEventListener("dragenter", onDrag);
  addEventListener("dragover", onDrag);
  addEventListener("drop", (event) => {
    if (!isWanted(event) || !event.dataTransfer) return;
    event.preventDefault();
    isOver.value = false;
    hand(contentsOf(event.dataTransfer));
  });
  addEventListener("paste", (event) => {
    const { clipboardData, target } = event;
    if (!isOperator.value || !clipboardData || (target instanceof Element && target.closest(TEXT))) return;
    const contents = contentsOf(clipboardData);
    if (contents.length && fileTaker.value) event.preventDefault();
    hand(contents);
  });
  // The 3D view, over which the page hears of no drag.
  addEventListener("message", ({ origin, data }) => {
    const isDrag = origin === location.origin && data?.type === "hexapods:drag";
    if (isDrag && isOperator.value && fileTaker.value) showTarget();
  });
}

/** Covers the page while files are dragged over it, the 3D view too. */
export const DropTarget = () => isOver.value && html`
  <div class="drop-target" aria-hidden="true"><p><${Icon} name="import" />${fileTaker.value?.files?.words}</p></div>
`;
