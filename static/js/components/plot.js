// A uPlot chart that is redrawn when its size, the theme or its data change.
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { html } from "../html.js";
import { shownTheme } from "../theme.js";
import { lineLabels } from "./line-labels.js";

const HEIGHT = 216;
const FONT = "12px system-ui, sans-serif";

/**
 * @param {object} props
 * @param {string} props.label what the chart shows, in a sentence
 * @param {uPlot.AlignedData} props.data [xs, ys…]
 * @param {{ color: string, dash?: number[], width?: number, points?: boolean }[]} props.series one per line
 * @param {{ min?: number, max: number, unit: string }} props.x
 * @param {{ min?: number, max: number }} props.y
 * @param {{ text: string, color: string, x: number, y: number }[]} props.labels at the ends of lines
 * @param {object[]} [props.marks] straight lines, as `lineLabels` takes them
 * @param {number} [props.room] for the labels, on the right [px]
 */
export function Plot(props) {
  /** @type {{ current: any }} */
  const host = useRef(null);
  /** @type {{ current: any }} */
  const plot = useRef(null);
  const newest = useRef(props);
  newest.current = props;
  const shape = JSON.stringify(props.series);

  useLayoutEffect(() => {
    plot.current = new uPlot(optionsOf(host.current, newest), props.data, host.current);
    const watcher = new ResizeObserver(([{ contentRect }]) => {
      if (contentRect.width > 0) plot.current.setSize({ width: contentRect.width, height: HEIGHT });
    });
    watcher.observe(host.current);
    return () => {
      watcher.disconnect();
      plot.current.destroy();
    };
  }, [shape, shownTheme.value]);

  useEffect(() => plot.current.setData(props.data), [props.data, props.x.max, props.y.max]);

  return html`<div class="plot" role="img" aria-label=${props.label} ref=${host}></div>`;
}

/** @returns {any} uPlot's options; its types want more than it does */
function optionsOf(host, newest) {
  const colour = coloursOf(host);
  const axis = (more) => ({
    stroke: colour("--dim"),
    font: FONT,
    grid: { stroke: colour("--line"), width: 1 },
    ticks: { show: false },
    ...more,
  });
  const range = (name) => () => [newest.current[name].min ?? 0, newest.current[name].max];
  return {
    width: host.clientWidth || 300,
    height: HEIGHT,
    padding: [20, newest.current.room ?? 88, 0, 0],
    legend: { show: false },
    cursor: { show: false },
    select: { show: false },
    scales: { x: { time: false, range: range("x") }, y: { range: range("y") } },
    axes: [
      axis({
        size: 26, gap: 6, space: 56, grid: { show: false },
        label: newest.current.x.unit, labelSize: 18, labelFont: FONT, labelGap: 0,
      }),
      axis({ size: 44, gap: 8, space: 30, values: (_, splits) => splits.map((v) => `${v.toFixed(1)} m`) }),
    ],
    series: [
      {},
      ...newest.current.series.map(({ color, dash, width = 2.5, points }) => ({
        stroke: color.startsWith("--") ? colour(color) : color,
        width,
        dash,
        spanGaps: true,
        points: { show: Boolean(points), size: 6, fill: color, stroke: color },
      })),
    ],
    plugins: [lineLabels(() => newest.current.labels, () => newest.current.marks ?? [], colour)],
  };
}

/** A function that resolves custom properties, which a canvas does not. */
function coloursOf(host) {
  const probe = document.createElement("span");
  return (name) => {
    host.append(probe);
    probe.style.color = `var(${name})`;
    const found = getComputedStyle(probe).color;
    probe.remove();
    return found;
  };
}
