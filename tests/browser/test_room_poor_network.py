"""A whole lesson on phones whose network is slow, and gone again and again."""

import re
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect
from playwright.sync_api import TimeoutError as NotInTime

from tests.browser.rooms import PHONE, TOKEN, RoomPage
from tests.browser.serving import serving
from tests.conftest import new_page
from tests.promises.length import at_length

pytestmark = pytest.mark.timeout(400)

PUPILS = at_length(2, 4)
SLOW = {"offline": False, "latency": 300, "downloadThroughput": 60_000, "uploadThroughput": 20_000}
GONE = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
FORM = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 60}
NUMBER = {"kind": "number", "text": "How far?", "minimum": -1, "maximum": 2, "unit": "m"}
LESSON: dict[str, Any] = {
    "title": "On a train",
    "cards": [
        {"title": "One", "text": "Go.", "state": {"form": FORM}, "ask": NUMBER, "go": "training"},
        {
            "title": "Thirty",
            "text": "How long?",
            "state": {"form": FORM},
            "may": {"steps": {"maximum": 200}},
            "go": "what-if",
        },
    ],
}


class Phone:
    """A phone on a poor network.

    Attributes:
        room: its page.
        who: name and seed, once it has joined.
    """

    def __init__(self, room: RoomPage) -> None:
        self.room, self.who = room, ("", -1)
        self._session = room.page.context.new_cdp_session(room.page)
        self._session.send("Network.enable")
        self.reach(SLOW)

    def reach(self, network: dict[str, Any]) -> None:
        """Put the phone on a network."""
        self._session.send("Network.emulateNetworkConditions", network)


def test_nobody_loses_anything_on_a_poor_network(flat_browser: Browser, tmp_path: Path) -> None:
    with (
        ExitStack() as stack,
        serving(tmp_path, token=TOKEN) as school,
        school.api(TOKEN) as api,
    ):
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        phones = []
        for _ in range(PUPILS):
            page = stack.enter_context(
                new_page(flat_browser, viewport=PHONE, has_touch=True, is_mobile=True)
            )
            phones.append(Phone(RoomPage(page, has_3d=False)))
        for phone in phones:
            phone.room.enter(school, code)
            # The first press does not get through.
            phone.reach(GONE)
            phone.room.press("Join")
            expect(
                phone.room.page.get_by_role("alert").filter(has_text=re.compile("."))
            ).to_be_visible()
            phone.reach(SLOW)
            phone.room.press("Join")
            phone.who = phone.room.who
        assert sorted(phone.who[1] for phone in phones) == list(range(PUPILS))
        for number, phone in enumerate(phones):
            phone.room.page.get_by_label("Your prediction").fill(str(number / 10))
            phone.room.press("Lock my prediction, and go")
            phone.room.sees("Locked.")
            if number % 2:
                phone.reach(GONE)
        for phone in phones:
            phone.reach(SLOW)
        api.post(f"rooms/{code}/reveal", json={}).raise_for_status()
        for phone in phones:
            phone.room.page.reload()
            assert phone.room.who == phone.who
            # The start went with the lock, or was lost with the network: then it is pressed again.
            start = phone.room.button("Go: let it practise")
            expect(start.or_(phone.room.distance).first).to_be_visible()
            with suppress(NotInTime):  # the run was told of meanwhile
                start.tap(timeout=3_000)
            expect(phone.room.distance).to_be_visible()
        api.put(f"rooms/{code}/card", json={"card": 1}).raise_for_status()
        for phone in phones:
            phone.room.press("Go: try it on thirty robots")
            expect(phone.room.page.get_by_role("region", name="Thirty robots")).to_be_visible()
        results = api.get(f"rooms/{code}/results").json()["cards"]
        view = api.get(f"rooms/{code}").json()
        assert view["participants"] == PUPILS
        assert [person["name"] for person in view["people"]] == [
            phone.who[0] for phone in sorted(phones, key=lambda phone: phone.who[1])
        ]
        assert [entry["prediction"] for entry in results[0]["entries"]] == [
            next(n / 10 for n, phone in enumerate(phones) if phone.who[1] == seed)
            for seed in range(PUPILS)
        ]
        for card in results:
            assert card["finished"] == PUPILS
