// Ties viser's client to the page of a file, which has it in a frame (js/offline/view-frame.js). Runs after client.js,
// before the client. Assumptions about the client are listed and tested in hexapods/drawing/viser_internals.
//
//   from the parent   {type: "hexapods:draw", messages: of viser}
//                     {type: "hexapods:show", theme?: "light" | "dark", and what camera.js and labels.js have}
//                     {type: "hexapods:still"}: asks for the picture
//   to the parent     {type: "hexapods:status", status: "connected" when it can draw, "drawn" when it shows something,
//                     "lost" when the browser has taken its WebGL context, "no-webgl" where there is none}
//                     {type: "hexapods:still", picture: ImageBitmap, horizon, camera: {position, look_at, fov}},
//                     places in metres, the angle from top to bottom in radians
//                     {type: "hexapods:taken"}: the viewer has taken the camera, by hand
//                     {type: "hexapods:key", key}
(() => {
  "use strict";

  const root = document.documentElement;
  const PICTURES = 2;
  /** The page around this one may be a file, whose origin has no name; nothing that is told here is a secret. */
  const tellParent = (message, transfer = []) => parent.postMessage(message, "*", transfer);
  const tellStatus = (status) => tellParent({ type: "hexapods:status", status });

  // ---- the drawing buffer is kept, so that there is a picture also when none is drawn: out of sight
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function getContextThatKeeps(type, options) {
    if (!type.startsWith("webgl")) return getContext.call(this, type, options);
    return getContext.call(this, type, { ...options, preserveDrawingBuffer: true });
  };
  if (!getContext.call(document.createElement("canvas"), "webgl2")) tellStatus("no-webgl");
  addEventListener("webglcontextlost", () => tellStatus("lost"), { capture: true });

  // The client's y is up, and its x is against the track.
  const inRun = ({ x, y, z }) => [-z, -x, y];
  const tellStill = async () => {
    const { canvas, camera, cameraControl } = window.__viserMutable ?? {};
    if (!canvas?.width || !camera) return;
    const target = cameraControl.getTarget(camera.position.clone());
    const fov = (camera.fov * Math.PI) / 180;
    const places = { position: inRun(camera.position), look_at: inRun(target), fov };
    const horizon = root.style.getPropertyValue("--horizon");
    const picture = await createImageBitmap(canvas);
    tellParent({ type: "hexapods:still", picture, horizon, camera: places }, [picture]);
  };

  // ---- the first picture
  const afterPictures = (number, act) =>
    requestAnimationFrame(() => (number > 0 ? afterPictures(number - 1, act) : act()));
  const awaitPicture = () => {
    const queue = window.__viserMutable?.messageQueue;
    if (!queue || queue.length) requestAnimationFrame(awaitPicture);
    else afterPictures(PICTURES, () => tellStatus("drawn"));
  };
  addEventListener("hexapods:draw", awaitPicture, { once: true });

  addEventListener("message", ({ source, data }) => {
    if (source !== parent) return;
    if (data?.type === "hexapods:still") tellStill();
    if (!["hexapods:show", "hexapods:draw"].includes(data?.type)) return;
    if (data.theme === "light" || data.theme === "dark") root.dataset.theme = data.theme;
    dispatchEvent(new CustomEvent(data.type, { detail: data })); // for the scripts that follow
  });
  addEventListener("hexapods:connected", () => tellStatus("connected"));
  addEventListener("hexapods:taken", () => tellParent({ type: "hexapods:taken" }));
  addEventListener("keydown", ({ key, ctrlKey, altKey, metaKey }) => {
    if (!ctrlKey && !altKey && !metaKey && key.length === 1) tellParent({ type: "hexapods:key", key });
  }, { capture: true });
})();
