// Saving the body that is edited: under a name, as a robot that is stored and then chosen.
import { batch, computed, signal } from "@preact/signals";
import { robotOf } from "./body.js";
import { body, cancel, canUse, isPreviewed, previewAnswer } from "./body-editor.js";
import { setFields } from "../../js/form.js";
import { toast } from "../../js/page.js";
import { bodyIsOpen } from "./dialogs.js";
import { saveRobot } from "./stored-robots.js";
import { messageOf } from "../../js/titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { FormValue } from "../../js/types.js" */

/** The name under which it is to be saved; null while that is not asked for. @type {Signal<string | null>} */
export const bodyName = signal(null);
/** Why it was not saved; "" if nothing is wrong. */
export const unsaved = signal("");
const isSaving = signal(false);

/** Forget the name when the editor is opened or closed, until the function that is returned is called. */
export const followSaving = () => bodyIsOpen.subscribe(() => batch(() => {
  bodyName.value = null;
  unsaved.value = "";
}));

/** Whether it can be saved: it has a name, and the server has previewed the body as it is. */
export const canSave = computed(() =>
  canUse.value && isPreviewed.value && !isSaving.value && Boolean(bodyName.value?.trim()));

/** Store the body under its name, and choose it. */
export async function saveBody() {
  const [now, answer, name] = [body.peek(), previewAnswer.peek(), bodyName.peek()?.trim()];
  if (!canSave.peek() || !now || !answer || !name) return;
  isSaving.value = true;
  unsaved.value = "";
  try {
    const stored = await saveRobot(robotOf(now), answer.gait, name);
    batch(() => {
      setFields({ robot: stored.id, gait: /** @type {FormValue} */ (answer.gait) });
      toast(stored.name === name ? `${name} is saved.` : `This body is saved already, as ${stored.name}.`);
      cancel();
    });
  } catch (error) {
    unsaved.value = messageOf(/** @type {Error} */ (error));
  }
  isSaving.value = false;
}
