// Components that are loaded when they are first opened, as most visits open few; and slots, which features fill.
import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { root } from "../api.js";
import { fillersOf, imported } from "../features.js";
import { connection, setEntry } from "../store.js";
import { html } from "./elements.js";

/** @import { Signal } from "@preact/signals" */
/** @import { LoadedPart } from "../types.js" */
/** @import { FunctionComponent } from "preact" */

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
  useEffect(() => {
    if (loaded.value[source] || state !== "live") return;
    load().then((component) => setEntry(loaded, source, component), () => setFailed(true));
  }, [state]);
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
