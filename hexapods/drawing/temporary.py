"""Scene nodes that come and go together."""

import viser


class Temporary:
    """Scene nodes under one frame, which are all drawn anew when their content changes."""

    def __init__(self, server: viser.ViserServer, root: str, x_m: float = 0.0) -> None:
        self._server, self._root, self._x_m = server, root, x_m
        self._shown: tuple[object, ...] = ()
        self._frame: viser.FrameHandle | None = None

    def _begin(self, content: tuple[object, ...]) -> bool:
        """Remove the drawn nodes if the content has changed; True if the caller is to draw it."""
        if content == self._shown:
            return False
        if self._frame is not None:
            self._frame.remove()
            self._frame = None
        self._shown = content
        if content:
            self._frame = self._server.scene.add_frame(
                self._root, show_axes=False, position=(self._x_m, 0.0, 0.0)
            )
        return bool(content)
