"""A server that is killed while it judges goes on: nothing is lost, and the ranking is the same.

Ten kills at random moments, 2 in the gate. What was judged stays judged; in the end the file
repeats to the last digit: each judgement is that of an unbroken tournament.
"""

import random
import signal
import time
from collections.abc import Callable
from typing import Any

import pytest

from hexapods.tournaments.tournament_file import read_file
from hexapods.tournaments.verification import verify
from tests.promises.length import at_length
from tests.served import Served
from tests.timeouts import ProgressTimeout

KILLS = at_length(2, 10)
RULES: dict[str, Any] = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": at_length(200, 400),
    "draws": 10,
}
ALPHAS = (0.1, 0.3, 0.5)


def look(served: Served, path: str) -> dict[str, Any]:
    answer = served.client.get(path)
    assert answer.status_code == 200, answer.text
    view: dict[str, Any] = answer.json()
    return view


def judged(view: dict[str, Any]) -> list[int]:
    return [entry["judged"] for entry in view["entries"]]


@pytest.mark.timeout(60 * KILLS + 300)
def test_a_tournament_goes_on_after_kills(launch: Callable[..., Served]) -> None:
    chance = random.Random(42)
    served = launch()
    body = {"rules": RULES, "title": "Killed"}
    opened = served.client.post("/api/v1/tournaments", json=body)
    assert opened.status_code == 201, opened.text
    path = f"/api/v1/tournaments/{opened.json()['id']}"
    for alpha in ALPHAS:
        entry = {"agent": "q-learning", "settings": {"alpha": alpha}}
        assert served.client.post(f"{path}/entries", json=entry).status_code == 202
    counts = [0] * (3 + len(ALPHAS))
    for _ in range(KILLS):
        stall_check, wanted = ProgressTimeout(), sum(counts) + chance.randrange(1, 8)
        while sum(counts) < wanted and sum(counts) < 10 * len(counts):
            counts = judged(look(served, path))
            stall_check.check(counts)
            time.sleep(0.01)
        time.sleep(chance.uniform(0, 0.1))
        served.end(signal.SIGKILL)
        served = launch()
        after = look(served, path)
        assert [entry["entry"]["settings"].get("alpha") for entry in after["entries"][3:]] == [
            *ALPHAS
        ]
        assert all(now >= before for now, before in zip(judged(after), counts, strict=True))
        assert after["commitment"] == opened.json()["commitment"]
    # Ended, and killed once more before the last is judged.
    assert served.client.post(f"{path}/end").status_code == 200
    served.end(signal.SIGKILL)
    served = launch()
    stall_check = ProgressTimeout()
    while (view := look(served, path))["state"] != "ended":
        stall_check.check(judged(view))
        time.sleep(0.05)
    assert judged(view) == [10] * len(counts)
    file = read_file(served.client.get(f"{path}/file").content, "the file")
    assert verify(file, workers=1) == []
