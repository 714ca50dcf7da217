// The features of the page: each is a folder of static/features, which the server may leave out. This is their seam:
// the core asks it what features add, and knows none of them. `feature.json` declares what a feature adds, and is in
// the page itself, so that it takes no request; its code is loaded when it is first needed. `feature.js` is there for
// what has to run from the start, and adds to the declaration. Slots draw their parts, which are loaded when they are
// first seen, as most visits open few.
import { computed, effect, signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { root } from "./api.js";
import { html } from "./components/elements.js";
import { inWords, t } from "./format.js";
import { declareFields, declareWords, page } from "./page-state.js";
import { addHandlers, connection, setEntry } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { FunctionComponent } from "preact" */
/** @import { Deck, Feature, LoadedPart, MenuRow, Run, RunKind, SlotPart } from "./types.js" */

/** What the server has written into the page. @returns {Feature[]} */
const declared = () => inWords(JSON.parse(document.getElementById?.("features")?.textContent || "[]"));

/** The features that are there, by name. */
export const features = signal(declared());

/** Whether a feature is there. @param {string} name */
export const hasFeature = (name) => features.value.some((feature) => feature.name === name);

/**
 * Take in features, before the address is read and anything is drawn. One that needs another which is missing is left
 * out.
 * @param {Feature[]} all
 */
export function install(all) {
  const names = all.map(({ name }) => name);
  const isComplete = (/** @type {Feature} */ { needs = [] }) => needs.every((name) => names.includes(name));
  if (!all.every(isComplete)) {
    install(all.filter(isComplete));
    return;
  }
  features.value = all;
  for (const { fields = {}, tabs = {}, views = {}, hideable = [], events = {} } of all) {
    declareFields(fields);
    addHandlers(events);
    declareWords({ tabs: Object.keys(tabs), views: Object.keys(views), hideable });
  }
}

/**
 * The declaration of a feature with what its `feature.js` adds.
 * @param {Feature} feature
 * @returns {Promise<Feature>}
 */
async function withCode(feature) {
  const { default: code } = await import(`../features/${feature.name}/feature.js`);
  return { ...feature, ...code };
}

/** Install the features of the page, with the code that has to run from the start. */
export const installFeatures = async () => install(await Promise.all(
  features.peek().map((feature) => (feature.hasCode && !feature.codeFor ? withCode(feature) : feature))));

/** Load the code that pages of a role alone need, and run it. @param {string} role */
export async function addCodeFor(role) {
  const added = await Promise.all(features.peek().filter(({ codeFor }) => codeFor === role).map(withCode));
  const isNew = added.filter(({ name }) => features.peek().find((feature) => feature.name === name)?.codeFor);
  features.value = features.peek().map((feature) => {
    const { codeFor: _, ...whole } = isNew.find(({ name }) => name === feature.name) ?? feature;
    return isNew.some(({ name }) => name === feature.name) ? whole : feature;
  });
  isNew.forEach(({ follow }) => follow?.());
}

/**
 * What a source names, as "components/gait.js#Gait".
 * @param {string} feature its name
 * @param {string} source
 */
export async function imported(feature, source) {
  const [path, name] = source.split("#");
  return (await import(`../features/${feature}/${path}`))[name];
}

/** Load what features have for a field of the page's state, and run it once, when the field is first set. */
export function followFields() {
  for (const { name, whenSet = {} } of features.peek()) {
    for (const [field, source] of Object.entries(whenSet)) {
      let hasRun = false;
      effect(() => {
        if (hasRun || !isSet(field)) return;
        imported(name, source).then((follow) => {
          if (!hasRun) follow();
          hasRun = true;
        }, () => {});
      });
    }
  }
}

/** Whether a field of the page's state is set. @param {string} field */
const isSet = (field) => Boolean(/** @type {any} */ (page)[field].value);

/** What a key does by a feature, as the page is now; undefined where it does nothing. @param {string} key */
export function actionOfKey(key) {
  for (const { name, keys = {} } of features.value) {
    const { call, while: field } = keys[key] ?? {};
    if (call && (!field || isSet(field))) return () => imported(name, call).then((act) => act());
  }
  return undefined;
}

/** The keys of features that the help lists: [key, what it does]. */
export const helpOfKeys = () => features.value.flatMap(({ keys = {} }) =>
  Object.entries(keys).flatMap(([key, { does }]) => (does ? [[key.toUpperCase(), t(does)]] : [])));

/**
 * The named parts of one kind of all features, each with the name of its feature.
 * @template {"tabs" | "views" | "dialogs" | "panels"} Kind
 * @param {Kind} kind
 * @returns {Record<string, NonNullable<Feature[Kind]>[string] & { feature: string }>}
 */
export const partsOf = (kind) => Object.fromEntries(features.value.flatMap(({ name: feature, ...parts }) =>
  Object.entries(parts[kind] ?? {}).map(([name, part]) => [name, /** @type {any} */ ({ ...part, feature })])));

/**
 * What features put in a place of the core. @param {string} slot
 * @returns {(SlotPart & { feature: string })[]}
 */
export const fillersOf = (slot) => features.value.flatMap(({ name: feature, slots = {} }) =>
  (slots[slot] ? [{ ...slots[slot], feature }] : []));

/** The rows that features add to the menu, in their order. @type {{ value: (MenuRow & { feature: string })[] }} */
export const menuRows = computed(() => features.value
  .flatMap(({ name: feature, menu = [] }) => menu.map((row) => ({ ...row, feature })))
  .sort((a, b) => (a.order ?? 0) - (b.order ?? 0)));

/** The rows that features add to the menu of each run. @type {{ value: (MenuRow & { feature: string })[] }} */
export const rowsOfRuns = computed(() => features.value
  .flatMap(({ name: feature, runMenu = [] }) => runMenu.map((row) => ({ ...row, feature }))));

/**
 * Do what a row of a menu is for.
 * @param {MenuRow & { feature: string }} row
 * @param {Run} [subject] of whose menu it is
 */
export async function runRow({ feature, dialog, call, run }, subject) {
  if (dialog) wantDialog(dialog);
  if (call) (await imported(feature, call))(subject);
  run?.();
}

/** What files are for that are dropped on the page: of the feature that takes any; undefined without one. */
export const fileTaker = computed(() => features.value.find(({ files }) => files));

/** What a feature tells of runs of a kind; null of trainings and races. */
/** @type {(run: { kind: string }) => RunKind | null} */
export const kindOf = ({ kind }) => features.value.find(({ kinds = {} }) => kind in kinds)?.kinds?.[kind] ?? null;

/** @type {Deck} */
const NO_DECK = { cards: signal([]), number: signal(null), open: () => {}, Question: () => null };

/** Cards that are shown one after the other: of the feature that has any. */
export const deck = computed(() => features.value.find((feature) => feature.deck)?.deck ?? NO_DECK);

/** Dialogs that were wanted, by name: they are loaded then, and stay. @type {{ value: string[] }} */
export const wantedDialogs = signal([]);

/** Load a dialog, which its own signal opens. @param {string} name */
export const wantDialog = (name) => {
  if (!wantedDialogs.value.includes(name)) wantedDialogs.value = [...wantedDialogs.value, name];
};

/** The kinds of runs that features add, by their names. */
export const allKinds = () => Object.entries(features.value.reduce((all, { kinds = {} }) => ({ ...all, ...kinds }),
  /** @type {Record<string, RunKind>} */ ({})));

// ---- components that are loaded when they are first opened

/** Loaded components, by their sources. @type {Signal<Record<string, any>>} */
export const loaded = signal({});

/**
 * `load`: imports the module and returns its component, which is drawn with the other properties. `source`: tells it
 * from all others, where its name does not. `isQuiet`: nothing is said while it comes.
 * @param {{
 *   name: string, load: () => Promise<FunctionComponent<any>>, source?: string, isQuiet?: boolean,
 * } & Record<string, unknown>} props
 */
export function Loaded({ name, load, source = name, isQuiet = false, ...props }) {
  const [hasFailed, setFailed] = useState(false);
  const state = connection.value;
  // Preact may draw another component in the place of this one.
  useEffect(() => {
    setFailed(false);
    if (loaded.value[source] || state !== "live") return;
    load().then((component) => setEntry(loaded, source, component), () => setFailed(true));
  }, [state, source]);
  const View = loaded.value[source];
  if (View) return html`<${View} ...${props} />`;
  if (isQuiet) return null;
  if (state === "reconnecting") return html`<p role="status">Waiting for the server to load the ${name}.</p>`;
  return hasFailed
    ? html`<p role="alert">The ${name} could not be loaded. Load the page again.</p>`
    : html`<p role="status"><span class="spinner" aria-hidden="true"></span> Loading the ${name}…</p>`;
}

/**
 * Wait for a module and a style sheet, which the page then keeps.
 * @template Module
 * @param {string} path of the sheet, from the folder of static files
 * @param {Promise<Module>} module
 */
export async function withStyle(path, module) {
  const href = `${root()}static/${path}`;
  if (!document.querySelector(`link[href="${href}"]`)) {
    const link = Object.assign(document.createElement("link"), { rel: "stylesheet", href });
    const isLoaded = new Promise((resolve, reject) => { Object.assign(link, { onload: resolve, onerror: reject }); });
    document.head.append(link);
    await isLoaded.catch((error) => { link.remove(); throw error; });
  }
  return module;
}

/** The plan of the track, in place of the 3D view. */
export const loadPlan = () =>
  withStyle("style/plan.css", import("./components/plan.js")).then(({ Plan }) => Plan);

// ---- what features add, drawn where the core has a place for it; loaded when it is first seen

/** Load a part of a feature, with its style. @param {LoadedPart & { feature: string }} part */
export const loadPart = ({ feature, show, style }) =>
  (style ? withStyle(`features/${feature}/${style}`, imported(feature, show)) : imported(feature, show));

/** @param {{ part: LoadedPart & { feature: string } } & Record<string, unknown>} props */
export const Part = ({ part, ...props }) => html`
  <${Loaded} name=${part.loading} source=${`${part.feature}/${part.show}`} load=${() => loadPart(part)}
    isQuiet=${part.isQuiet} ...${props} />
`;

/**
 * What features put in a place, which may be one of another feature; it is drawn with the other properties.
 * @param {{ name: string } & Record<string, unknown>} props
 */
export const Slot = ({ name, ...props }) => fillersOf(name).map((filler) => ("component" in filler
  ? html`<${filler.component} key=${filler.feature} ...${props} />`
  : html`<${Part} key=${filler.feature} part=${filler} ...${props} />`));
