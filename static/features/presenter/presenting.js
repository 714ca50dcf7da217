// The presenter's window: full screen and large type, until the screen is left or another view is opened.
import { effect, signal } from "@preact/signals";
import { change, page } from "../../js/page-state.js";
import { helpIsOpen, isProjected } from "../../js/page.js";
import { followPresentation } from "./presentation.js";

/** Whether the page fills the screen. */
export const isFullScreen = signal(false);

/** Fill the screen, where the browser allows it. */
export const enterFullScreen = () => document.documentElement.requestFullscreen?.().catch(() => {});

export function present() {
  change({ view: "race", isPresenting: true });
  helpIsOpen.value = false;
  enterFullScreen();
}

export const leavePresenter = () => change({ isPresenting: false });
export const togglePresenting = () => (page.isPresenting.value ? leavePresenter : present)();
export const openRemote = () => change({ isRemote: true });

/** Keep the marks of the presenter's window, which ends with the full screen and with the view of the race. */
export function followPresenter() {
  isFullScreen.value = document.fullscreenElement !== null;
  document.addEventListener("fullscreenchange", () => {
    isFullScreen.value = document.fullscreenElement !== null;
    if (!isFullScreen.value) leavePresenter();
  });
  effect(() => {
    if (page.view.value !== "race") leavePresenter();
    isProjected.value = page.isPresenting.value;
    document.documentElement.toggleAttribute("data-presenting", page.isPresenting.value);
    if (!page.isPresenting.value && document.fullscreenElement) document.exitFullscreen().catch(() => {});
  });
  followPresentation();
}
