// What of the guide is named in the help.
import { html } from "../../js/components/elements.js";

export const Reading = () => html`
  <li><a href="guide/page">The guide</a>: this page, a tutorial, how-tos, and how each part works</li>
  <li><a href="guide/experiments">The paper</a>, <i>Racing Hexapods: Q-learning vs Uninformed Search</i>, repeated
    over thirty seeds</li>
  <li><a href="guide/architecture">The source</a>: where each part is, and where to add one</li>
`;
