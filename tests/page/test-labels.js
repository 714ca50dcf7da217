// Labels of a chart: near their lines, and never over each other.
import assert from "node:assert/strict";
import { test } from "node:test";
import { chooseCaptions, overlap, passes, placeCaptions, placeLabels } from "../../static/js/components/line-labels.js";

const BOUNDS = { left: 0, top: 0, width: 300, height: 160 };
const box = (/** @type {number} */ left, /** @type {number} */ top, width = 60, height = 16) =>
  ({ left, top, width, height });

/** @param {(import("../../static/js/components/line-labels.js").Box | null)[]} boxes */
function assertApart(boxes) {
  const shown = boxes.filter((label) => label !== null);
  shown.forEach((label, n) => shown.slice(n + 1).forEach((other) => assert.ok(!overlap(label, other))));
}

/**
 * @param {(import("../../static/js/components/line-labels.js").Box | null)[]} placed
 * @param {import("../../static/js/components/line-labels.js").Box[]} wanted
 */
function assertInOrder(placed, wanted) {
  const inOrder = placed.flatMap((label, n) => (label ? [{ ...label, line: wanted[n].top }] : []))
    .sort((a, b) => a.line - b.line);
  inOrder.forEach((label, n) => inOrder.slice(n + 1).forEach((other) => {
    const isBeside = label.left + label.width <= other.left || other.left + other.width <= label.left;
    assert.ok(isBeside || label.top < other.top, "labels have changed places");
  }));
}

test("a label with room stays, and moves no further than it must", () => {
  assert.deepEqual(placeLabels([box(10, 50), box(10, 55), box(10, 120)], [], BOUNDS),
    [box(10, 50), box(10, 66), box(10, 120)]);
  assert.deepEqual(placeLabels([box(10, 50), box(100, 50)], [], BOUNDS), [box(10, 50), box(100, 50)]);
});

test("a label that would leave the chart is moved back into it", () => {
  assert.deepEqual(placeLabels([box(290, 158)], [], BOUNDS), [box(240, 144)]);
});

test("labels keep the order of their lines at the edges of the chart", () => {
  assert.deepEqual(placeLabels([box(10, 150), box(10, 140), box(10, 144)], [], BOUNDS),
    [box(10, 144), box(10, 112), box(10, 128)]);
  assert.deepEqual(placeLabels([box(10, 2), box(10, 0), box(10, 4)], [], BOUNDS),
    [box(10, 16), box(10, 0), box(10, 32)]);
});

test("labels keep off captions", () => {
  const [caption] = placeCaptions([box(0, 40, 200, 16)], BOUNDS);
  assert.deepEqual(placeLabels([box(100, 45)], caption ? [caption] : [], BOUNDS), [box(100, 56)]);
});

test("of two captions at one place the more important is shown", () => {
  assert.deepEqual(placeCaptions([box(0, 0), box(10, 0), box(70, 0)], BOUNDS), [box(0, 0), null, box(70, 0)]);
});

test("no two labels overlap at any width, and eight find room", () => {
  // A small generator of its own makes the cases the same each time.
  let seed = 1;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let run = 0; run < 400; run += 1) {
    const width = 120 + Math.floor(random() * 900);
    const bounds = { left: 0, top: 4, width, height: 172 };
    const caption = box(random() * width, 20 + random() * 100, 160, 14);
    const captions = placeCaptions([caption, box(random() * width, 4, 50, 14)], bounds)
      .filter((place) => place !== null);
    const wanted = Array.from({ length: 1 + Math.floor(random() * 8) }, () =>
      box(random() * width, 20 + random() * 140, 30 + random() * 60, 16));
    const placed = placeLabels(wanted, captions, bounds);
    assertApart([...placed, ...captions]);
    assert.ok(!placed.includes(null), `a label is missing at ${width} px`);
    assertInOrder(placed, wanted);
    assert.ok(placed.every((place) => place && place.left >= 0 && place.left + place.width <= width + 1e-9));
  }
});

test("a caption takes the first place with the fewest lines on it, and none over another caption", () => {
  const crossed = (/** @type {{ left: number }} */ { left }) => (left < 60 ? 1 : 0);
  assert.deepEqual(chooseCaptions([[box(0, 40), box(0, 60)]], BOUNDS, () => 0), [box(0, 40)]);
  assert.deepEqual(chooseCaptions([[box(0, 40), box(70, 40), box(100, 40)]], BOUNDS, crossed), [box(70, 40)]);
  assert.deepEqual(chooseCaptions([[box(0, 40)]], BOUNDS, crossed), [box(0, 40)]);
  assert.deepEqual(
    chooseCaptions([[box(0, 40)], [box(0, 44), box(0, 60)], [box(0, 52)]], BOUNDS, () => 0),
    [box(0, 40), box(0, 60), null],
  );
  assert.deepEqual(chooseCaptions([[box(0, -4), box(0, 4)]], BOUNDS, () => 0), [box(0, 4)]);
});

test("a line passes through a box where one of its parts does, also between its points", () => {
  const label = box(40, 40, 20, 10);
  assert.ok(passes([[0, 0], [100, 100]], label));
  assert.ok(!passes([[0, 0], [100, 20]], label));
  assert.ok(passes([[0, 45], [100, 45]], label));
  assert.ok(!passes([[0, 45], [30, 45]], label));
  assert.ok(!passes([[70, 45], [100, 45]], label));
  assert.ok(passes([[50, 0], [50, 100]], label));
  assert.ok(!passes([], label));
});
