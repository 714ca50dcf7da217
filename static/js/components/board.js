// The board: the lanes of the race with ranks, distances as bars and times, the same race by each clock, its curve.
import { setStage } from "../actions.js";
import { disturbancesOf, inTime, joinedBySteps } from "../disturbances.js";
import { form, raceBody } from "../form.js";
import { clockTime, count, decision, metres, nameOf, sentence, t, whole } from "../format.js";
import { narrative, whyMarching } from "../headline.js";
import { isLoser, isOver, isTimedOut, standings, timeline } from "../race.js";
import { canPlay, clock, originalRace, raceInView, raceScene, shownRun } from "../on-stage.js";
import { page } from "../page-state.js";
import { aim, isProjected } from "../page.js";
import { distanceOf, earlyEndOf } from "../narrative/moment.js";
import { percent, shareOf } from "../scale.js";
import { isActive, simulatedPerDecision } from "../selectors.js";
import { agentOf, laneTitle, learns } from "../settings.js";
import { runs, scene, served } from "../store.js";
import { choicesOf, clockTitle, flatParts, planningModelTitle } from "../titles.js";
import { practisedSteps } from "../training.js";
import { isAtLeast } from "../workspace.js";
import { html, Icon } from "./elements.js";
import { Loaded, Slot } from "../features.js";
import { LearningChart, RaceChart } from "./run-charts.js";

/** @import { Standing } from "../race.js" */
/** @import { Changed, Clock, LaneConfig, Run } from "../types.js" */

const loadFiles = () => import("./run-files.js").then(({ RunFiles }) => RunFiles);
export const Board = () => (standings.value === null && shownRun.value?.kind === "training"
  ? html`<${PracticeBoard} />` : html`<${RaceBoard} />`);

/** Of a practice the curve comes first: it is what happens, and the next race is still to come. */
const PracticeBoard = () => html`
  <section class="board-tab" aria-label="Scoreboard">
    <${LearningChart} />
    ${isAtLeast("try") && html`<${Choices} />`}
    <${StartList} />
    ${isAtLeast("study") && html`<${Loaded} name="downloads" load=${loadFiles} />`}
  </section>
`;

function RaceBoard() {
  const rows = standings.value;
  // Where the page is projected the lanes have the room: a chart has small type.
  const hasChart = !rows || !isProjected.value;
  return html`
    <section class="board-tab" aria-label="Scoreboard">
      ${rows ? html`<${Standings} rows=${rows} />` : html`<${StartList} />`}
      ${isAtLeast("try") && html`<${Choices} />`}
      ${rows && isTimedOut.value && html`<${ByEachClock} rows=${rows} />`}
      ${hasChart && html`<${RaceChart} />`}
      ${rows && isToldAll() && html`
        <p class="dim fine">${narrative.value.rule}${
          isAtLeast("try") ? ` ${flatParts(clock.value)}` : ""}</p>
      `}
      ${isAtLeast("study") && html`<${Loaded} name="downloads" load=${loadFiles} />`}
    </section>
  `;
}

/** Whether small print is shown: who watches a race that is over reads its result, and has read it before. */
const isToldAll = () => !isProjected.value && (isAtLeast("try") || !isTimedOut.value);
// ---- the lanes

/** @param {{ rows: Standing[] }} props */
function Standings({ rows }) {
  const finish_m = timeline.value?.finish_line_m ?? null;
  const ends = {
    elapsed_s: Math.max(...rows.map((row) => row.elapsed_s ?? 0), 1e-9),
    distance_m: Math.max(finish_m ?? 0, ...rows.map((row) => distanceOf(row)), 1e-9),
    finish_m,
  };
  const isDeep = isAtLeast("study");
  return html`
    ${!isProjected.value && html`<${BranchWords} />`}
    <table class="board">
      <caption class="sr-only">Standings (${clockTitle(clock.value)})</caption>
      <thead class=${isDeep ? "" : "sr-only"}>
        <tr>
          <th scope="col"><span class="sr-only">Rank</span></th>
          <th scope="col"><span class="sr-only">Agent</span></th>
          <th scope="col" title="Distance at time-out: when the first lane has used its steps">${distanceTitle()}</th>
          ${isDeep && html`<th scope="col" title="Distance after all of its own steps">Total</th>`}
          ${isAtLeast("try") && html`
            <th scope="col" title="Measured time of one decision, on average">Decision</th>
          `}
          ${isDeep && html`<th scope="col" title="Transitions simulated in order to decide">Simulated</th>`}
        </tr>
      </thead>
      ${rows.map((row) => html`<${Lane} key=${row.lane} row=${row} ends=${ends} />`)}
      ${isDeep && html`<${BestKnown} />`}
    </table>
    ${isToldAll() && html`<p class="dim fine">Bar: distance. Thin: time, hatched while thinking.</p>`}
  `;
}

/** Disturbances of the race, and the race of which it is a branch. */
function BranchWords() {
  const { value: race } = raceInView;
  const branch = race?.config.branch_from;
  const happens = joinedBySteps(race ? disturbancesOf(race) : []).map(inTime).join("; ");
  if (!branch) return happens && html`<p class="happened">${sentence(happens)}.</p>`;
  const original = originalRace.value;
  const title = (original && nameOf(original)) || t("another race");
  return html`
    <p class="happened">
      The same as <a href=${`#runs?search=${branch.race_id}`}>${title}</a> before step ${branch.step + 1}.
      ${happens && ` ${sentence(happens)}.`}
    </p>
  `;
}

function distanceTitle() {
  if (isTimedOut.value) return html`<span class="sr-only">Distance${" "}</span>At time-out`;
  return ["halting", "left off"].includes(narrative.value.state) ? t("Reached") : t("Now");
}

function BestKnown() {
  const best_m = raceInView.value?.best_known_m ?? null;
  return best_m !== null && html`
    <tfoot>
      <tr title=${served().help.best_known}>
        <td></td><th scope="row" class="agent">Best known</th><td></td><td>${metres(best_m)}</td><td></td><td></td>
      </tr>
    </tfoot>
  `;
}

/**
 * What the bars of all lanes are drawn against: the longest time [s], the finish line where it is known, and the
 * farther of that and the first lane [m].
 * @typedef {{ elapsed_s: number, distance_m: number, finish_m: number | null }} Ends
 */

/** @param {{ row: Standing, ends: Ends }} props */
function Lane({ row, ends }) {
  const isDeep = isAtLeast("study");
  return html`
    <tbody class=${row.isThinking ? "thinking" : ""} style=${{ "--agent": row.color }} aria-label=${row.title}>
      <tr>
        <td class="rank">${row.rank ?? "–"}</td>
        <th scope="row" class="agent">
          <div>
            <${LaneName} row=${row} />
            ${!isDeep && isToldAll() && html`<span class="dim note">${noteOf(row)}</span>`}
          </div>
        </th>
        <td class="big">${metres(row.finished_m ?? row.distance_m)}</td>
        ${isDeep && html`
          <td class=${row.isDone ? "" : "dim"}>
            ${isTimedOut.value ? metres(row.total_m ?? distanceSoFar(row)) : "–"}
          </td>
        `}
        ${isAtLeast("try") && html`<td class="dim">${decision(row.decision_s)}</td>`}
        ${isDeep && html`<td>${whole(row.simulated)}</td>`}
      </tr>
      <tr class="under">
        <td></td>
        <td colspan="5">
          <${Bars} row=${row} ends=${ends} />
          ${linesBelow(row).map(([kind, words]) => html`<p class=${kind}>${words}</p>`)}
          ${isLoser(row.lane) && isAtLeast("try") && !isProjected.value && html`
            <${Slot} name="lane that loses" row=${row} />
          `}
        </td>
      </tr>
    </tbody>
  `;
}

/** The lane's robot, which those who try follow with a press. @param {{ row: Standing }} props */
function LaneName({ row }) {
  const name = html`<span class="swatch"></span>${row.title}`;
  if (!isAtLeast("try") || isProjected.value) return html`<span>${name}</span>`;
  const target = String(row.lane + 1);
  const isFollowed = page.camera.value === target;
  return html`
    <button class="lane-name" aria-pressed=${isFollowed ? "true" : "false"}
      title=${isFollowed ? t("All robots again") : t("Follow with the camera, as key {target} does", { target })}
      onClick=${() => aim(isFollowed ? "directed" : target)}>${name}</button>
  `;
}

/** How it decides, in a few words. @param {Standing} row */
function noteOf({ agent, training_id }) {
  if (learns(agent)) {
    const training = runs.value.get(training_id ?? "");
    return training ? inPractice(training) : t("learns as it races");
  }
  const { steps_ahead } = agentOf(agent);
  const config = raceInView.value?.config;
  const moves = steps_ahead && config ? simulatedPerDecision(steps_ahead, config) : 0;
  return moves ? t("{moves} {moves|move|moves} a step", { moves }) : "";
}

/** @param {Run} run */
const inPractice = (run) => t("{steps} {steps|step|steps} of practice", { steps: practisedSteps(run) });

/** Whether a lane's activity is told: what is unusual always, the rest where there is room. @param {Standing} row */
const isActivityTold = (row) =>
  isAtLeast("study") || row.failure || row.isHalted || (row.isThinking && !isOver.value && isAtLeast("try"));

/** What is told below the strip, each with its style. @param {Standing} row @returns {[string, unknown][]} */
function linesBelow(row) {
  const isDeep = isAtLeast("study");
  const lines = /** @type {[string, unknown][]} */ ([]);
  if (isActivityTold(row)) {
    lines.push(["dim", html`${row.hasCrossed && isDeep && html`<${Icon} name="flag" />`}${activityOf(row)}`]);
  }
  if (postureOf(row)) lines.push(["happened", postureOf(row)]);
  if (row.original && isAtLeast("try")) {
    const { finished_m, total_m } = row.original;
    const far = { finished: metres(finished_m), total: metres(total_m) };
    lines.push(["dim", t("Original: {finished} at time-out, total {total}", far)]);
  }
  const model = row.plans_with && planningModelTitle(row.plans_with);
  if (isDeep && model) lines.push(["dim", t("plans with the {model}", { model })]);
  if (row.isMarching) {
    lines.push(["marching", html`<b>${t("Marching on the spot")}${isAtLeast("try") ? ": " : "."}</b>${
      isAtLeast("try") ? whyMarching(row.agent) : ""}`]);
  }
  return lines;
}

/** Distance of a lane that walks on after time-out; none once the show has ended there. @param {Standing} row */
const distanceSoFar = (row) => (isOver.value ? null : row.distance_m);

/** The distance of a lane as a bar, with the finish line, and its time as a thin line. */
/** @param {{ row: Standing, ends: Ends }} props */
function Bars({ row, ends: { elapsed_s, distance_m, finish_m } }) {
  const { walked, thought } = row.spent;
  const values = { distance: metres(distanceOf(row)), finish: metres(finish_m) };
  const reached = finish_m === null ? values.distance : t("{distance} of {finish} to the finish line", values);
  const spent = { walked: clockTime(walked), thought: clockTime(thought) };
  const times = t("walking {walked}, thinking {thought} (minutes:seconds)", spent);
  return html`
    <div class="bars" role="img" aria-label=${`${reached}; ${times}`}>
      <div class="distance-bar">
        <i style=${{ width: percent(shareOf(distanceOf(row), 0, distance_m)) }}></i>
        ${finish_m !== null && html`<b style=${{ left: percent(shareOf(finish_m, 0, distance_m)) }}></b>`}
      </div>
      <div class="time-line">
        <i class="walked" style=${{ width: percent(shareOf(walked, 0, elapsed_s)) }}></i>
        <i class="thought" style=${{ width: percent(shareOf(thought, 0, elapsed_s)) }}></i>
      </div>
    </div>
  `;
}

/** A robot that has turned less is said to walk straight [°]. */
const MIN_TURN_DEG = 20;

/** Whether it fell or turned. @param {Standing} standing */
function postureOf({ fell_at_step, heading_deg }) {
  const fell = typeof fell_at_step === "number" && t("fell at step {step}", { step: fell_at_step + 1 });
  const turn = heading_deg ?? 0;
  const angle = Math.round(Math.abs(turn));
  const turned = angle > MIN_TURN_DEG &&
    (turn > 0 ? t("turned {angle}° left", { angle }) : t("turned {angle}° right", { angle }));
  return sentence([fell, turned].filter(Boolean).join(", "));
}

/** @param {Standing} row */
function activityOf(row) {
  if (row.failure) return t("Stopped: {reason}", { reason: row.failure });
  if (row.isDone) {
    const steps = count(row.steps, "step");
    const used = { steps, time: clockTime(row.elapsed_s ?? 0) };
    if (row.hasCrossed) return t("{steps} in {time}, crossed the finish line", used);
    return row.elapsed_s ? t("{steps} in {time}", used) : steps;
  }
  const { step, steps } = row;
  const end = earlyEndOf(raceInView.value)?.word ?? t("Stopped");
  if (row.isHalted) return t("{end} at step {step}", { end, step });
  if (isOver.value && step) return t("Step {step} of {steps} at time-out", { step, steps });
  if (row.isThinking) {
    const values = { step, steps, futures: row.futures, total: row.futuresTotal };
    return t("Step {step} of {steps}, thinking: {futures} of {total} simulated", values);
  }
  return step ? t("Step {step} of {steps}", { step, steps }) : agentSummary(row.agent, row.training_id);
}

/**
 * Decision rule of an agent, in a few words.
 * @param {string} agent
 * @param {string | null | undefined} trainingId
 */
function agentSummary(agent, trainingId) {
  if (learns(agent)) {
    const training = runs.value.get(trainingId ?? "");
    return training
      ? t("{practice}, then looks up its table", { practice: inPractice(training) })
      : raceInView.value ? t("Learns while it races") : t("Practises, then looks up its table");
  }
  const { description, steps_ahead } = agentOf(agent);
  if (!steps_ahead) return description;
  const simulated = simulatedPerDecision(steps_ahead, raceInView.value?.config ?? form.value);
  return t("Simulates {moves} {moves|move|moves} before each step", { moves: simulated });
}

// ---- before the race: the lanes

function StartList() {
  const race = raceInView.value;
  if (!race && ["loading", "lost"].includes(narrative.value.state)) {
    return html`<p class="dim" role="status">${narrative.value.board}</p>`;
  }
  /** @type {LaneConfig[]} */
  const lanes = race?.config?.lanes ?? raceBody().lanes;
  return html`
    <p class="dim">${narrative.value.board}</p>
    <ul class="start-list" aria-label="Lanes of the race">
      ${lanes.map((lane) => html`
        <li style=${{ "--agent": agentOf(lane.agent).color }}>
          <span class="swatch"></span><b>${laneTitle(lane)}</b>
          <span class="dim">${agentSummary(lane.agent, lane.training_id)}</span>
        </li>
      `)}
    </ul>
    ${raceScene.value && isActive(race) && html`<p class="dim">On the start line.</p>`}
  `;
}

// ---- the clock and the camera

const Choices = () => html`
  <div class="board-choices">
    ${canPlay.value && raceInView.value && html`<${ClockChoice} />`}
    <${Follow} />
  </div>
`;

function ClockChoice() {
  const about = served().clocks.find(({ name }) => name === clock.value)?.description ?? "";
  const whose = page.run.value === null ? `${t("For every page.")} ` : "";
  /** @param {Changed} event */
  const onChange = async ({ target }) => {
    await setStage({ clock: /** @type {Clock} */ (target.value) });
    // A choice that was refused is undone.
    target.value = clock.value;
  };
  return html`
    <label class="choice" title=${`${whose}${sentence(clockTitle(clock.value))}. ${about}`}>
      <span class="sr-only">Clock</span>
      <select name="clock" onChange=${onChange}>
        ${choicesOf(served().clocks, clockTitle).map(([choice, words]) => html`
          <option value=${choice} selected=${choice === clock.value}>${words}</option>
        `)}
      </select>
    </label>
  `;
}

function Follow() {
  const lanes = scene.value?.lanes ?? shownRun.value?.config?.lanes ?? [];
  const robots = lanes.map((lane, n) =>
    [String(n + 1), t("Follow {robot}", { robot: "name" in lane ? lane.name : agentOf(lane.agent).title })]);
  const choices = [["directed", t("All robots")], ...robots, ["free", t("Free camera")]];
  const target = page.camera.value;
  if (!choices.some(([choice]) => choice === target)) choices.push([target, t("Follow lane {lane}", { lane: target })]);
  return html`
    <label class="choice" title="What your camera shows; keys 1 to 8 for a robot, C for all, 0 for a free camera">
      <span class="sr-only">Follow</span>
      <select name="follow" onChange=${(/** @type {Changed} */ event) => aim(event.target.value)}>
        ${choices.map(([choice, words]) => html`
          <option value=${choice} selected=${choice === target}>${words}</option>
        `)}
      </select>
    </label>
  `;
}

// ---- the same race by each clock, once it is ranked

/** @type {Clock[]} */
const CLOCKS = ["paper", "wall", "free"];

/** @param {{ rows: Standing[] }} props */
function ByEachClock({ rows }) {
  const race = raceInView.value;
  const lanes = race?.result?.lanes;
  if (!lanes || isActive(race) || rows.length < 2) return null;
  const shown = rows.map(({ lane, title }) => ({ title, clocks: lanes[lane].clocks }));
  return html`
    <table class="by-clock">
      <caption>The same race by each clock</caption>
      <thead><tr><td></td>${shown.map(({ title }) => html`<th scope="col">${title}</th>`)}</tr></thead>
      <tbody>
        ${CLOCKS.map((name) => html`
          <tr class=${name === clock.value ? "chosen" : ""}>
            <th scope="row">${sentence(clockTitle(name))}</th>
            ${shown.map(({ clocks }) => html`
              <td>${clocks[name].rank === 1
                ? html`<b>${metres(clocks[name].finished_distance_m)}</b>`
                : metres(clocks[name].finished_distance_m)}</td>
            `)}
          </tr>
        `)}
      </tbody>
    </table>
  `;
}
