// Icons, drawn in the colour of the text beside them.
import { html } from "../html.js";

const SUN = "M8 5.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6";
const STRAIGHT_RAYS = "M8 1v1.6M8 13.4V15M1 8h1.6M13.4 8H15";
const SLANTED_RAYS = "M3.05 3.05l1.1 1.1M11.85 11.85l1.1 1.1M3.05 12.95l1.1-1.1M11.85 4.15l1.1-1.1";
const LINK_LEFT = "M6.6 9.4a2.6 2.6 0 0 0 3.7 0l2.4-2.4a2.6 2.6 0 0 0-3.7-3.7l-.9.9";
const LINK_RIGHT = "m1.3 2.4a2.6 2.6 0 0 0-3.7 0L3.3 9a2.6 2.6 0 0 0 3.7 3.7l.9-.9";

const PATHS = {
  play: "M5 3.2v9.6l8-4.8z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  stop: "M3.5 3.5h9v9h-9z",
  skip: "M3 3.2v9.6l6.5-4.8zM10.5 3h2.5v10h-2.5z",
  link: `${LINK_LEFT}${LINK_RIGHT}`,
  light: `${SUN}${STRAIGHT_RAYS}${SLANTED_RAYS}`,
  dark: "M13.2 9.6A5.6 5.6 0 0 1 6.4 2.8a5.6 5.6 0 1 0 6.8 6.8z",
  auto: "M8 2.2a5.8 5.8 0 1 0 0 11.6A5.8 5.8 0 0 0 8 2.2M8 2.2v11.6M8 4.8h3.9M8 8h5.8M8 11.2h3.9",
  flag: "M4 14V2.5h8.5L10.8 5.3l1.7 2.7H4",
};
const OUTLINED = new Set(["link", "light", "dark", "auto", "flag"]);
const SIZE = 16;

export function Icon({ name }) {
  const style = OUTLINED.has(name) ? "icon outlined" : "icon";
  return html`
    <svg class=${style} viewBox=${`0 0 ${SIZE} ${SIZE}`} width=${SIZE} height=${SIZE} aria-hidden="true">
      <path d=${PATHS[name]} />
    </svg>
  `;
}
