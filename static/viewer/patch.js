// Patch of viser's client: runs before it on the page /viewer/, which the dashboard has in an iframe, after client.js.
// Assumptions about the client are listed and tested in hexapods/drawing/viser_internals.
//
//   from the parent   {type: "hexapods:show", theme?: "light" | "dark", isProjected?, and what camera.js, legs.js and
//                     labels.js have}
//                     {type: "hexapods:draw", messages: of viser}
//                     {type: "hexapods:inspect"}, as inspection.js has it
//   to the parent     {type: "hexapods:status", status: "connected" when it can draw, "drawn" when it shows something}
//                     {type: "hexapods:taken"}: the viewer has taken the camera, by hand
//                     {type: "hexapods:key", key, code, shiftKey}
//                     {type: "hexapods:drag"} while files are dragged over the picture
(() => {
  "use strict";

  // By itself it would show nothing.
  if (parent === window) location.replace("../");

  const root = document.documentElement;
  const tellParent = (message) => parent.postMessage(message, location.origin);

  // ---- messages from the parent
  const setTheme = (theme) => {
    if (theme === "light" || theme === "dark") root.dataset.theme = theme;
  };
  addEventListener("message", ({ origin, source, data }) => {
    if (origin !== location.origin || source !== parent) return;
    if (!["hexapods:show", "hexapods:draw", "hexapods:inspect"].includes(data?.type)) return;
    dispatchEvent(new CustomEvent(data.type, { detail: data })); // for the scripts that follow
    if (data.type !== "hexapods:show") return;
    setTheme(data.theme);
    root.toggleAttribute("data-projected", data.isProjected === true);
  });
  setTheme(new URLSearchParams(location.search).get("theme"));
  addEventListener("hexapods:connected", () => tellParent({ type: "hexapods:status", status: "connected" }));

  // ---- the first picture: on a busy machine it comes seconds after the client is connected
  const PICTURES = 2;
  const afterPictures = (number, act) =>
    requestAnimationFrame(() => (number > 1 ? afterPictures(number - 1, act) : act()));
  let newest;
  const awaitPicture = () => {
    const queue = window.__viserMutable?.messageQueue;
    newest ??= queue?.at(-1);
    if (!queue || queue.includes(newest)) requestAnimationFrame(awaitPicture);
    // What the client has taken is in its next picture, with the camera where it belongs in the one after it.
    else afterPictures(PICTURES, () => tellParent({ type: "hexapods:status", status: "drawn" }));
  };
  addEventListener("hexapods:draw", () => requestAnimationFrame(awaitPicture), { once: true });

  addEventListener("hexapods:taken", () => tellParent({ type: "hexapods:taken" }));

  // ---- files that are dragged over the picture are dropped on the page, which covers it as soon as it knows
  for (const type of ["dragenter", "dragover", "drop"]) {
    addEventListener(type, (event) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      tellParent({ type: "hexapods:drag" });
    });
  }

  // ---- the dashboard's shortcuts work while the viewer has the focus, before camera.js keeps them from the client
  addEventListener("keydown", (event) => {
    const { key, code, shiftKey } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
    if (event.target.closest?.("input, textarea, select, [contenteditable]")) return;
    if (key.length === 1 || key === "Escape") {
      tellParent({ type: "hexapods:key", key, code, shiftKey });
    }
  }, { capture: true });
})();
