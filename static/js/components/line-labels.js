// A uPlot plugin: labels at the ends of lines instead of a legend, and straight lines with a caption.
import { spread } from "../scale.js";

const LINE_PX = 16;
const DOT_PX = 4;
const FONT = "12px system-ui, sans-serif";

/** The font at the canvas's resolution. */
const fontOf = (px, weight = 400) => `${weight} ${FONT.replace("12px", `${12 * px}px`)}`;

/**
 * @param labels returns [{text, color, x, y}] in the chart's units
 * @param marks returns [{x? or y?, color, ink?, text?, share?, dash?}]: straight lines across the chart;
 *   `share` of the width is where the caption of a horizontal one begins
 * @param resolve returns the colour of a custom property
 */
export function lineLabels(labels, marks, resolve) {
  const colourOf = (name) => (name.startsWith("--") ? resolve(name) : name);

  const drawMark = (u, mark) => {
    const { ctx } = u;
    const px = devicePixelRatio;
    ctx.save();
    ctx.strokeStyle = colourOf(mark.color);
    ctx.fillStyle = colourOf(mark.ink ?? mark.color);
    ctx.lineWidth = 1.5 * px;
    ctx.setLineDash((mark.dash ?? []).map((d) => d * px));
    ctx.beginPath();
    if (mark.x === undefined) drawHorizontal(u, mark, px);
    else drawVertical(u, mark, px);
    ctx.stroke();
    ctx.restore();
  };

  const drawLabels = (u) => {
    const { ctx, bbox } = u;
    const px = devicePixelRatio;
    const placed = labels()
      .map((label) => ({
        ...label,
        left: Math.min(u.valToPos(label.x, "x", true), bbox.left + bbox.width),
        top: u.valToPos(label.y, "y", true),
      }))
      .sort((a, b) => a.top - b.top);
    const tops = spread(placed.map(({ top }) => top), LINE_PX * px, bbox.top, bbox.top + bbox.height);
    ctx.save();
    ctx.font = fontOf(px, 600);
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    placed.forEach(({ text, color, left, top }, n) => {
      ctx.fillStyle = colourOf(color);
      ctx.beginPath();
      ctx.arc(left, top, DOT_PX * px, 0, 2 * Math.PI);
      ctx.fill();
      // Not in the line's own colour: yellow on white cannot be read.
      ctx.fillStyle = colourOf("--ink");
      ctx.fillText(text, left + 9 * px, tops[n]);
    });
    ctx.restore();
  };

  return { hooks: { draw: [(u) => marks().forEach((mark) => drawMark(u, mark)), drawLabels] } };
}

function drawHorizontal(u, { y, text, share = 0 }, px) {
  const { ctx, bbox } = u;
  const at = u.valToPos(y, "y", true);
  ctx.moveTo(bbox.left, at);
  ctx.lineTo(bbox.left + bbox.width, at);
  if (!text) return;
  ctx.font = fontOf(px, 600);
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  ctx.fillText(text, bbox.left + share * bbox.width + 6 * px, at - 4 * px);
}

function drawVertical(u, { x, text }, px) {
  const { ctx, bbox } = u;
  const at = u.valToPos(x, "x", true);
  ctx.moveTo(at, bbox.top);
  ctx.lineTo(at, bbox.top + bbox.height);
  if (!text) return;
  const isFarRight = at > bbox.left + 0.6 * bbox.width;
  ctx.font = fontOf(px);
  ctx.textAlign = isFarRight ? "right" : "left";
  ctx.textBaseline = "bottom";
  ctx.fillText(text, at + (isFarRight ? 6 : -6) * px, bbox.top - 3 * px);
}
