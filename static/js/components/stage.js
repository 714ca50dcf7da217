// The 3D stage in its frame, with labels over it.
import { computed, signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { isPolling } from "../events.js";
import { form } from "../form.js";
import { inMillimetres, t, tenths, translation } from "../format.js";
import { narrative } from "../headline.js";
import {
  aim, clickedCell, clickedNode, closeLegs, directions, drawHere, inspection, isFlat, isProjected, isStill, isTaken,
  legPoints, legsAreOpen, legsOf, picked, places, shownTheme, takeCamera, turnedByHand,
} from "../page.js";
import { isTimedOut } from "../race.js";
import { closeReplay, drawIn, isBuffering, isOwn, plan, playback, replayProblem } from "../player.js";
import { isDecided } from "../on-stage.js";
import { agentOf } from "../settings.js";
import { isAway, scene } from "../store.js";
import { isAtLeast } from "../workspace.js";
import { html } from "./elements.js";
import { Loaded, loadPlan, Slot } from "../features.js";

/** @import { Message } from "../replay-frames.js" */

/** A frame that has not reported the next status for so long is shown as it is. */
const STATUS_TIMEOUT_MS = 12_000;
const PICK_DELAY_MS = 60;

/** Where the chips lie over the picture [px], of which the scene's labels stay clear. */
const covered = signal(/** @type {object[]} */ ([]));
const laneColours = computed(() => (scene.value?.lanes ?? []).map(({ color }) => color).join(" "));

export function Stage() {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const [status, setStatus] = useState("loading");
  // Where much is computed, the picture comes seconds after the client is connected.
  const [isDrawn, setDrawn] = useState(false);
  // The first address has it; later changes are sent to the frame, which must not load again.
  const [address] = useState(() => `viewer/?theme=${shownTheme.peek()}`);

  useFrame(frame, setStatus, setDrawn);
  useEffect(() => {
    if (status === "loading" || isDrawn) return undefined;
    if (status === "lost") return giveUpAfter(() => setStatus("gone"));
    return giveUpAfter(() => setDrawn(true));
  }, [status, isDrawn]);
  // What was picked is of the run that was shown.
  useEffect(() => closeLegs, [scene.value?.run_id]);
  const colours = laneColours.value;
  useEffect(() => {
    const message = {
      type: "hexapods:show", theme: shownTheme.value, lanes: colours.split(" "),
      covered: covered.value, isProjected: isProjected.value, legsOf: legsOf.value,
      words: translation?.plates, mark: translation?.mark, ...directions.value,
    };
    frame.current?.contentWindow?.postMessage(message, location.origin);
  }, [shownTheme.value, status, colours, covered.value, isProjected.value, legsOf.value, directions.value]);

  useEffect(() => {
    const message = { type: "hexapods:inspect", inspection: inspection.value };
    frame.current?.contentWindow?.postMessage(message, location.origin);
  }, [status, inspection.value]);

  const retry = () => {
    setDrawn(false);
    setStatus("loading");
  };
  const awayWords = awayInWords();
  return html`
    <section class=${`stage ${awayWords && !isReplayed() ? "away" : ""}`} aria-label="Stage" data-status=${status}>
      <div class="picture">
        ${isFlat(status)
          ? html`<${Loaded} name="plan" load=${loadPlan} isLost=${status === "gone"} retry=${retry} />`
          : html`<iframe ref=${frame} src=${address} title="The robots on the track, in 3D"></iframe>`}
        ${!isDrawn && !isFlat(status) && html`<${StagePlaceholder} isLost=${status === "lost"} />`}
        ${isStill.value ? html`<${Slot} name="over a still scene" />` : html`<${OverThePlayed} />`}
        ${awayWords && html`
          <p class="away-note" role="status"><span class="spinner" aria-hidden="true"></span>${awayWords}</p>
        `}
      </div>
    </section>
  `;
}

/** @param {() => void} act */
function giveUpAfter(act) {
  const timer = setTimeout(act, STATUS_TIMEOUT_MS);
  return () => clearTimeout(timer);
}

/** What lies over the picture of a run. */
const OverThePlayed = () => html`
  <${StageLabels} />
  ${legsAreOpen.value && html`<${Loaded} name="legs" load=${loadLegs} />`}
  <${StageNotes} />
  <${DirectedCamera} />
  <${ReplayProblem} />
`;

/** The way back for who has turned the picture. */
const DirectedCamera = () => isTaken.value && html`
  <button class="secondary compact directed-camera" onClick=${() => aim("directed")}
    title="Show all robots again, as key C does">Directed camera</button>
`;

/** Whether a replay of this page's own is drawn, which goes on without the server as far as it is loaded. */
const isReplayed = () => isOwn.value && plan.value !== null && !isBuffering.value;

/** What the picture is while the server is away. */
function awayInWords() {
  if (!isAway.value) return "";
  if (isReplayed()) return t("Reconnecting. Your replay plays what is loaded.");
  return isOwn.value ? t("Reconnecting. Your replay waits.") : t("Reconnecting. This is the last picture.");
}

const loadLegs = () => import("./leg-menu.js").then(({ Legs }) => Legs);

/**
 * Take what the frame tells: clicks, places of legs, and its status.
 * @param {{ current: HTMLIFrameElement | null }} frame
 * @param {(change: string | ((now: string) => string)) => void} setStatus
 * @param {(isDrawn: boolean) => void} setDrawn
 */
function useFrame(frame, setStatus, setDrawn) {
  useEffect(() => {
    const send = (/** @type {Message[]} */ messages) =>
      frame.current?.contentWindow?.postMessage({ type: "hexapods:draw", messages }, location.origin);
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    let picking;
    /** @type {Record<string, (data: any) => void>} */
    const takers = {
      "hexapods:click": ({ node, instance }) => {
        if (isStill.peek()) clickedNode.value = { node };
        if (isProjected.peek() || isStill.peek()) return;
        if (isAtLeast("study")) clearTimeout(picking);
        clickedCell.value = { node, instance, run_id: scene.peek()?.run_id ?? null };
      },
      "hexapods:pick": ({ pick }) => {
        // A cell of a foot grid that was clicked is told right after it, and comes first for those who study.
        clearTimeout(picking);
        picking = setTimeout(() => canPick() && (picked.value = pick), PICK_DELAY_MS);
      },
      "hexapods:legs": ({ legs }) => (legPoints.value = legs),
      "hexapods:places": ({ places: now }) => (places.value = now),
      "hexapods:taken": takeCamera,
      "hexapods:touched": () => (turnedByHand.value += 1),
      "hexapods:status": ({ status }) => {
        if (status === "drawn") {
          setDrawn(true);
          return;
        }
        setStatus(status);
        if (status === "lost") setDrawn(false);
        if (status !== "connected") return;
        drawIn(send);
        drawHere.value = (messages) => send(messages);
      },
    };
    const onMessage = (/** @type {MessageEvent} */ { origin, source, data }) => {
      if (origin === location.origin && source === frame.current?.contentWindow) takers[data?.type]?.(data);
    };
    addEventListener("message", onMessage);
    const timer = setTimeout(() => setStatus((now) => (now === "loading" ? "connected" : now)), STATUS_TIMEOUT_MS);
    return () => {
      removeEventListener("message", onMessage);
      clearTimeout(timer);
    };
  }, []);
}

/** Those who try disturb what they click, but not on a page that is projected. */
const canPick = () => isAtLeast("try") && !isProjected.peek() && !isStill.peek();

/** Why the run that a link names cannot be replayed. */
const ReplayProblem = () => replayProblem.value && html`
  <div class="replay-problem" role="alert">
    <p>${replayProblem.value}</p>
    <button class="secondary" onClick=${closeReplay}>Back to the stage</button>
  </div>
`;

// ---- notes over the picture: what ended and how to go on, and what comes next

const loadNotes = () => import("./stage-notes.js").then(({ StageNotes }) => StageNotes);

const hasNotes = () => Boolean(narrative.value.note || playback.value?.announced || isDecided.value);

const StageNotes = () => html`
  <div class="stage-notes" role="group" aria-label="Notes on the shown run">
    ${hasNotes() && html`<${Loaded} name="notes" load=${loadNotes} isQuiet />`}
  </div>
`;

// ---- a drawing of the robots on the start line, shown until the stage has a picture

const LANES_X = [-150, 0, 150];
const LEGS = ["M-16 0-44-14-56 18", "M-10 6-34 0-42 34", "M-6 8-16 12-20 42"];


/** @param {{ x: number, color: string }} props */
const Robot = ({ x, color }) => html`
  <g transform=${`translate(${x} 0)`} style=${{ color }}>
    <ellipse class="shadow" cx="0" cy="40" rx="62" ry="9" />
    ${LEGS.map((d) => html`<path class="limb" d=${d} /><path class="limb" d=${d} transform="scale(-1 1)" />`)}
    <path class="torso" d="M-24-6 -12-16 H12 L24-6 12 12 H-12z" />
  </g>
`;

/** @param {{ isLost: boolean }} props */
function StagePlaceholder({ isLost }) {
  const robots = form.value.lanes.slice(0, LANES_X.length);
  return html`
    <div class="placeholder">
      <svg viewBox="-320 -130 640 260" aria-hidden="true">
        <path class="track" d="M-300 110-90-110M-100 110-30-110M100 110 30-110M300 110 90-110" />
        <path class="track" d="M-270 78H270M-212 18H212M-158-38H158M-118-80H118" />
        <path class="finish" d="M-118-80H118" /><path class="start" d="M-270 78H270" />
        <g transform="translate(0 38)">
          ${robots.map((agent, lane) => html`<${Robot} x=${LANES_X[lane]} color=${agentOf(agent).color} />`)}
        </g>
      </svg>
      ${isLost ? html`<p>The 3D graphics were interrupted. The picture comes again…</p>`
        : html`<p>Loading the picture…</p>`}
    </div>
  `;
}

// ---- labels: the run, its conditions and speed, the colours of the foot grid

/** @param {number} low @param {number} high */
const gridColours = (low, high) => t(
  "Colours of the foot grid: from {low}, dark, to {high}, light; grey was never tried",
  { low: inMillimetres(low), high: inMillimetres(high) },
);

function StageLabels() {
  const values = scene.value?.action_values ?? null;
  const labels = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => followCovered(/** @type {HTMLElement} */ (labels.current?.parentElement)), []);
  return html`
    <div class="labels" role="group" aria-label="Labels of the picture" ref=${labels}>
      ${isPolling.value && html`
        <p class="chip held-back" role="status">This network holds live updates back: asking every 2 s</p>
      `}
      <${SceneChips} />
      ${values && hasReadableGrid() && html`
        <p class="chip legend" aria-label=${gridColours(values.low, values.high)}>
          ${tenths(values.low)}<span class="ramp" aria-hidden="true"></span>${inMillimetres(values.high)}
          <i aria-hidden="true"></i>never tried
        </p>
      `}
    </div>
  `;
}

/** Whether the cells of the foot grid are large enough to be read: not where a race has all its robots in view. */
const hasReadableGrid = () => ["practice", "close", null].includes(directions.value.shot)
  && (isAtLeast("try") || !isTimedOut.value);

/** What lies over the picture, and stays there. */
const COVERING = ".chip, .stage-notes > *, .directed-camera, .away-note";

/**
 * Measure what lies over the picture whenever that or the picture's size has changed.
 * @param {HTMLElement} picture
 */
function followCovered(picture) {
  /** @type {number | undefined} */
  let due;
  const measure = () => {
    due = undefined;
    const frame = picture.getBoundingClientRect();
    const boxes = [...picture.querySelectorAll(COVERING)].map((element) => element.getBoundingClientRect())
      .filter(({ width }) => width > 0)
      .map(({ left, top, right, bottom }) => ({
        left: left - frame.left, top: top - frame.top, right: right - frame.left, bottom: bottom - frame.top,
      }));
    if (JSON.stringify(boxes) !== JSON.stringify(covered.peek())) covered.value = boxes;
  };
  // Before the browser paints it would be laid out twice.
  const soon = () => (due ??= requestAnimationFrame(measure));
  const [ofSize, ofContent] = [new ResizeObserver(soon), new MutationObserver(soon)];
  ofSize.observe(picture);
  ofContent.observe(picture, { childList: true, subtree: true, characterData: true });
  soon();
  return () => [ofSize, ofContent].forEach((observer) => observer.disconnect());
}

/** Titles of chips that have one. @type {Record<string, string>} */
const CHIP_TITLES = { speed: t("Times real time") };

const SceneChips = () => html`
  <div class="chips">
    ${narrative.value.chips.map(({ kind, words }) => (kind === "strong"
      ? html`<p key="run" class="chip strong" role="group" aria-label="Shown run">${words}</p>`
      : html`<p class=${`chip ${kind}`} title=${CHIP_TITLES[kind]}>${words}</p>`))}
  </div>
`;
