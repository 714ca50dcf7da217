// Distance over race time; flat parts are thinking. It ends where the picture is.
import uPlot from "uplot";
import { useMemo } from "preact/hooks";
import { metres } from "../format.js";
import { html } from "../html.js";
import { agentOf, clock, raceInView } from "../selectors.js";
import { distanceAt, shownTime, timeline } from "../timeline.js";
import { AsTable } from "./as-table.js";
import { Empty } from "./empty.js";
import { Plot } from "./plot.js";

const FINISH_LINE_M = 0.45;
const CLOCKS = {
  paper: "it costs what it did in the paper",
  wall: "it costs the time it took on this computer",
  free: "it costs nothing under this clock",
};

export function RaceChart() {
  const known = timeline.value;
  const time = shownTime.value;
  const isOn = known && time !== null && known.lanes.some(({ points }) => points.length > 1);
  return html`
    <section class="panel chart" aria-labelledby="race-title">
      <h2 id="race-title">The race</h2>
      <p class="dim">Flat parts are thinking: ${CLOCKS[clock.value] ?? clock.value}</p>
      ${isOn
        ? html`<${Lines} known=${known} time=${time} />`
        : html`<${Empty} shape="lines" words=${raceInView.value ? "The lines start when the robots do. Flat parts are thinking." : "Each robot draws a line here as it walks. Flat parts are thinking."} />`}
    </section>
  `;
}

function Lines({ known, time }) {
  const longest = Math.max(...known.lanes.map(({ total_s }) => total_s));
  const until = Math.min(time, longest);
  const lanes = known.lanes.map((lane) => ({ ...lane, ...agentOf(lane.agent), shown: clipped(lane.points, until) }));
  const data = useMemo(
    () => uPlot.join(lanes.map(({ shown }) => [shown.map(([t]) => t), shown.map(([, d]) => d)])),
    [known, until],
  );
  const line = known.finish_line_m ?? FINISH_LINE_M;
  const first = known.first_finish_s;
  const end = Math.max(until, first ? Math.min(1.3 * first, longest) : Math.min(longest, 20), 1);
  const far = Math.max(line, ...lanes.map(({ shown }) => shown.at(-1)[1]));
  const labels = lanes.map(({ title, color, shown }) => ({ text: title, color, x: shown.at(-1)[0], y: shown.at(-1)[1] }));
  // Where no line passes: at first on the left, later behind those who have arrived.
  const share = first && until > 1.5 * first ? 0.55 : 0;
  const marks = [{ y: line, color: "--finish", text: "finish line", share }];
  if (first && until >= first) marks.push({ x: first, color: "--dim", dash: [2, 3], text: "first is done" });
  const said = `The race after ${Math.round(until)} seconds: ${lanes.map(({ title, shown }) => `${title} ${metres(shown.at(-1)[1])}`).join(", ")}.`;
  return html`
    <${Plot} label=${said} data=${data} series=${lanes.map(({ color }) => ({ color }))} labels=${labels} marks=${marks}
      x=${{ min: 0, max: end, unit: "race time, s" }} y=${{ min: 0, max: 1.16 * far }} />
    <${AsTable} caption=${said} columns=${["Race time", ...lanes.map(({ title }) => title)]} rows=${rowsOf(lanes, until)} />
  `;
}

/** The line up to a moment, with its end in the middle of a motion if need be. */
function clipped(points, until) {
  const before = points.filter(([t]) => t <= until);
  if (!before.length) return [[0, 0]];
  return before.length < points.length ? [...before, [until, distanceAt(points, until)]] : before;
}

/** Ten moments are enough for a table. */
function rowsOf(lanes, until) {
  const step = Math.max(1, Math.ceil(until / 10));
  const moments = Array.from({ length: Math.floor(until / step) + 1 }, (_, n) => n * step);
  return moments.map((t) => [`${t} s`, ...lanes.map(({ points }) => metres(distanceAt(points, t)))]);
}
