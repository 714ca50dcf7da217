// The draft of What if: settings of a practice that are tried, beside those of the next run, which they change only
// when they are used. The link has them.
import { computed } from "@preact/signals";
import { form, setFields } from "../../js/form.js";
import { page } from "../../js/page-state.js";
import { parseSetting } from "../../js/parse.js";
import { bounded, isClosed, mainSettings, quantityOf, settingOf, shortTitle } from "../../js/settings.js";

/** @import { ReadonlySignal } from "@preact/signals" */
/** @import { SettingOption, SettingValue } from "../../js/types.js" */

/** @type {(field: string, setting: SettingOption, end: string | null) => [string, SettingOption]} */
const entryOf = (field, setting, end) => {
  const words = end ? { title: quantityOf(setting), unit: `to ${form.value[end]}` } : {};
  return [field, { ...bounded(field, setting), ...words }];
};

/** The settings that can be tried, by their names: the main ones of the learner, and the steps of practice. */
export const triable = computed(() => Object.fromEntries([
  ...mainSettings(form.value.agent).map(({ name, setting, end }) => entryOf(name, setting, end)),
  entryOf("steps", settingOf("steps"), null),
]));

/** A setting of the draft by its name, its value, or why it has none. */
/** @typedef {{ field: string, text: string, value?: SettingValue, mistake?: string }} Entry */

/** What the link has of the draft. @type {ReadonlySignal<Entry[]>} */
const entries = computed(() => page.tried.value.map((text) => {
  const [field, ...rest] = text.split("=");
  const setting = triable.value[field];
  if (!setting) return { field, text, mistake: `valid: ${Object.keys(triable.value).join(", ")}` };
  if (isClosed(field)) return { field, text, mistake: "it is closed here" };
  return { field, text, ...parseSetting(rest.join("="), setting) };
}));

/** What a link says of the draft that is not tried, with the reason: "alhpa=0.8 (valid: alpha, steps)". */
export const untried = computed(() =>
  entries.value.flatMap(({ text, mistake }) => (mistake === undefined ? [] : [`${text} (${mistake})`])));

/** The values of the draft that are not those of the next run, by field. @type {{ value: Record<string, any> }} */
export const draft = computed(() => Object.fromEntries(entries.value
  .filter(({ field, value, mistake }) => mistake === undefined && value !== form.value[field])
  .map(({ field, value }) => [field, value])));

/** The value that is tried. @param {string} field */
export const triedValue = (field) => draft.value[field] ?? form.value[field];

/** What is different from the next run. */
export const differences = computed(() => Object.entries(draft.value).map(([field, value]) =>
  ({ field, title: shortTitle(triable.value[field]), value, next: form.value[field] })));

/**
 * Try another value; the next run's own is no part of the draft.
 * @param {string} field
 * @param {SettingValue} value
 */
export function tryValue(field, value) {
  const { [field]: _, ...rest } = draft.value;
  const all = value === form.value[field] ? rest : { ...rest, [field]: value };
  page.tried.value = Object.entries(all).map(([name, tried]) => `${name}=${tried}`);
}

/** Leave out of the draft what is not tried. */
export const discardUntried = () => {
  page.tried.value = entries.peek().flatMap(({ text, mistake }) => (mistake === undefined ? [text] : []));
};

export const discardDraft = () => { page.tried.value = []; };

/** Take the draft into the settings of the next run. */
export function applyDraft() {
  setFields(draft.value);
  discardDraft();
}
