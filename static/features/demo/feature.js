// A demo that is open to strangers: each visitor starts runs of their own. It is loaded on their pages alone.
import { computed, signal } from "@preact/signals";
import { html } from "../../js/components/elements.js";
import { Loaded } from "../../js/features.js";
import { role } from "../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Allowance, Feature, Run } from "../../js/types.js" */

/** Whether this page is a visitor's. */
export const isVisitor = computed(() => role.value === "visitor");
/** What the visitor may still start; null until it is known. @type {Signal<Allowance | null>} */
export const allowance = signal(null);
/** Ids of the visitor's runs, oldest first. @type {Signal<string[]>} */
export const visitorRuns = signal([]);
/**
 * Id of the run that the visitor has started last, whose picture this page is to show by itself; null once it has, or
 * where another was chosen. @type {Signal<string | null>}
 */
export const followed = signal(null);

const loadAllowance = () => import("./allowance.js").then(({ AllowanceLine }) => AllowanceLine);

/** @type {Partial<Feature>} */
export default {
  guest: { isHere: isVisitor, runs: visitorRuns },
  slots: {
    actions: { component: () => isVisitor.value && html`<${Loaded} name="allowance" load=${loadAllowance} />` },
  },
  started: (/** @type {Run} */ run) => {
    if (isVisitor.peek()) followed.value = run.id;
  },
  follow: () => import("./visitor-page.js").then(({ followDemo }) => followDemo()),
};
