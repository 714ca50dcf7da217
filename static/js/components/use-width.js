// How wide a place is, for what is drawn in it.
import { useLayoutEffect, useRef, useState } from "preact/hooks";

/** [ref, width in px], 0 until it is known. */
export function useWidth() {
  const host = useRef(null);
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const watcher = new ResizeObserver(([{ contentRect }]) => setWidth(Math.round(contentRect.width)));
    watcher.observe(host.current);
    return () => watcher.disconnect();
  }, []);
  return [host, width];
}
