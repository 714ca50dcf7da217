// The dialogs of robots, which are loaded when they are first opened.
import { signal } from "@preact/signals";
import { wantDialog } from "../../js/features.js";

/** Whether the editor of the robot's body is open. */
export const bodyIsOpen = signal(false);
/** Whether the list of stored robots is open. */
export const robotsAreOpen = signal(false);

export const editBody = () => {
  wantDialog("body");
  bodyIsOpen.value = true;
};

export const showRobots = () => {
  wantDialog("robots");
  robotsAreOpen.value = true;
};
