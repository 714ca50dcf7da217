// The choice of a place: observation, robot and foot grid. Hidden where there is only one.
import { html } from "../../html.js";
import { sentence } from "../../format.js";
import { options } from "../../store.js";
import { observationTitle, robotTitle } from "../../titles.js";
import { Segments } from "../segments.js";

const titleOf = (place, places) => {
  const differs = (field) => new Set(places.map((one) => one[field])).size > 1;
  const parts = [
    observationTitle(place.observation),
    differs("robot") && robotTitle(place.robot).toLowerCase(),
    differs("divisions") && `${place.divisions} × ${place.divisions}`,
    differs("grid_side_m") && `${place.grid_side_m} m`,
  ];
  return sentence(parts.filter(Boolean).join(", "));
};

const descriptionOf = (list, name) => list?.find((one) => one.name === name)?.description ?? "";

/** The observation and the robot of a place, explained. */
export function PlaceWords({ place: { observation, robot } }) {
  const about = descriptionOf(options.value?.observations, observation);
  const words = [`${sentence(observationTitle(observation))}:`, about, descriptionOf(options.value?.robots, robot)];
  return html`<p class="dim">${words.filter(Boolean).join(" ")}</p>`;
}

export function PlaceSwitch({ places, value, onValue }) {
  if (places.length < 2) return null;
  const choices = places.map((one) => [one.key, titleOf(one, places)]);
  return html`<${Segments} label="Place" choices=${choices} value=${value} onValue=${onValue} />`;
}
