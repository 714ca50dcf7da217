// The experiments' part of the address: `#experiments?experiment=sweep&alpha=0.1,0.3&run=…`.
import { effect, signal } from "@preact/signals";
import { place } from "../page.js";
import { read, written } from "./form.js";

/** The experiment that was asked for by its id; null: the newest. */
export const wantedRun = signal(null);

const query = () => {
  const run = wantedRun.value ? { run: wantedRun.value } : {};
  return new URLSearchParams({ ...written(), ...run }).toString().replaceAll("%2C", ",");
};

/** The hash that leads back here. */
const experimentsHash = () => (query() ? `#experiments?${query()}` : "#experiments");

/** The hash as it was last written or read here. */
let known = "";

function readHash() {
  const { hash } = location;
  if (hash === known || !hash.startsWith("#experiments")) return;
  known = hash;
  const search = new URLSearchParams(hash.split("?")[1] ?? "");
  // The bare link of the navigation leaves the form as it was.
  if (search.size === 0) return;
  read(search);
  wantedRun.value = search.get("run");
}

/** The address follows the form, and the form an address that is opened. */
export function followAddress() {
  readHash();
  addEventListener("hashchange", readHash);
  effect(() => {
    if (place.value !== "experiments") return;
    // A link that was followed is read before the form is written over it.
    readHash();
    known = experimentsHash();
    if (location.hash === known) return;
    history.replaceState(history.state, "", `${location.pathname}${location.search}${known}`);
  });
}
