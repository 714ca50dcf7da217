"""Promise 8: a slow viewer harms no one: with 20 stalled ones memory stays flat, and the others
lose less than 5 % of their frames.

In full by `make soak`, in two minutes. The gate's shorter form takes 6 s, and since the machine
may be busy otherwise it lets the others lose half of their frames: without back-pressure per
viewer they would get none.
"""

import httpx2
import pytest

from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.promises.raw import watched_memory
from tests.promises.test_07_many_watch import start_moving, watch

STALLED = 20
OTHERS = 10
SECONDS = at_length(3.0, 60.0)
MOST_LOST = at_length(0.5, 0.05)
FLAT_BYTES = 20_000_000


@pytest.mark.timeout(600)
def test_stalled_viewers_cost_the_others_no_frames_and_the_server_no_memory(
    server: Serving,
) -> None:
    start_moving(server)
    alone = watch(server, OTHERS, SECONDS)
    with watched_memory(server.pid) as memory:
        with_stalled = watch(server, OTHERS, SECONDS, STALLED)

    assert with_stalled["viewers_lost"] == 0
    assert with_stalled["frames_per_s_median"] >= (1 - MOST_LOST) * alone["frames_per_s_median"] > 0
    assert memory.grown_bytes < FLAT_BYTES
    merged = next(
        line
        for line in httpx2.get(f"{server.address}metrics").text.splitlines()
        if line.startswith("hexapods_frames_merged_total ")
    )
    assert float(merged.split()[1]) > 0
