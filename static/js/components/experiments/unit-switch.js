// The choice of a unit for distances.
import { html } from "../../html.js";
import { unit, UNITS } from "../../experiments/units.js";
import { Segments } from "../segments.js";

export const UnitSwitch = () => html`
  <${Segments} label="Unit of distances" choices=${UNITS} value=${unit.value} onValue=${(one) => (unit.value = one)} />
`;
