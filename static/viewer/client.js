// Preparations of viser's client that every page with it needs before it runs.
(() => {
  "use strict";

  // ---- the Content-Security-Policy forbids code from strings. viser's sorter of Gaussian splats makes
  // some when it loads; as the stage has no splats, it gets functions that do nothing
  window.Function = new Proxy(Function, {
    apply: () => () => () => {},
    construct: () => () => () => {},
  });

  // ---- the client reconnects only while it has the focus, which an iframe may never get
  document.hasFocus = () => !document.hidden;
  document.addEventListener("visibilitychange", () => dispatchEvent(new Event("focus")));
})();
