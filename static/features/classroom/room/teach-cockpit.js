// The teacher's part of a card on which the class teaches: let them begin, and end it.
import { html } from "../../../js/components/elements.js";
import { startTeaching, stopTeaching } from "../api.js";
import { makeRequests } from "../../../js/requests.js";
import { code } from "./room.js";
import { countsOf, refreshTeaching, teaching } from "./teaching.js";

const { busy, failures, perform } = makeRequests();

const begin = () => perform("teach", async () => {
  teaching.value = await startTeaching(code);
});
const end = () => perform("teach", async () => {
  await stopTeaching(code);
  await refreshTeaching();
});

/** @param {{ isOver: boolean }} props */
export function TeachInCockpit({ isOver }) {
  const now = teaching.value;
  if (now === null) return null;
  const isOn = now.state === "teaching" || now.state === "frozen";
  const { praised, rebuked } = countsOf(now.presses);
  return html`
    <div class="row deeds-of-all">
      <button class=${isOn ? "secondary" : "primary"} disabled=${isOver || busy.value.teach}
        onClick=${isOn ? end : begin}>
        ${isOn ? "End the teaching" : now.state === "ended" ? "Let them teach again" : "Let them teach"}
      </button>
      <p class="dim" role="status">${praised} praised, ${rebuked} rebuked, of ${now.steps} steps</p>
    </div>
    ${failures.value.teach && html`<p class="bad" role="alert">${failures.value.teach}</p>`}
  `;
}
