// The 3D view of the page of a file: viser's client in a frame of its own, which is there while it is in sight. A
// browser keeps 16 WebGL contexts, for all frames of a page together, and takes them from the oldest: a view out of
// sight gives its own back, with all that hangs on it, and its last picture stays.

/** After the frame was asked for its last picture, it is removed, whether that has come or not [ms]. */
const LAST_PICTURE_MS = 400;
/** A picture is kept when nothing has moved for so long; meshes are loaded by then [ms]. */
const SETTLED_MS = 1000;

/** @typedef {import("../replay-frames.js").Message} Message */
/** Where the camera is [m], and its angle from top to bottom [rad]. */
/** @typedef {{ position: number[], look_at: number[], fov: number }} Camera */

/**
 * Dispatches `connected` when a frame can draw, and has an empty scene; `drawn` when it shows something; `lost` when
 * the browser has taken its context; `unavailable` where there is no WebGL; `kept` when it has kept a picture and where
 * the camera was; `taken` and `key` (`detail`) as viewer/framed.js has them.
 */
export class ViewFrame extends EventTarget {
  /** @type {HTMLIFrameElement | null} */
  #frame = null;
  #isConnected = false;
  #isDrawn = false;
  #isInSight = false;
  /** Whether the browser has taken the context: it is asked for again when someone uses the view. */
  #isLost = false;
  #isAvailable = true;
  /** What the frame was last told to show: another one is told it again. @type {Record<string, unknown>} */
  #shown = {};
  #still = document.createElement("canvas");
  /** @type {Camera | null} */
  #camera = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #settling = undefined;

  /**
   * @param {string} page viser's client, HTML
   * @param {HTMLElement} poster what is shown until a picture is kept
   */
  constructor(page, poster) {
    super();
    this.page = page;
    this.poster = poster;
    this.#still.className = "still";
    this.#still.hidden = true;
  }

  /** Whether the view is drawn, and no picture of it shown. */
  get isLive() { return this.#isDrawn; }
  /** Whether the browser can draw it. */
  get isAvailable() { return this.#isAvailable; }
  /** Where the camera was when its last picture was kept; null if there is none. */
  get camera() { return this.#camera; }

  /** Show the view in a page as soon as it is in sight. @param {HTMLElement} body */
  open(body) {
    body.prepend(this.#still);
    addEventListener("message", (event) => this.#hear(event));
    // Also where the page is in a frame itself: what counts is the window.
    new IntersectionObserver((entries) => this.#see(entries[entries.length - 1].isIntersecting))
      .observe(document.documentElement);
  }

  /** @param {Message[]} messages */
  draw(messages) {
    if (this.#isConnected) this.#tell({ type: "hexapods:draw", messages });
  }

  /** @param {Record<string, unknown>} detail */
  show(detail) {
    this.#shown = { ...this.#shown, ...detail };
    if (this.#isConnected) this.#tell({ type: "hexapods:show", ...detail });
  }

  /** Keep a picture once nothing has moved for a while. */
  settle() {
    clearTimeout(this.#settling);
    this.#settling = setTimeout(() => this.#isDrawn && this.#tell({ type: "hexapods:still" }), SETTLED_MS);
  }

  /** Someone uses the view: draw it again if the browser has taken its context for others. */
  use() {
    this.#isLost = false;
    if (this.#isInSight) this.#start();
  }

  #see(/** @type {boolean} */ isInSight) {
    this.#isInSight = isInSight;
    if (isInSight) this.#start();
    else this.#stop();
  }

  #start() {
    if (this.#frame || this.#isLost || !this.#isAvailable) return;
    this.#frame = document.createElement("iframe");
    Object.assign(this.#frame, { className: "view", title: "The robots on the track, in 3D", srcdoc: this.page });
    document.body.prepend(this.#frame);
  }

  #stop() {
    const leaving = this.#frame;
    if (!leaving) return;
    this.#tell({ type: "hexapods:still" });
    setTimeout(() => {
      if (this.#frame === leaving && !this.#isInSight) this.#remove();
    }, this.#isDrawn ? LAST_PICTURE_MS : 0);
  }

  #remove() {
    this.#frame?.remove();
    this.#frame = null;
    this.#isConnected = this.#isDrawn = false;
  }

  #tell(/** @type {object} */ message) {
    // The frame's origin has no name where this page is a file; it is this page's own.
    this.#frame?.contentWindow?.postMessage(message, "*");
  }

  #hear(/** @type {MessageEvent} */ { source, data }) {
    if (!this.#frame || source !== this.#frame.contentWindow) return;
    if (data.type === "hexapods:still") this.#keep(data);
    else if (data.type === "hexapods:taken") this.dispatchEvent(new Event("taken"));
    else if (data.type === "hexapods:key") this.dispatchEvent(new CustomEvent("key", { detail: data.key }));
    else if (data.type === "hexapods:status") this.#change(data.status);
  }

  #change(/** @type {string} */ status) {
    if (status === "connected") {
      this.#isConnected = true;
      this.#tell({ type: "hexapods:show", ...this.#shown });
      this.dispatchEvent(new Event("connected"));
    } else if (status === "drawn") {
      this.#isDrawn = true;
      this.#frame?.classList.add("drawn");
      this.settle();
      this.dispatchEvent(new Event("drawn"));
    } else if (status === "lost") {
      this.#isLost = true;
      this.#remove();
      this.dispatchEvent(new Event("lost"));
    } else if (status === "no-webgl") {
      this.#isAvailable = false;
      this.#remove();
      this.dispatchEvent(new Event("unavailable"));
    }
  }

  #keep(/** @type {{ picture: ImageBitmap, horizon: string, camera: Camera }} */ { picture, horizon, camera }) {
    this.#camera = camera;
    document.documentElement.style.setProperty("--horizon", horizon);
    Object.assign(this.#still, { width: picture.width, height: picture.height });
    this.#still.getContext("bitmaprenderer")?.transferFromImageBitmap(picture);
    this.#still.hidden = false;
    this.poster.hidden = true;
    this.dispatchEvent(new Event("kept"));
    if (!this.#isInSight) this.#remove();
  }
}
