// A panel whose module is loaded when the panel comes near the window.
import { useEffect, useRef, useState } from "preact/hooks";
import { html } from "./elements.js";

const NEAR = "300px";

/**
 * @param {object} props
 * @param {string} props.title of the panel, which stands there while it loads
 * @param {string} [props.style] its class
 * @param {() => Promise<(props: any) => any>} props.load resolves to the component of what the panel shows
 */
export function LazyPanel({ title, style = "", load }) {
  const panel = useRef(/** @type {HTMLElement | null} */ (null));
  const [loaded, setLoaded] = useState(/** @type {{ Content: any } | null} */ (null));
  const [hasFailed, setFailed] = useState(false);
  const [isNear, setNear] = useState(false);
  useEffect(() => {
    const watcher = new IntersectionObserver((entries) => setNear(entries.at(-1)?.isIntersecting ?? false), {
      rootMargin: NEAR,
    });
    if (panel.current) watcher.observe(panel.current);
    return () => watcher.disconnect();
  }, []);
  useEffect(() => {
    if (isNear && !loaded) load().then((Content) => setLoaded({ Content }), () => setFailed(true));
  }, [isNear]);
  const id = `${title.toLowerCase().replaceAll(" ", "-")}-panel`;
  return html`
    <section class=${`panel chart ${style}`} aria-labelledby=${id} ref=${panel}>
      <h2 id=${id}>${title}</h2>
      ${loaded && html`<${loaded.Content} isNear=${isNear} />`}
      ${hasFailed && !loaded && html`<p role="alert">This could not be loaded. Load the page again.</p>`}
    </section>
  `;
}
