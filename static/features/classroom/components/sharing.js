// How a server that only this computer reaches is shared, and how a pupil's side is tried on it.
import { copy } from "../../../js/page.js";
import { html } from "../../../js/components/elements.js";

/** The address of a room, as pupils open it. @param {string} address */
const withFlag = (address) => `${address}${address.includes("?") ? "&" : "?"}join`;
const PROXY = "HEXAPODS_PUBLIC_URL=https://hexapods.example";
/** What makes the server reachable for phones: for whom, and what to type. */
const WAYS = [
  ["Phones in the same network", "hexapods serve --share"],
  ["The same, from a copy of the repository", "make run ARGS=--share"],
  ["Behind a proxy, with its address and a secret", `${PROXY} HEXAPODS_TOKEN=YOUR-SECRET hexapods serve`],
];

/** Told where phones cannot come: why, and what to start the server with. */
export const Sharing = () => html`
  <div class="sharing">
    <p><b>Phones cannot come to this server</b>: it listens on this computer alone. To teach a class, stop it (Ctrl-C),
      start it again, and open the link that it prints:</p>
    ${WAYS.map(([title, command]) => html`
      <p key=${command} class="dim">${title}</p>
      <p class="command"><code>${command}</code>
        <button class="quiet compact" aria-label=${`Copy ${command}`}
          onClick=${() => copy(command, "Command copied.")}>Copy</button></p>
    `)}
  </div>
`;

/** The link by which a window is a pupil's, though everybody here may teach. @param {{ address: string }} props */
export const PupilsWindow = ({ address }) => html`
  <div class="sharing">
    <p class="dim">To see it as a pupil does, open this in a private window:</p>
    <p class="command"><code>${withFlag(address)}</code>
      <button class="quiet compact" aria-label="Copy the link for a private window"
        onClick=${() => copy(withFlag(address), "Link copied.")}>Copy</button></p>
  </div>
`;
