"""Promise 8: a slow viewer harms no one: with 20 stalled ones memory stays flat, and the others
lose less than 5 % of their frames.

In full by `make soak`, in two minutes. The gate's shorter form takes 3 s, and since it shares the
machine with other tests it requires that the others get frames: without back-pressure per viewer
they would get none.
"""

import httpx2
import pytest

from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.promises.raw import watched_memory
from tests.promises.test_07_many_viewers import start_moving, watch

STALLED = 20
OTHERS = 10
SECONDS = at_length(3.0, 60.0)
MIN_SHARE = at_length(0.0, 0.95)
FLAT_BYTES = 20_000_000


@pytest.mark.timeout(600)
def test_stalled_viewers_cost_the_others_no_frames_and_the_server_no_memory(
    server: Serving,
) -> None:
    start_moving(server)
    frames_alone = watch(server, OTHERS, SECONDS)["frames_per_s_median"] if MIN_SHARE > 0 else 0.0
    with watched_memory(server.pid) as memory:
        with_stalled = watch(server, OTHERS, SECONDS, STALLED)

    assert with_stalled["viewers_lost"] == 0
    frames = with_stalled["frames_per_s_median"]
    assert frames > 0
    assert frames_alone > 0 or MIN_SHARE == 0
    assert frames >= MIN_SHARE * frames_alone
    assert memory.grown_bytes < FLAT_BYTES
    merged = next(
        line
        for line in httpx2.get(f"{server.address}metrics").text.splitlines()
        if line.startswith("hexapods_frames_merged_total ")
    )
    assert float(merged.split()[1]) > 0
