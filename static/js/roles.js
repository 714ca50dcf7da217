// Modules that pages of one role alone need: loaded when the page becomes one of it.
import { effect, signal, untracked } from "@preact/signals";
import { connection } from "./store.js";

/**
 * Load a module for a role; if that fails, again once the connection is back.
 * @template Module
 * @param {() => boolean} isRole
 * @param {() => Promise<Module>} load
 * @param {(module: Module) => void} follow called whenever the page becomes one of the role
 */
export function loadFor(isRole, load, follow) {
  const loaded = signal(/** @type {Module | null} */ (null));
  effect(() => {
    const isMissing = isRole() && connection.value === "live" && loaded.value === null;
    if (isMissing) load().then((module) => (loaded.value = module), () => {});
  });
  effect(() => {
    const module = loaded.value;
    if (isRole() && module) untracked(() => follow(module));
  });
}
