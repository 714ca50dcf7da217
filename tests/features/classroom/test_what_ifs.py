"""What-ifs of cards: whose allowance they use, and a server that has left out their feature."""

from pathlib import Path

import pytest

from app.features.classroom.what_ifs import WhatIfs
from app.settings import read_settings
from app.storage.errors import NotFound
from hexapods.runs.config import training_config
from tests.api.conftest import running

TOKEN = "a-token-for-tests"


def test_without_the_feature_a_card_that_asks_a_what_if_is_refused() -> None:
    with pytest.raises(NotFound, match="answers no what-ifs"):
        WhatIfs(None).ask(training_config(gait="left-right-origin", steps=5), "a client")


def test_a_seat_has_one_allowance_whatever_other_cookies_are_sent(tmp_path: Path) -> None:
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    card = {"text": "What if?", "state": {"form": {"steps": 5}}, "go": "what-if"}
    lesson = {"title": "x", "cards": [card]}
    settings = read_settings({}, data=tmp_path, token=TOKEN, what_ifs_per_minute=1)
    with running(settings) as api:
        codes, cookies = [], []
        for _ in range(2):
            opened = api.call("POST", "/rooms", json={"lesson": lesson}, headers=bearer).json()
            api.client.cookies.clear()
            joined = api.call("POST", f"/rooms/{opened['code']}/participants", json={})
            codes.append(opened["code"])
            cookies.append(joined.headers["set-cookie"].partition(";")[0])
        api.client.cookies.clear()

        def ask(code: str, *sent: str) -> int:
            headers = {"cookie": "; ".join(sent)}
            return api.call("POST", f"/rooms/{code}/runs", json={}, headers=headers).status_code

        assert ask(codes[0], *cookies) == 200
        assert [ask(codes[0], *cookies[::-1]), ask(codes[0], cookies[0])] == [429, 429]
        assert ask(codes[1], *cookies) == 200
