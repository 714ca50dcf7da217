// Whether the picture can be drawn in 3D. Without WebGL the client is not loaded, and the page is told. After its
// context was lost this page loads anew: three.js makes its buffers again, but the client's instanced meshes would not
// be drawn any more, of no later run either. What is drawn the parent sends again.
//
//   to the parent  {type: "hexapods:status", status}: "flat" without WebGL; "lost" when the context was lost, and this
//                  page loads anew; "gone" where that has helped no more
(() => {
  "use strict";

  if (parent === window) return;

  /** A context that the browser does not restore within this time is replaced by that of a new page. */
  const RESTORED_WITHIN_MS = 1000;
  /** So many losses within this time are of a machine that cannot draw. */
  const [MOST_LOSSES, WITHIN_MS] = [3, 60_000];

  const tell = (status) => parent.postMessage({ type: "hexapods:status", status }, location.origin);

  // ---- what is kept when this page loads anew: when contexts were lost, and where the viewer has put the camera

  const kept = () => {
    try {
      return JSON.parse(decodeURIComponent(location.hash.slice(1)));
    } catch {
      return {};
    }
  };
  const { losses = [], camera: before = null } = kept();

  const hasWebGl = () => {
    const context = document.createElement("canvas").getContext("webgl2");
    // Browsers keep 16 contexts.
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return context !== null;
  };

  const isFailing = losses.filter((time) => Date.now() - time < WITHIN_MS).length >= MOST_LOSSES;
  if (isFailing || !hasWebGl()) {
    tell(losses.length > 0 ? "gone" : "flat");
    stop(); // the client, which is large, need not come
    return;
  }

  // ---- the camera, where the viewer has it: one that is directed is moved by camera.js in each picture

  const cameraNow = () => {
    const { camera, cameraControl } = window.__viserMutable ?? {};
    if (!camera || !cameraControl) return before;
    const target = cameraControl.getTarget(camera.position.clone());
    return { at: camera.position.toArray(), to: target.toArray() };
  };

  // The client puts its camera by itself while it makes its scene.
  const [HELD_MS, LEAST_PICTURES] = [2000, 8];
  let [isViewers, since, pictures] = [true, null, 0];
  const putBack = (now) => {
    const { cameraControl } = window.__viserMutable ?? {};
    if (cameraControl) {
      since ??= now;
      pictures += 1;
      if (isViewers) cameraControl.setLookAt(...before.at, ...before.to, false);
      if (!isViewers || (now - since > HELD_MS && pictures > LEAST_PICTURES)) return;
    }
    requestAnimationFrame(putBack);
  };
  if (before) {
    addEventListener("hexapods:show", ({ detail }) => {
      if (detail.shot) isViewers = false;
    });
    for (const type of ["pointerdown", "wheel", "keydown"]) {
      addEventListener(type, () => (isViewers = false), { capture: true, passive: true });
    }
    requestAnimationFrame(putBack);
  }

  // ---- a loss

  const whenSeen = (act) => {
    if (!document.hidden) act();
    else document.addEventListener("visibilitychange", () => whenSeen(act), { once: true });
  };

  let isLost = false;
  addEventListener("webglcontextlost", () => {
    if (isLost) return;
    isLost = true;
    tell("lost");
    const state = { losses: [...losses, Date.now()].slice(-MOST_LOSSES), camera: cameraNow() };
    let isLeaving = false;
    const leave = () => {
      if (isLeaving) return;
      isLeaving = true;
      history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(state))}`);
      location.reload();
    };
    addEventListener("webglcontextrestored", leave, { capture: true });
    // Systems take contexts of pages that are not seen.
    setTimeout(() => whenSeen(leave), RESTORED_WITHIN_MS);
  }, { capture: true });

  // The client asks for one context alone.
  addEventListener("webglcontextcreationerror", () => tell(losses.length > 0 ? "gone" : "flat"), { capture: true });
})();
