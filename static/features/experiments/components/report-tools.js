// Tools over a report's figures: the choice of place and unit, and the legend of dot strips.
import { unit, UNITS } from "../distances.js";
import { sentence } from "../../../js/format.js";
import { agentOf, options } from "../../../js/settings.js";
import { observationTitle, robotTitle } from "../../../js/titles.js";
import { html, Segments } from "../../../js/components/elements.js";

/** @import { Described, Place } from "../../../js/types.js" */
/** @import { ComponentChildren } from "preact" */

// ---- the place: observation, robot and foot grid; hidden where there is only one

/** @param {Place} place @param {Place[]} places */
export const placeTitle = (place, places) => {
  /** @param {keyof Place} field */
  const differs = (field) => new Set(places.map((other) => other[field])).size > 1;
  const parts = [
    observationTitle(place.observation),
    differs("robot") && robotTitle(place.robot).toLowerCase(),
    differs("divisions") && `${place.divisions} × ${place.divisions}`,
    differs("grid_side_m") && `${place.grid_side_m} m`,
  ];
  return sentence(parts.filter(Boolean).join(", "));
};

/** @param {Described[] | undefined} list @param {string} name */
const descriptionOf = (list, name) => list?.find((entry) => entry.name === name)?.description ?? "";

/** The observation and the robot of a place, explained. @param {{ place: Place }} props */
export function PlaceWords({ place: { observation, robot } }) {
  const about = descriptionOf(options.value?.observations, observation);
  const words = [`${sentence(observationTitle(observation))}:`, about, descriptionOf(options.value?.robots, robot)];
  return html`<p class="dim">${words.filter(Boolean).join(" ")}</p>`;
}

export const UnitSwitch = () => html`
  <${Segments} label="Unit of distances" choices=${UNITS} value=${unit.value}
    onValue=${(/** @type {string} */ name) => (unit.value = name)} />
`;

const TYPICAL = html`
  <line class="interval" x1="2" x2="18" y1="8" y2="8" /><line class="typical" x1="10" x2="10" y1="3" y2="13" />
`;
/** @typedef {"seed" | "typical" | "greedy" | "half" | "best-known" | "published"} SignName */

/** @type {Record<SignName, [string, ComponentChildren]>} */
const SIGNS = {
  seed: ["one seed", html`<circle class="dot-of-seed" cx="10" cy="8" r="3.5" />`],
  typical: ["interquartile mean, 95 % interval", TYPICAL],
  greedy: ["greedy", html`<line class="mark greedy" x1="10" x2="10" y1="0" y2="16" />`],
  half: ["half of greedy’s", html`<line class="mark half" x1="10" x2="10" y1="0" y2="16" />`],
  "best-known": ["best known", html`<line class="mark best-known" x1="10" x2="10" y1="0" y2="16" />`],
  published: ["the paper", html`<path class="mark published" d="M10 2 16 8 10 14 4 8z" />`],
};

/** @param {{ name: SignName }} props */
const Sign = ({ name }) => html`
  <span><svg class="dots" width="20" height="16" aria-hidden="true">${SIGNS[name][1]}</svg>${SIGNS[name][0]}</span>
`;

/** The legend of a dot strip. @param {{ signs: SignName[], color: string | undefined }} props */
export const StripKey = ({ signs, color }) => html`
  <p class="strip-key" style=${color && { "--agent": color }}>${signs.map((name) => html`<${Sign} name=${name} />`)}</p>
`;

/**
 * The lines of references, after the colours of agents.
 * @param {{ levels: { kind: string, name: string }[] }} props
 */
export const LevelKey = ({ levels }) => levels.map(({ kind, name }) => html`
  <span>
    <svg class="dots" width="24" height="8" aria-hidden="true">
      <line class=${`mark ${kind}`} x1="0" x2="24" y1="4" y2="4" />
    </svg>${name.toLowerCase()}
  </span>
`);

/**
 * The colours of agents, and what else a chart has.
 * @param {{ agents: string[], children: ComponentChildren }} props
 */
export const AgentKey = ({ agents, children }) => html`
  <p class="strip-key">
    ${agents.map(agentOf).map(({ color, title }) => html`
      <span style=${{ "--agent": color }}><i class="swatch"></i>${title}</span>
    `)}${children}
  </p>
`;
