// Words at the ends of lines, instead of a legend; where two would touch, they make room.

const LINE_PX = 16;
const DOT_PX = 4;

/**
 * A uPlot plugin.
 * @param labels gives [{text, color, x, y}] in the chart's units
 * @param marks gives [{x? or y?, color, ink?, text?, share?, dash?}]: thin straight lines across;
 *   `share` of the width is where the text of a level one begins
 * @param colour resolves a custom property
 */
export function lineLabels(labels, marks, colour) {
  const solid = (name) => (name.startsWith("--") ? colour(name) : name);

  const drawMarks = (u) => {
    const { ctx, bbox } = u;
    const px = devicePixelRatio;
    for (const { x, y, color, ink = color, dash = [], text, share = 0 } of marks()) {
      ctx.save();
      ctx.strokeStyle = solid(color);
      ctx.fillStyle = solid(ink);
      ctx.lineWidth = 1.5 * px;
      ctx.setLineDash(dash.map((d) => d * px));
      ctx.beginPath();
      if (x === undefined) {
        const at = u.valToPos(y, "y", true);
        ctx.moveTo(bbox.left, at);
        ctx.lineTo(bbox.left + bbox.width, at);
        if (text) {
          ctx.font = `600 ${12 * px}px system-ui, sans-serif`;
          ctx.textAlign = "left";
          ctx.textBaseline = "bottom";
          ctx.fillText(text, bbox.left + share * bbox.width + 6 * px, at - 4 * px);
        }
      } else {
        const at = u.valToPos(x, "x", true);
        ctx.moveTo(at, bbox.top);
        ctx.lineTo(at, bbox.top + bbox.height);
        if (text) {
          const isLeft = at > bbox.left + 0.6 * bbox.width;
          ctx.font = `${12 * px}px system-ui, sans-serif`;
          ctx.textAlign = isLeft ? "right" : "left";
          ctx.textBaseline = "bottom";
          ctx.fillText(text, at + (isLeft ? 6 : -6) * px, bbox.top - 3 * px);
        }
      }
      ctx.stroke();
      ctx.restore();
    }
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
    const room = spread(placed.map(({ top }) => top), LINE_PX * px, bbox.top, bbox.top + bbox.height);
    ctx.save();
    ctx.font = `600 ${12 * px}px system-ui, sans-serif`;
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    placed.forEach(({ text, color, left, top }, n) => {
      ctx.fillStyle = solid(color);
      ctx.beginPath();
      ctx.arc(left, top, DOT_PX * px, 0, 2 * Math.PI);
      ctx.fill();
      // Ink rather than the line's own colour: yellow on white cannot be read.
      ctx.fillStyle = solid("--ink");
      ctx.fillText(text, left + 9 * px, room[n]);
    });
    ctx.restore();
  };

  return { hooks: { draw: [drawMarks, drawLabels] } };
}

/** Move sorted positions apart to at least `gap`, as little as possible, within the frame. */
function spread(tops, gap, low, high) {
  const moved = [...tops];
  for (let n = 1; n < moved.length; n += 1) moved[n] = Math.max(moved[n], moved[n - 1] + gap);
  const over = Math.max(0, (moved.at(-1) ?? low) - high);
  if (over > 0) {
    moved[moved.length - 1] -= over;
    for (let n = moved.length - 2; n >= 0; n -= 1) moved[n] = Math.min(moved[n], moved[n + 1] - gap);
  }
  return moved;
}
