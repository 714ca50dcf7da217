// Charts beside the dots of a class: the distances by the setting that each robot was given.
import { html } from "../../../../js/components/elements.js";
import { decimal } from "../../../../js/format.js";
import { settingInWords } from "../allowed-settings.js";
import { besideEachOther, plotAxis } from "./plot-geometry.js";
import { AxisNumbers, useBox } from "./plot.js";
import { settingDots } from "./setting-dots.js";

/** @import { LessonCard } from "../../../../js/types.js" */
/** @import { Facts } from "./index.js" */
/** @import { SettingDots } from "./setting-dots.js" */

/** Of the axis' numbers, of the title, of the numbers at the left, and of a dot, in the size of type. */
const [AXIS_EM, TITLE_EM, LEFT_EM, DOT_EM] = [1.7, 1.5, 2.6, 0.4];

/** @param {Facts} props */
export function BySetting({ classroom: { shown }, results }) {
  const charts = settingDots(Object.keys(shown.may ?? {}), results?.entries ?? []);
  return charts.length > 0 && html`
    <div class="by-setting">
      ${charts.map((ofSetting) => html`<${Chart} key=${ofSetting.name} ofSetting=${ofSetting} card=${shown} />`)}
    </div>
  `;
}

/** @param {{ ofSetting: SettingDots, card: LessonCard }} props */
function Chart({ ofSetting: { name, points, values }, card }) {
  const [host, { width, height, em }] = useBox();
  const { title, valueInWords } = settingInWords(name, card);
  const ys = plotAxis([0, 0.1, ...points.map(([, y]) => y)], 3);
  const across = values ? null : plotAxis(points.map(([x]) => x), 4);
  const xs = across ?? {
    low: 0, high: 1, marks: (values ?? []).map((_, n) => n),
    at: (/** @type {number} */ x) => (x + 0.5) / (values ?? []).length,
  };
  const [inner, deep] = [width - LEFT_EM * em, height - (AXIS_EM + TITLE_EM) * em];
  const down = (/** @type {number} */ y) => (1 - ys.at(y)) * deep;
  const dots = besideEachOther(points.map(([x, y]) => ({ x: xs.at(x) * inner, y: down(y) })), DOT_EM * em, inner);
  const format = (/** @type {number} */ x) => (values ? valueInWords(values[x]) : `${Number(x.toPrecision(3))}`);
  return html`
    <div class="plot" ref=${host}>
      ${width > 0 && html`
        <p class="plot-title">Distance in m by ${title}</p>
        <svg width=${width} height=${height} role="img" aria-label=${`${points.length} distances by ${title}`}>
          <g transform=${`translate(${LEFT_EM * em} ${TITLE_EM * em})`}>
            ${ys.marks.map((y) => html`
              <line class="plot-grid" x1="0" x2=${inner} y1=${down(y)} y2=${down(y)} />
              <text class="plot-number" x=${-0.4 * em} y=${down(y) + 0.3 * em} text-anchor="end">
                ${decimal(Number(y.toFixed(2)))}</text>
            `)}
            ${dots.map(({ x, y }) => html`<circle class="set-to" cx=${x} cy=${y} r=${DOT_EM * em} />`)}
            <${AxisNumbers} axis=${xs} format=${format} width=${inner} y=${deep} em=${em} />
          </g>
        </svg>
      `}
    </div>
  `;
}
