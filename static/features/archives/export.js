// Export of runs: the archive of one, and of all that are selected.
import { computed } from "@preact/signals";
import { html } from "../../js/components/elements.js";
import { deletable } from "../../js/run-selection.js";
import { served } from "../../js/store.js";
import { archiveAddress, exportAddress } from "./api.js";

/** @import { Run } from "../../js/types.js" */

/** @param {{ run: Run }} props */
export const Archive = ({ run }) => html`<a href=${archiveAddress(run)} download="">Archive (zip)</a>`;

const exportable = computed(() => deletable.value.filter((run) => !("damaged" in run)));

/** The address of an archive of the selected runs that have one; null if there are none, or too many. */
export const exported = computed(() => {
  const [, most] = served().limits.archive_runs;
  const { length } = exportable.value;
  const isPossible = length > 0 && length <= (most ?? Infinity);
  return { count: length, most, address: isPossible ? exportAddress(exportable.value.map(({ id }) => id)) : null };
});

export function ExportSelected() {
  const { count, most, address } = exported.value;
  if (address) return html`<a class="secondary compact button" href=${address} download="">Export ${count}</a>`;
  return html`<span class="dim">${count ? `An export has up to ${most} runs.` : "None has ended yet."}</span>`;
}
