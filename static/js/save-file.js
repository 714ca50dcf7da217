// Saves a file that the page has made.

const KEPT_MS = 60_000;

/** @type {(content: Blob, name: string) => void} */
export function saveFile(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
}
