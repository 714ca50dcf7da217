// Plays a replay out of the file that it is in, without a server. hexapods/exports/replay_page.py puts it there, with
// the modules that it imports, the frames of the run and viser's client. The interface is described in docs/exports.md.
import { unpack } from "../replay-frames.js";
import { commandsIn, DIRECTED, LEADER } from "./commands.js";
import { followParent } from "./embedding.js";
import { clockOf, Player } from "./replay-player.js";
import { ViewFrame } from "./view-frame.js";

/** @import { RecordedReplay } from "./replay-player.js" */

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16];
const WITHOUT_WEBGL = "This browser draws no 3D here: the picture is of the end of the run.";

/** @param {string} id */
const textOf = (id) => document.getElementById(id)?.textContent ?? null;

/** @type {RecordedReplay} */
const replay = JSON.parse(/** @type {string} */ (textOf("replay")));
const poster = /** @type {HTMLElement} */ (document.querySelector(".poster"));
poster.querySelector("figcaption")?.remove();

const view = new ViewFrame(JSON.parse(/** @type {string} */ (textOf("viewer"))).page, poster);
const player = new Player(replay, async (id) => {
  const text = textOf(id);
  return text === null ? null : await unpack(text);
}, view);
Object.assign(window, { hexapods: player });
const { commands, errors } = commandsIn(location.search, player.limits);
commands.forEach((command) => player.obey(command));
followParent(player, errors);

// ---- the controls

/** @type {(tag: string, properties?: object, ...children: (Node | string)[]) => any} */
const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

const play = make("button", { type: "button", onclick: () => (player.paused ? player.play() : player.pause()) });
const stepButton = (/** @type {number} */ direction, /** @type {string} */ label, /** @type {string} */ sign) =>
  make("button", { type: "button", ariaLabel: label, title: label, onclick: () => player.step(direction) }, sign);
const directed = make("button",
  { type: "button", className: "directed", hidden: true, onclick: () => player.setCamera({ follow: DIRECTED }) },
  "Directed camera");
const slider = make("input", { type: "range", min: "0", step: "any", ariaLabel: "Moment of the run" });
slider.addEventListener("input", () => player.seek(slider.valueAsNumber));
const position = make("output", { className: "clock" });
const speeds = make("select", { ariaLabel: "Speed", onchange: () => player.setSpeed(Number(speeds.value)) },
  ...SPEEDS.map((times) => make("option", { value: String(times) }, `× ${times}`)));
const clocks = make("select",
  { ariaLabel: "Clock", hidden: replay.plans.length < 2, onchange: () => player.setClock(clocks.value) },
  ...replay.plans.map((plan) => make("option", { value: clockOf(plan) }, replay.clocks[clockOf(plan)])));
const bar = make("div", { className: "player" }, play,
  stepButton(-1, "One robot step back", "◂"), stepButton(1, "One robot step on", "▸"), slider, position, clocks, speeds,
  directed);
const notes = make("span", { className: "notes" });
const heading = make("div", { className: "replay-title" }, make("b", {}, replay.title), " ", notes,
  ...errors.map((error) => make("span", { className: "error", role: "alert" }, error)));

function showState() {
  const label = player.paused ? "Play" : "Pause";
  Object.assign(play, { textContent: player.paused ? "▶" : "❚❚", ariaLabel: label, title: label });
  Object.assign(slider, { max: String(player.duration_s), value: String(player.time_s) });
  position.textContent = `${player.time_s.toFixed(1)} of ${player.duration_s.toFixed(1)} s`;
  if (Number(speeds.value) !== player.speed) speeds.value = String(player.speed);
  if (clocks.value !== player.clock) clocks.value = player.clock;
  notes.textContent = [...replay.notes, `Times: ${replay.clocks[player.clock]}.`].join(" ");
  directed.hidden = !player.isTaken;
}

/** Keep the scene's labels clear of the controls. */
function showCovered() {
  view.show({ covered: [bar, heading].map((element) => element.getBoundingClientRect().toJSON()) });
}

player.addEventListener("timeupdate", showState);
player.addEventListener("camera", showState);
view.addEventListener("taken", () => player.setCamera({ follow: LEADER }));
view.addEventListener("unavailable", () => {
  heading.append(make("span", { role: "status" }, WITHOUT_WEBGL));
  document.documentElement.dataset.view = "none";
});
addEventListener("resize", showCovered);
addEventListener("pointerdown", () => view.use());

/** @type {(key: string) => void} */
function press(key) {
  view.use();
  if (key === " ") play.click();
  else if (key === ",") player.step(-1);
  else if (key === ".") player.step(1);
  else if (key === "c") player.setCamera({ follow: DIRECTED });
  else if (key === "v") player.nextAngle();
}
view.addEventListener("key", (event) => press(/** @type {CustomEvent<string>} */ (event).detail));
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target instanceof HTMLButtonElement) return;
  press(event.key);
});

// ---- the theme: of the address, or of the system

const theme = new URLSearchParams(location.search).get("theme");
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const showTheme = () => {
  const system = prefersDark.matches ? "dark" : "light";
  const shown = theme === "light" || theme === "dark" ? theme : system;
  document.documentElement.dataset.theme = shown;
  view.show({ theme: shown });
};
prefersDark.addEventListener("change", showTheme);
showTheme();

document.body.append(heading, bar);
showState();
showCovered();
await player.open();
player.dispatchEvent(new Event("ready"));
