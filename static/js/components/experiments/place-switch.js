// Which robot, and what it goes by; nothing to choose where there is one.
import { html } from "../../html.js";
import { OBSERVATIONS, observationTitle, robotTitle } from "../../experiments/titles.js";
import { options } from "../../store.js";
import { Segments } from "../segments.js";

const titleOf = (place, places) => {
  const differs = (field) => new Set(places.map((one) => one[field])).size > 1;
  return [
    observationTitle(place.observation),
    differs("robot") && robotTitle(place.robot).toLowerCase(),
    differs("divisions") && `${place.divisions} × ${place.divisions}`,
    differs("grid_side_m") && `${place.grid_side_m} m`,
  ].filter(Boolean).join(", ");
};

const robotWords = (robot) => options.value?.robots?.find(({ name }) => name === robot)?.description;

/** What the reading of the state that is shown means. */
export const PlaceWords = ({ place }) => html`
  <p class="dim">${[`${observationTitle(place.observation)}: ${OBSERVATIONS[place.observation]?.[1]}.`, robotWords(place.robot)].filter(Boolean).join(" ")}</p>
`;

export const PlaceSwitch = ({ places, value, onValue }) => places.length > 1 && html`
  <${Segments} label="Where it was tried" choices=${places.map((one) => [one.key, titleOf(one, places)])} value=${value} onValue=${onValue} />
`;
