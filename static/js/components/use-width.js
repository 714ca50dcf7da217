// The width of an element, for drawings that fill it.
import { useLayoutEffect, useRef, useState } from "preact/hooks";

/** [ref, width in px], 0 until it is measured. @returns {[{ current: any }, number]} */
export function useWidth() {
  /** @type {{ current: any }} */
  const host = useRef(null);
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const watcher = new ResizeObserver(([{ contentRect }]) => setWidth(Math.round(contentRect.width)));
    watcher.observe(host.current);
    return () => watcher.disconnect();
  }, []);
  return [host, width];
}
