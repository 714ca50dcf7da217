// The reveal of a point or a drawn curve: all of the class over the learning curves of its robots.
import { useEffect, useState } from "preact/hooks";
import { getCurves } from "../../../../js/api.js";
import { html } from "../../../../js/components/elements.js";
import { count, decimal, metres, whole } from "../../../../js/format.js";
import { stepsOf } from "../chart.js";
import { meanCurve } from "./mean-curve.js";
import { plotAxis } from "./plot-geometry.js";
import { AxisNumbers, useBox } from "./plot.js";
import { isRevealOf, predictionsOf } from "./predictions.js";

/** @import { ResultEntry } from "../../../../js/types.js" */
/** @import { Act, Facts } from "./index.js" */

/** The learning curves of the robots that have practised, once they are loaded. @param {ResultEntry[]} entries */
function useCurves(entries) {
  const [curves, setCurves] = useState(/** @type {number[][][]} */ ([]));
  const ids = entries.flatMap(({ run }) => (run?.state === "finished" && run.kind === "training" ? [run.id] : []));
  useEffect(() => {
    if (ids.length === 0) return;
    getCurves(ids).then(({ curves: loaded }) => setCurves(loaded.map(({ steps, distances_m }) =>
      steps.flatMap((step, n) => {
        const distance_m = distances_m[n];
        return distance_m === null ? [] : [[step, distance_m]];
      }))), () => {});
  }, [ids.join()]);
  return curves.filter((curve) => curve.length > 1);
}

/** Of the axis' numbers and of the key, in the size of type. */
const [AXIS_EM, LEFT_EM, KEY_EM] = [1.7, 2.6, 1.5];

/** @param {Facts} facts */
function Reveal({ classroom, results }) {
  const curves = useCurves(results?.entries ?? []);
  const predicted = predictionsOf(results);
  const isPoint = classroom.shown.ask?.kind === "point";
  const points = isPoint ? predicted : predicted.flat();
  const mean = meanCurve(curves);
  const [host, { width, height, em }] = useBox();
  const all = [...points, ...curves.flat()];
  const xs = { ...plotAxis([0, stepsOf(classroom.shown), ...all.map(([x]) => x)]), low: 0 };
  const ys = plotAxis([0, 0.1, ...all.map(([, y]) => y)]);
  const [inner, deep] = [width - LEFT_EM * em, height - (AXIS_EM + KEY_EM) * em];
  const placed = (/** @type {number[]} */ [x, y]) => [xs.at(x) * inner, (1 - ys.at(y)) * deep];
  const path = (/** @type {number[][]} */ line) => `M${line.map((point) => placed(point).join(" ")).join(" L")}`;
  const thing = isPoint ? "point" : "curve";
  return html`
    <div class="plot" ref=${host}>
      ${width > 0 && html`
        <svg width=${width} height=${height} role="img"
          aria-label=${`${predicted.length} predictions over ${curves.length} learning curves`}>
          <g class="curve-key">
            <text class="predicted" x=${LEFT_EM * em} y=${em}>${count(predicted.length, `predicted ${thing}`)}</text>
            <text class="walked" x=${width} y=${em} text-anchor="end">
              ${count(curves.length, "robot")}${mean.length > 1 ? ", bold: typical" : ""}
            </text>
          </g>
          <g transform=${`translate(${LEFT_EM * em} ${KEY_EM * em})`}>
            ${ys.marks.map((y) => html`
              <line class="plot-grid" x1="0" x2=${inner} y1=${placed([0, y])[1]} y2=${placed([0, y])[1]} />
              <text class="plot-number" x=${-0.4 * em} y=${Math.max(0.7 * em, placed([0, y])[1] + 0.3 * em)}
                text-anchor="end">${decimal(Number(y.toFixed(2)))}</text>
            `)}
            ${curves.map((curve) => html`<path class="learned" d=${path(curve)} />`)}
            ${!isPoint && predicted.map((curve) => html`<path class="drawn" d=${path(curve)} />`)}
            ${mean.length > 1 && html`<path class="mean" d=${path(mean)} />`}
            ${isPoint && predicted.map((point) => html`
              <circle class="pointed" cx=${placed(point)[0]} cy=${placed(point)[1]} r=${0.36 * em} />
            `)}
            <${AxisNumbers} axis=${xs} width=${inner} y=${deep} em=${em}
              format=${(/** @type {number} */ x) => (x === xs.marks.at(-1) ? `${whole(x)} steps` : whole(x))} />
          </g>
          <text class="plot-number" x="0" y=${em}>${metres(0).slice(-1)}</text>
        </svg>
      `}
    </div>
  `;
}

/** @type {Act} */
export const POINT = { name: "point", isOn: isRevealOf("point"), Show: Reveal };
/** @type {Act} */
export const CURVE = { name: "curve", isOn: isRevealOf("curve"), Show: Reveal };
