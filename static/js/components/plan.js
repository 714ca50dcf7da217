// The robots from above, drawn by the messages that the 3D view would have drawn, where that cannot be had.
import { useEffect, useRef, useState } from "preact/hooks";
import { fixed, metres, t } from "../format.js";
import { drawHere } from "../page.js";
import { apart, bodiesOf, FINISH_M, LabelTexts, laneWidth, pathOf, placeOf, ticksOf, viewOf } from "../plan.js";
import { drawIn } from "../player.js";
import { scene } from "../store.js";
import { html } from "./elements.js";
import { widthOf } from "./line-labels.js";

/** @import { Body, Link, View } from "../plan.js" */
/** @import { Message } from "../replay-frames.js" */

const FOOT_PX = 2.5;
/** What stays free at the top and the bottom for the names of robots. */
const FREE_PX = 22;
/** Around a name; between a name and the feet below it; the size of type that `widthOf` measures. */
const [SIDE_PX, FEET_PX, MEASURED_PX] = [6, 8, 12];
/** What a number takes beside the lanes; where less is free it stands in the first. */
const NUMBER_PX = 34;
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
  const [size, setSize] = useState({ width: 0, height: 0, type: 0 });
  const [shown, setShown] = useState({ bodies: /** @type {Body[]} */ ([]), labels: new LabelTexts() });
  useEffect(() => {
    const element = /** @type {HTMLElement} */ (host.current);
    const measure = () => setSize({
      width: element.clientWidth, height: element.clientHeight, type: parseFloat(getComputedStyle(element).fontSize),
    });
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

/** Where a name is [px], and the distance beside it. */
/** @typedef {{ left: number, right: number, y: number, distance: string }} NamePlace */
/** Of the part that is drawn, and of its type [px]. @typedef {{ width: number, height: number, type: number }} Size */

/** @param {{ bodies: Body[], size: Size, titles: Title[] }} props */
function Track({ bodies, size, titles }) {
  if (bodies.length === 0) return null;
  const { view, names, top } = layOut(bodies, size, titles);
  const words = titles.map(({ name, distance }) => `${name} ${distance}`.trim()).join("; ");
  return html`
    <svg role="img" aria-label=${t("Plan of the track from above. {words}", { words })}
      width=${size.width} height=${size.height}>
      <g transform=${`translate(0 ${top})`}>
        <${Ground} bodies=${bodies} titles=${titles} view=${view}
          edge=${Math.min(...names.map(({ left: at }) => at))} />
        ${bodies.map((body, n) => html`
          <${Robot} key=${body.lane} body=${body} color=${titles[n].color} view=${view} />
        `)}
        ${names.map((name, n) => html`<${Name} key=${bodies[n].lane} name=${name} title=${titles[n]} />`)}
      </g>
    </svg>
  `;
}

/**
 * What of the track is drawn, how far below the top it begins, and where the robots' names are.
 * @param {Body[]} bodies
 * @param {Size} size
 * @param {Title[]} titles
 * @param {number} [lines] how many more than the first are free at the top
 * @returns {{ view: View, names: NamePlace[], top: number }}
 */
function layOut(bodies, { width, height, type }, titles, lines = 0) {
  const line = 1.25 * type;
  const top = FREE_PX + lines * line;
  const room = { width, height: Math.max(1, height - top - FREE_PX) };
  const view = viewOf(bodies, room, scene.value?.kind === "training");
  const hasDistance = !view.isUpright || laneWidth(bodies) * view.scale >= WIDE_PX;
  const names = apart(bodies.map(({ at, legs }, n) => {
    const { name, distance } = titles[n];
    const shown = hasDistance ? distance : "";
    const size = widthOf(`${name} ${shown}`, 650) * (type / MEASURED_PX);
    const [x] = placeOf(view, at);
    const left = Math.max(SIDE_PX, Math.min(x - size / 2, width - SIDE_PX - size));
    const y = Math.min(...legs.map((leg) => placeOf(view, leg[leg.length - 1])[1])) - FEET_PX;
    return { left, right: left + size + SIDE_PX, y, distance: shown };
  }), line);
  // Those that others have pushed up need another line at the top.
  const isCut = names.some(({ y }) => y - type < -top) && lines < bodies.length;
  return isCut ? layOut(bodies, { width, height, type }, titles, lines + 1) : { view, names, top };
}

/**
 * The lanes with marks of distance, the start and the finish line; `edge` is where the first name begins [px].
 * @param {{ bodies: Body[], titles: Title[], view: View, edge: number }} props
 */
function Ground({ bodies, titles, view, edge }) {
  const half = laneWidth(bodies) / 2;
  const xs = bodies.map(({ at }) => at[0]);
  const [left, right] = [Math.min(...xs) - half, Math.max(...xs) + half];
  const { isUpright, along: [from, length] } = view;
  const line = (/** @type {number} */ y) => `M${pathOf(view, [[left, y, 0], [right, y, 0]])}`;
  const mark = (/** @type {number} */ y, /** @type {string} */ words) => {
    const [x_px, y_px] = placeOf(view, [isUpright ? left : right, y]);
    if (!isUpright) return html`<text class="number" x=${x_px} y=${y_px - 4} text-anchor="middle">${words}</text>`;
    const outside = Math.min(x_px, edge) - SIDE_PX;
    return outside < NUMBER_PX ? html`<text class="number" x=${x_px + 4} y=${y_px - 4}>${words}</text>`
      : html`<text class="number" x=${outside} y=${y_px + 4} text-anchor="end">${words}</text>`;
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

/** @param {{ body: Body, color: string, view: View }} props */
function Robot({ body: { legs }, color, view }) {
  const feet = legs.map((leg) => placeOf(view, leg[leg.length - 1]));
  return html`
    <g class="robot" style=${{ color }}>
      <path class="limb" d=${legs.map((leg) => `M${pathOf(view, leg)}`).join("")} />
      <path class="torso" d=${`M${pathOf(view, legs.map(([hip]) => hip))}Z`} />
      ${feet.map(([cx, cy]) => html`<circle class="foot" cx=${cx} cy=${cy} r=${FOOT_PX} />`)}
    </g>
  `;
}

/** @param {{ name: NamePlace, title: Title }} props */
const Name = ({ name: { left, y, distance }, title }) => html`
  <text class="name" x=${left} y=${y}>
    ${title.name}${distance && html`<tspan class="distance" dx="0.5em">${distance}</tspan>`}
  </text>
`;
