// Frames as the server encodes them, without messages.

/** The figures of each frame. */
export const FIGURES = { kind: "race", phase: "race", run_id: "a", label: "A", time_s: 0, computed_s: 0, lanes: [] };

/** Frames as the server encodes them. @param {number[]} times_s */
export function encoded(...times_s) {
  const frames = times_s.map((time_s) => (
    { time_s, follow: { leader: [time_s, time_s], 2: [1, time_s] }, scene: FIGURES, messages: [] }
  ));
  const head = new TextEncoder().encode(JSON.stringify({ lengths: [], world: "/world", frames }));
  const data = new Uint8Array(4 + head.length);
  new DataView(data.buffer).setUint32(0, head.length, true);
  data.set(head, 4);
  return data;
}

/** The same as they are pushed: compressed, in base 64. @param {number[]} times_s */
export async function pushed(...times_s) {
  const bytes = new Blob([encoded(...times_s)]).stream().pipeThrough(new CompressionStream("gzip"));
  return btoa(String.fromCharCode(...new Uint8Array(await new Response(bytes).arrayBuffer())));
}
