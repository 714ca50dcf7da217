// The 3D view of a room's page: a replay of the own run, or the room's stage with the run in the spotlight.
import { computed, effect, signal, untracked } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { t, translation } from "../../../js/format.js";
import { noteWatched } from "../api.js";
import { html, Icon } from "../../../js/components/elements.js";
import { Loaded, loadPlan } from "../../../js/features.js";
import { page } from "../../../js/page-state.js";
import { aim, directions, isFlat, isTaken, shownTheme, takeCamera } from "../../../js/page.js";
import { isShownToEnd } from "../../../js/narrative/moment.js";
import { connection, isAway, scene } from "../../../js/store.js";
import {
  closeReplay, drawIn, endTime, followPlayer, isBuffering, openReplay, playback, playReplay, plan, position,
  replayProblem, setReplaySpeed,
} from "../../../js/player.js";
import { laneNames } from "./lane-names.js";
import { arrived, code, isProjector, isTeaching, ownRunId, replayed, room, toReplay } from "./room.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Message } from "../../../js/replay-frames.js" */

/** A practice is long, and its steps are much alike. */
const SPEEDS = { training: 8, race: 2 };

/** Show the stage on a projector, and on phones that teach; on others the own run as soon as it has a step. */
export function followPicture() {
  followPlayer({ ofStage: () => isProjector || isTeaching.value });
  if (!isProjector) followOwnRun();
}

/** Replay the own run, and that of the next card after it. */
function followOwnRun() {
  effect(() => {
    const id = replayed.value;
    const isThere = isShownToEnd(scene.value, id) || replayProblem.value !== null;
    if (id !== null && isThere && !arrived.peek().has(id)) arrived.value = new Set(arrived.peek()).add(id);
  });
  effect(() => {
    const id = ownRunId.value;
    // Told again after each break, as a server that was started anew has forgotten it.
    if (connection.value !== "live" || id === null || !arrived.value.has(id)) return;
    untracked(() => noteWatched(code, id)).catch(() => {});
  });
  effect(() => {
    const id = replayed.value;
    if (id === page.run.peek()) return;
    if (id === null) {
      closeReplay();
      return;
    }
    setReplaySpeed(/** @type {Record<string, number>} */ (SPEEDS)[toReplay.peek()?.kind ?? "race"] ?? 2);
    openReplay(id);
  });
}

/** Size of the labels in the picture on a projector, against the type around it. */
const LABEL_EM = 0.75;
/** Size of the type around this page's frame, if it is in one [px]; null else. @type {Signal<number | null>} */
export const typeAround = signal(null);
/** After so long without 3D graphics there is a plan of the track. */
const GONE_MS = 12_000;
const emPx = () => typeAround.peek() ?? parseFloat(getComputedStyle(document.documentElement).fontSize);

/** Colours of the lanes in the picture, as a text, which stays the same while the robots walk. */
const colours = computed(() => (scene.value?.lanes ?? []).map(({ color }) => color).join(" "));

/** What this page plays, in 3D. @param {{ isProjected?: boolean }} props */
export function Picture({ isProjected = false }) {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const [status, setStatus] = useState("loading");
  const [address] = useState(() => `${room.peek()?.code}/viewer/?theme=${shownTheme.peek()}`);
  useEffect(() => {
    const send = (/** @type {Message[]} */ messages) =>
      frame.current?.contentWindow?.postMessage({ type: "hexapods:draw", messages }, globalThis.origin);
    const onMessage = (/** @type {MessageEvent} */ { origin, source: from, data }) => {
      if (origin !== globalThis.origin || from !== frame.current?.contentWindow) return;
      if (data?.type === "hexapods:taken") takeCamera();
      if (data?.type !== "hexapods:status") return;
      setStatus(data.status);
      if (data.status === "connected") drawIn(send);
    };
    addEventListener("message", onMessage);
    return () => removeEventListener("message", onMessage);
  }, []);
  useEffect(() => {
    if (status !== "lost") return undefined;
    const timer = setTimeout(() => setStatus("gone"), GONE_MS);
    return () => clearTimeout(timer);
  }, [status]);
  const [lanes, names] = [colours.value, laneNames.value];
  useEffect(() => {
    const show = () => frame.current?.contentWindow?.postMessage({
      type: "hexapods:show", theme: shownTheme.value, isProjected, lanes: lanes.split(" "), names: names.split("\n"),
      ...(isProjected ? { labelPx: LABEL_EM * emPx() } : {}), words: translation?.plates, mark: translation?.mark,
      ...directions.value,
    }, globalThis.origin);
    show();
    addEventListener("resize", show);
    return () => removeEventListener("resize", show);
  }, [shownTheme.value, status, lanes, names, directions.value, typeAround.value]);
  return html`
    <div class="room-picture" data-status=${status}>
      ${isFlat(status)
        ? html`<${Loaded} name="plan" load=${loadPlan} isLost=${status === "gone"} names=${names.split("\n")}
            retry=${() => setStatus("loading")} />`
        : html`<iframe ref=${frame} src=${address} title="The robots on the track, in 3D" tabindex="-1"></iframe>`}
      ${isTaken.value && html`
        <button class="secondary compact directed-camera" onClick=${() => aim("directed")}>Directed camera</button>
      `}
      ${status === "loading" && html`<p class="over" role="status">The robot walks to the start line…</p>`}
      ${status === "lost" && html`
        <p class="over" role="status">The 3D graphics were interrupted. The picture comes again…</p>
      `}
    </div>
  `;
}

/** Play, hold and repeat the own replay. */
export function ReplayBar() {
  if (replayProblem.value) return html`<p class="dim" role="status">${replayProblem}</p>`;
  if (plan.value === null) {
    return html`<p class="dim" role="status">${isAway.value
      ? t("The picture comes with the connection.") : t("Loading the picture…")}</p>`;
  }
  const isAtEnd = playback.value?.ended ?? false;
  const isPlaying = page.moment.value === null && !isAtEnd;
  const share = endTime.value > 0 ? position.value / endTime.value : 0;
  return html`
    <div class="replay-bar">
      <button class="quiet" onClick=${() => playReplay(!isPlaying)}>
        <${Icon} name=${isPlaying ? "pause" : isAtEnd ? "replay" : "play"} />
        ${isPlaying ? t("Pause") : isAtEnd ? t("Again") : t("Play")}
      </button>
      <span class="replay-share" aria-hidden="true"><i style=${{ width: `${100 * share}%` }}></i></span>
      ${isBuffering.value && html`<span class="spinner" aria-hidden="true"></span>`}
    </div>
  `;
}
