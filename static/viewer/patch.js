// Patch of viser's client: runs before it on the page /viewer/, which the dashboard has in an iframe, after client.js.
// Assumptions about the client are listed and tested in hexapods/drawing/viser_internals.
//
//   from the parent   {type: "hexapods:show", view?: "leader" | a lane from "1" | "free", theme?: "light" | "dark"}
//                     view "elsewhere": the parent draws by itself (labels.js), and the stream is left out
//   to the parent     {type: "hexapods:status", status: "connected" | "reconnecting" | "full" | "address full" |
//                      "place taken"}
//                     {type: "hexapods:key", key, code, shiftKey}
(() => {
  "use strict";

  const root = document.documentElement;
  const query = new URLSearchParams(location.search);
  let view = query.get("view") ?? "leader";
  let socketWorker = null;
  let isConnecting = false;
  // Close reasons of the hub that refuse a viewer. viser's client tries again all the same.
  const REFUSALS = ["full", "address full", "place taken"];

  const tellParent = (message) => {
    if (parent !== window) parent.postMessage(message, location.origin);
  };

  // ---- messages from the parent
  const setTheme = (theme) => {
    if (theme === "light" || theme === "dark") root.dataset.theme = theme;
  };
  const setView = (newView) => {
    if (typeof newView !== "string") return;
    view = newView;
    sendView();
  };
  addEventListener("message", ({ origin, source, data }) => {
    if (origin !== location.origin || source !== parent) return;
    if (data?.type !== "hexapods:show" && data?.type !== "hexapods:draw") return;
    dispatchEvent(new CustomEvent(data.type, { detail: data })); // for labels.js
    if (data.type === "hexapods:draw") return;
    setTheme(data.theme);
    setView(data.view);
    root.toggleAttribute("data-projected", data.isProjected === true);
  });
  setTheme(query.get("theme"));

  // ---- viser's websocket lives in a worker, through which the view is sent to the hub
  const sendView = () =>
    socketWorker?.postMessage({ type: "send", message: { type: "FollowMessage", view } });

  const socketAddress = () => {
    const address = new URL(location.pathname, location.href);
    address.protocol = location.protocol.replace("http", "ws");
    address.searchParams.set("view", view);
    return address.href;
  };

  const onSocket = ({ data }) => {
    if (data.type === "connected" || data.type === "closed") isConnecting = false;
    if (data.type === "connected") {
      // A reconnection uses the first address, and the view may have changed since.
      sendView();
      tellParent({ type: "hexapods:status", status: "connected" });
    } else if (data.type === "closed") {
      if (data.versionMismatch) reloadOnce();
      const status = REFUSALS.includes(data.closeReason) ? data.closeReason : "reconnecting";
      tellParent({ type: "hexapods:status", status });
    }
  };

  /** Leave out frames of the stage that were on their way; the client waits for the end of the backlog. */
  const dropElsewhere = ({ data }) => {
    if (data?.type !== "message_batch" || view !== "elsewhere") return;
    data.messages = data.messages.filter(({ type }) => type === "ReplayDoneMessage");
  };

  // The server has been upgraded under this page; but never reload in a loop.
  const reloadOnce = () => {
    const last = Number(sessionStorage.getItem("hexapods:reloaded"));
    if (Date.now() - last < 60_000) return;
    sessionStorage.setItem("hexapods:reloaded", String(Date.now()));
    location.reload();
  };

  window.Worker = class extends Worker {
    constructor(...args) {
      super(...args);
      // Before the listeners of the labels and of the client, which get the same object.
      this.addEventListener("message", dropElsewhere);
    }

    postMessage(message, ...rest) {
      // The client gives up an attempt after a second. After many that failed browsers begin the next one
      // later than that, so that none would succeed; the worker gives them up after five.
      if (message?.type === "retry" && isConnecting) return;
      if (message?.type === "retry" || message?.type === "set_server") isConnecting = true;
      if (message?.type !== "set_server") {
        super.postMessage(message, ...rest);
        return;
      }
      socketWorker = this;
      this.addEventListener("message", onSocket);
      // Ignore the query's `websocket`: a stream from elsewhere could run scripts here.
      super.postMessage({ ...message, server: socketAddress() }, ...rest);
    }
  };

  // ---- in a picture that is narrower than 16:9 the camera sees more above and below, so that no lane is cut off
  const WIDE = 16 / 9;
  const WIDEST_DEG = 80;
  let fitted = null;
  let base = null;
  const fit = () => {
    const { camera, canvas, requestRender } = window.__viserMutable ?? {};
    if (!camera?.isPerspectiveCamera || !canvas?.clientHeight) return;
    // What is not ours, the stage has set.
    if (camera.fov !== fitted) base = camera.fov;
    const factor = Math.max(1, WIDE / (canvas.clientWidth / canvas.clientHeight));
    const half = Math.atan(Math.tan((base * Math.PI) / 360) * factor);
    const wanted = Math.min((half * 360) / Math.PI, Math.max(base, WIDEST_DEG));
    if (camera.fov === wanted) return;
    camera.fov = fitted = wanted;
    camera.updateProjectionMatrix();
    requestRender?.();
  };
  addEventListener("resize", () => setTimeout(fit, 50));
  setInterval(fit, 400);

  // ---- the dashboard's shortcuts work while the viewer has the focus
  addEventListener("keydown", (event) => {
    const { key, code, shiftKey } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
    if (event.target.closest?.("input, textarea, select, [contenteditable]")) return;
    if (key.length === 1 || key === "Escape") {
      tellParent({ type: "hexapods:key", key, code, shiftKey });
    }
  });
})();
