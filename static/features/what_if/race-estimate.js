// How long the practice and the race of the form take, above the button that starts them.
import { EstimateNote, html } from "../../js/components/elements.js";
import { raceEstimate } from "./estimate.js";

export const RaceEstimate = () => html`<${EstimateNote} words=${raceEstimate} />`;
