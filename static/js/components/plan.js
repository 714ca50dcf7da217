// The robots from above, drawn by the messages that the 3D view would have drawn, where that cannot be had.
import { useEffect, useRef, useState } from "preact/hooks";
import { fixed, metres, t } from "../format.js";
import { drawHere } from "../page.js";
import { bodiesOf, FINISH_M, LabelTexts, laneWidth, pathOf, placeOf, ticksOf, viewOf } from "../plan.js";
import { drawIn } from "../player.js";
import { scene } from "../store.js";
import { html } from "./elements.js";

/** @import { Body, Link, View } from "../plan.js" */
/** @import { Message } from "../replay-frames.js" */

const FOOT_PX = 2.5;
/** What stays free at the top and the bottom for the names of robots, and at the sides of a name. */
const [FREE_PX, SIDE_PX] = [22, 60];
/** A lane that is narrower has no room for the distance beside the name. */
const WIDE_PX = 150;

// It keeps the poses of robots for the 3D view, and needs nothing of that.
await import(new URL("../../viewer/robots.js", import.meta.url).href);

/** @returns {Link[]} */
const links = () => /** @type {any} */ (globalThis).hexapodsViewer.robots.links();

/**
 * `isLost`: the browser had 3D graphics until now; `retry` loads the 3D view again; `names` are those of the robots by
 * lane, where they are not called as their agents.
 * @param {{ isLost?: boolean, retry: () => void, names?: string[] }} props
 */
export function Plan({ isLost = false, retry, names = [] }) {
  const host = useRef(/** @type {HTMLElement | null} */ (null));
  const [size, setSize] = useState({ width: 0, height: 0 });
  const [shown, setShown] = useState({ bodies: /** @type {Body[]} */ ([]), labels: new LabelTexts() });
  useEffect(() => {
    const element = /** @type {HTMLElement} */ (host.current);
    const measure = () => setSize({ width: element.clientWidth, height: element.clientHeight });
    const observer = new ResizeObserver(measure);
    observer.observe(element);
    measure();
    return () => observer.disconnect();
  }, []);
  useEffect(() => {
    const labels = new LabelTexts();
    /** @type {number | undefined} */
    let due;
    const take = (/** @type {Message[]} */ messages) => {
      messages.forEach((message) => labels.take(message));
      dispatchEvent(new CustomEvent("hexapods:draw", { detail: { messages } }));
      due ??= requestAnimationFrame(() => {
        due = undefined;
        setShown({ bodies: bodiesOf(links()), labels });
      });
    };
    drawIn(take);
    drawHere.value = (messages) => take(messages);
    return () => cancelAnimationFrame(due ?? 0);
  }, []);
  const { bodies, labels } = shown;
  const words = isLost ? t("The 3D graphics have failed. This is a plan from above.")
    : t("No 3D graphics (WebGL) in this browser. This is a plan from above.");
  return html`
    <div class="plan">
      <div class="plan-track" ref=${host}>
        ${size.width > 0 && html`<${Track} bodies=${bodies} size=${size} titles=${titlesOf(bodies, labels, names)} />`}
      </div>
      <p class="plan-note" role="status">
        ${words} ${isLost && html`<button class="quiet compact" onClick=${retry}>Try 3D again</button>`}
      </p>
    </div>
  `;
}

/** Name, distance and colour of each robot. @type {(bodies: Body[], labels: LabelTexts, names: string[]) => Title[]} */
const titlesOf = (bodies, labels, names) => bodies.map(({ lane }) => {
  const { name, distance_m, color } = scene.value?.lanes[lane] ?? {};
  const [label] = labels.of(lane);
  const isMeasured = distance_m !== undefined && scene.value?.kind !== "idle";
  return {
    name: names[lane] || label || name || "", distance: isMeasured ? metres(distance_m) : "",
    color: color ?? "var(--dim)",
  };
});

/** @typedef {{ name: string, distance: string, color: string }} Title */

/** @param {{ bodies: Body[], size: { width: number, height: number }, titles: Title[] }} props */
function Track({ bodies, size: { width, height }, titles }) {
  if (bodies.length === 0) return null;
  const view = viewOf(bodies, { width, height: Math.max(1, height - 2 * FREE_PX) }, scene.value?.kind === "training");
  const words = titles.map(({ name, distance }) => `${name} ${distance}`.trim()).join("; ");
  return html`
    <svg role="img" aria-label=${t("Plan of the track from above. {words}", { words })} width=${width} height=${height}>
      <g transform=${`translate(0 ${FREE_PX})`}>
        <${Ground} bodies=${bodies} titles=${titles} view=${view} />
        ${bodies.map((body, n) => html`<${Robot} key=${body.lane} body=${body} title=${titles[n]} view=${view} />`)}
      </g>
    </svg>
  `;
}

/** The lanes with marks of distance, the start and the finish line. */
/** @param {{ bodies: Body[], titles: Title[], view: View }} props */
function Ground({ bodies, titles, view }) {
  const half = laneWidth(bodies) / 2;
  const xs = bodies.map(({ at }) => at[0]);
  const [left, right] = [Math.min(...xs) - half, Math.max(...xs) + half];
  const { isUpright, along: [from, length] } = view;
  const line = (/** @type {number} */ y) => `M${pathOf(view, [[left, y, 0], [right, y, 0]])}`;
  const mark = (/** @type {number} */ y, /** @type {string} */ words) => {
    const [x_px, y_px] = placeOf(view, [isUpright ? left : right, y]);
    return html`
      <text class="number" x=${x_px + (isUpright ? 4 : 0)} y=${y_px - 4}
        text-anchor=${isUpright ? "start" : "middle"}>${words}</text>
    `;
  };
  return html`
    ${xs.map((x, n) => html`
      <path class="lane" style=${{ color: titles[n].color }} d=${`M${pathOf(view, [
        [x - half, from], [x + half, from], [x + half, from + length], [x - half, from + length],
      ])}Z`} />
    `)}
    ${ticksOf(view).map(({ y, hasNumber }) => html`
      <path class="tick" d=${line(y)} />${hasNumber && mark(y, fixed(y, 1).replace("-", "−"))}
    `)}
    <path class="start" d=${line(0)} /><path class="finish" d=${line(FINISH_M)} />
    ${mark(0, t("start"))}${mark(FINISH_M, t("finish"))}
  `;
}

/** @param {{ body: Body, title: Title, view: View }} props */
function Robot({ body: { at, legs }, title: { name, distance, color }, view }) {
  const feet = legs.map((leg) => placeOf(view, leg[leg.length - 1]));
  const [x] = placeOf(view, at);
  const width = view.scale * (view.isUpright ? view.across : view.along)[1];
  const hasRoom = !view.isUpright || laneWidth([{ lane: 0, at, legs }]) * view.scale >= WIDE_PX;
  const anchor = x < SIDE_PX ? "start" : x > width - SIDE_PX ? "end" : "middle";
  return html`
    <g class="robot" style=${{ color }}>
      <path class="limb" d=${legs.map((leg) => `M${pathOf(view, leg)}`).join("")} />
      <path class="torso" d=${`M${pathOf(view, legs.map(([hip]) => hip))}Z`} />
      ${feet.map(([cx, cy]) => html`<circle class="foot" cx=${cx} cy=${cy} r=${FOOT_PX} />`)}
      <text class="name" x=${{ start: 6, middle: x, end: width - 6 }[anchor]} text-anchor=${anchor}
        y=${Math.min(...feet.map(([, y]) => y)) - 8}>
        ${name}${distance && hasRoom && html`<tspan class="distance" dx="0.5em">${distance}</tspan>`}
      </text>
    </g>
  `;
}
