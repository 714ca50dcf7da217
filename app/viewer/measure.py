"""What one update of the stage costs, as a viewer's connection sees it."""

import statistics
import threading
import time

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from app.assembly import build_walkers
from app.runs.config import LaneConfig, RaceConfig
from app.runs.racing import record_race
from app.services.casting import PAPERS_LANES, race_cast
from app.services.show import Billing
from app.services.show_race import RaceShow
from app.viewer.loopback import loopback_viser
from app.viewer.scene import StageScene
from app.viewer.wire import SUBPROTOCOL

_BETWEEN_S = 1 / 60
_SETTLED_S = 0.5


def measure_stage_update(updates: int = 200) -> tuple[float, float]:
    """Milliseconds to make, and bytes to send, one update with three robots that walk.

    Each is the median over updates that a real client on loopback receives; the time is that of
    the drawing thread from the stage's frame to viser's queue.

    Args:
        updates: how many are measured.
    """
    show = _walking_show()
    with loopback_viser() as server, _Receiver(server.get_port()) as receiver:
        scene = StageScene(server)
        scene.draw(show.frame(Billing(None, "Race")), now=0.0)
        receiver.wait_until_quiet()
        spent_ms = []
        for number in range(1, updates + 1):
            began = time.perf_counter()
            show.seek(1.0 + 10.0 * number / updates)
            scene.draw(show.frame(Billing(None, "Race")), now=number * _BETWEEN_S)
            spent_ms.append(1000 * (time.perf_counter() - began))
            time.sleep(_BETWEEN_S)
        receiver.wait_until_quiet()
        sizes = receiver.sizes[-updates:]
    return statistics.median(spent_ms), statistics.median(sizes)


def _walking_show() -> RaceShow:
    """A race without thinking, so that every robot moves in every frame."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(gait="left-right-origin", simulator="kinematic", lanes=lanes)
    walkers = build_walkers(config, [None] * len(lanes))
    recorded = list(record_race(walkers, config, time.perf_counter))[-1]
    show = RaceShow(race_cast(config), config.steps, "free", lambda: recorded)
    show.advance(0.0, None, over=True)
    return show


class _Receiver:
    """A viewer that only counts what it gets."""

    def __init__(self, port: int) -> None:
        self.sizes: list[int] = []
        self._socket = connect(
            f"ws://127.0.0.1:{port}/",
            subprotocols=[Subprotocol(SUBPROTOCOL)],
            compression=None,
            max_size=None,
            proxy=None,
        )
        self._thread = threading.Thread(target=self._receive, daemon=True)

    def __enter__(self) -> "_Receiver":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._thread.join()

    def wait_until_quiet(self) -> None:
        """Wait until nothing has come for a while."""
        before = -1
        while before != len(self.sizes):
            before = len(self.sizes)
            time.sleep(_SETTLED_S)

    def _receive(self) -> None:
        try:
            while True:
                self.sizes.append(len(self._socket.recv(decode=False)))
        except ConnectionClosed:
            return
