// What the page of a file can be told by messages and in its address: what is valid, and what errors name.
import assert from "node:assert/strict";
import { test } from "node:test";
import { commandOf, commandsIn, InvalidCommand } from "../../static/js/offline/commands.js";

const LIMITS = { lanes: 2, clocks: ["paper", "wall", "free"] };

/** @param {any} message */
const commanded = (message) => commandOf(message, LIMITS);

test("a message is a command", () => {
  assert.deepEqual(commanded({ type: "hexapods:play", id: 7 }), { name: "play" });
  assert.deepEqual(commanded({ type: "hexapods:seek", time_s: 4.5 }), { name: "seek", time_s: 4.5 });
  assert.deepEqual(commanded({ type: "hexapods:step", direction: -1 }), { name: "step", direction: -1 });
  assert.deepEqual(commanded({ type: "hexapods:clock", clock: "wall" }), { name: "clock", clock: "wall" });
  assert.deepEqual(
    commanded({ type: "hexapods:camera", position: [0.6, -0.4, 0.3], follow: 2 }),
    { name: "camera", camera: { position: [0.6, -0.4, 0.3], follow: "2" } },
  );
});

test("messages of others are none", () => {
  for (const message of [null, 3, "hexapods:play", {}, { type: "resize" }, { type: 4 }]) {
    assert.equal(commanded(message), null);
  }
});

test("an error of a message names what is valid", () => {
  /** @type {[object, string][]} */
  const cases = [
    [{ type: "hexapods:open" }, "type must be hexapods:play, hexapods:pause, hexapods:seek, hexapods:step, "
      + 'hexapods:speed, hexapods:camera, hexapods:clock or hexapods:state, not "hexapods:open"'],
    [{ type: "hexapods:seek", time_s: "now" }, 'time_s must be a number, not "now"'],
    [{ type: "hexapods:seek" }, "time_s must be a number, not undefined"],
    [{ type: "hexapods:seek", time: 3 }, 'hexapods:seek has time_s, not "time"'],
    [{ type: "hexapods:play", now: 1 }, 'hexapods:play has no other members, such as "now"'],
    [{ type: "hexapods:step", direction: 2 }, "direction must be 1 or -1, not 2"],
    [{ type: "hexapods:speed", speed: 0 }, "speed must be above 0, not 0"],
    [{ type: "hexapods:clock", clock: "sun" }, 'clock must be paper, wall or free in this file, not "sun"'],
    [{ type: "hexapods:camera", follow: 3 }, "follow must be directed, leader, free, 1 or 2, not 3"],
    [{ type: "hexapods:camera", position: [0, 0, 1e9] },
      "position must be three numbers, x, y and z in metres, from −100 to 100, not [0,0,1000000000]"],
    [{ type: "hexapods:camera", position: [1, 1, 1], look_at: [1, 1, 1] },
      "position and look_at must be at least 0.01 m apart"],
  ];
  for (const [message, sentence] of cases) {
    assert.throws(() => commanded(message), new InvalidCommand(sentence));
  }
});

test("the address has camera, moment and clock", () => {
  assert.deepEqual(
    commandsIn("?t=2.5&clock=free&position=0.6,-0.4,0.3&look_at=0,0.1,0&follow=leader&speed=2&play&theme=dark", LIMITS),
    {
      commands: [
        { name: "clock", clock: "free" }, { name: "speed", speed: 2 }, { name: "seek", time_s: 2.5 },
        { name: "camera", camera: { follow: "leader" } },
        { name: "camera", camera: { position: [0.6, -0.4, 0.3], look_at: [0, 0.1, 0] } }, { name: "play" },
      ],
      errors: [],
    },
  );
});

test("what is not valid in the address is left out, and named", () => {
  assert.deepEqual(commandsIn("?t=noon&clock=sun&position=1,2&follow=3&play=no&theme=red&speed=1", LIMITS), {
    commands: [{ name: "speed", speed: 1 }],
    errors: [
      'clock must be paper, wall or free in this file, not "sun" (in the address)',
      't must be a number, not "noon" (in the address)',
      'follow must be directed, leader, free, 1 or 2, not "3" (in the address)',
      "position must be three numbers, x, y and z in metres, from −100 to 100, not [1,2] (in the address)",
      'theme must be light or dark, not "red" (in the address)',
      'play must be 1 or have no value, not "no" (in the address)',
    ],
  });
});
