// What features add to the page, drawn where the core has a place for it; loaded when it is first seen.
import { fillersOf, imported } from "../features.js";
import { html, Loaded, withStyle } from "./elements.js";

/** @import { LoadedPart } from "../types.js" */

/** Load a part of a feature, with its style. @param {LoadedPart & { feature: string }} part */
export const loadPart = ({ feature, show, style }) =>
  (style ? withStyle(`features/${feature}/${style}`, imported(feature, show)) : imported(feature, show));

/** @param {{ part: LoadedPart & { feature: string } } & Record<string, unknown>} props */
export const Part = ({ part, ...props }) =>
  html`<${Loaded} name=${part.loading} load=${() => loadPart(part)} ...${props} />`;

/**
 * What features put in a place, which may be one of another feature; it is drawn with the other properties.
 * @param {{ name: string } & Record<string, unknown>} props
 */
export const Slot = ({ name, ...props }) => fillersOf(name).map((filler) => ("component" in filler
  ? html`<${filler.component} key=${filler.feature} ...${props} />`
  : html`<${Part} key=${filler.feature} part=${filler} ...${props} />`));
