// A report on paper: it has no switches, so that all that they show is printed, and all that is folded.
import { signal } from "@preact/signals";

/** Whether the page is being printed. */
export const isPrinting = signal(false);

export function followPrinting() {
  addEventListener("beforeprint", () => {
    isPrinting.value = true;
    document.querySelectorAll("details:not(.menu, .as-table)").forEach((details) => details.setAttribute("open", ""));
  });
  addEventListener("afterprint", () => (isPrinting.value = false));
}
