"""Promise 8: a slow viewer harms no one: with 20 stalled ones memory stays flat, and the others
have the frames of every moment before it is shown, but for 1 % of the time at most.

In full by `make soak`, in two minutes. The gate's shorter form takes 3 s, and since it shares the
machine with other tests it requires that the others get pieces: without back-pressure per viewer
they would get none.
"""

import pytest

from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.promises.raw import watched_memory
from tests.promises.test_07_many_viewers import MAX_GAP_SHARE, start_moving, watch

STALLED = 20
OTHERS = 10
SECONDS = at_length(3.0, 60.0)
FLAT_BYTES = 20_000_000


@pytest.mark.timeout(600)
def test_stalled_viewers_cost_the_others_no_frames_and_the_server_no_memory(
    server: Serving,
) -> None:
    start_moving(server)
    with watched_memory(server.pid) as memory:
        with_stalled = watch(server, OTHERS, SECONDS, STALLED)

    assert with_stalled["viewers_lost"] == 0
    assert with_stalled["pieces_lowest"] > 0
    assert with_stalled["gap_share"] < MAX_GAP_SHARE
    assert memory.grown_bytes < FLAT_BYTES
