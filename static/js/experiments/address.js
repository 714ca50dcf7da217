// The experiments' part of the address: `#experiments?experiment=sweep&alpha=0.1,0.3&run=…`.
import { effect, signal } from "@preact/signals";
import { place } from "../page.js";
import { readQuery, toQuery } from "./form.js";

/** @import { Signal } from "@preact/signals" */

/** The id of the requested experiment; null for the newest. @type {Signal<string | null>} */
export const wantedRun = signal(null);

const query = () => {
  const search = new URLSearchParams(toQuery());
  if (wantedRun.value) search.set("run", wantedRun.value);
  return search.toString().replaceAll("%2C", ",");
};

const currentHash = () => (query() ? `#experiments?${query()}` : "#experiments");

/** The hash that was last written or read here. */
let known = "";

function readHash() {
  const { hash } = location;
  if (hash === known || !hash.startsWith("#experiments")) return;
  known = hash;
  const search = new URLSearchParams(hash.split("?")[1] ?? "");
  // The bare link of the navigation leaves the form as it was.
  if (search.size === 0) return;
  readQuery(search);
  wantedRun.value = search.get("run");
}

/** Keep the form and the address the same. Call it once the options are known. */
export function followAddress() {
  readHash();
  addEventListener("hashchange", readHash);
  effect(() => {
    if (place.value !== "experiments") return;
    // A link that was followed is read before the form is written over it.
    readHash();
    known = currentHash();
    if (location.hash === known) return;
    history.replaceState(history.state, "", `${location.pathname}${location.search}${known}`);
  });
}
