"""A room at 320 px, on a phone that turns, in type of 200 %, and in forced colours."""

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, expect

from tests.browser.poor_windows import PoorWindow, each_poor_window, problems_in
from tests.browser.rooms import PUBLIC_URL, TOKEN, RoomPage, phone
from tests.browser.serving import serving
from tests.browser.test_room import LESSON
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)


def can_be_used(page: RoomPage, main: Callable[[PoorWindow], list[Locator]]) -> None:
    """Check every poor window; what is main is seen whole, once it is scrolled to."""
    problems = dict[str, list[str]]()
    for window in each_poor_window(page.page):
        if unusable := problems_in(page.page, window):
            problems[window.name] = unusable
        for what in main(window):
            what.evaluate("what => what.scrollIntoView({block: 'center'})")
            box = what.bounding_box()
            assert box is not None, window
            assert box["x"] >= 0, window
            assert box["x"] + box["width"] <= window.size["width"], window
            expect(what).to_be_in_viewport(
                ratio=0.9 if box["height"] < window.size["height"] else 0.5
            )
    assert problems == {}


def test_a_room_can_be_used(flat_browser: Browser, tmp_path: Path) -> None:
    with (
        serving(tmp_path, token=TOKEN, public_url=PUBLIC_URL) as school,
        school.api(TOKEN) as api,
        phone(flat_browser) as teacher,
        phone(flat_browser) as pupil,
        new_page(flat_browser) as screen,
    ):
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        teacher.page.goto(f"{school.address}?token={TOKEN}")
        teacher.enter(school, code)
        projector = RoomPage(screen, has_3d=False)
        screen.context.add_cookies(teacher.page.context.cookies())  # type: ignore[arg-type]
        projector.enter(school, code, "?projector")

        # The lobby.
        pupil.enter(school, code)
        expect(pupil.button("Join")).to_be_visible()
        can_be_used(pupil, lambda _: [pupil.button("Join")])
        can_be_used(projector, lambda _: [screen.locator(".code"), screen.locator(".shown-card")])

        # A question, with an answer that is not locked yet.
        pupil.press("Join")
        answer = pupil.page.get_by_label("Your prediction")
        answer.fill("0.45")
        lock = pupil.button("Lock my prediction, and go")
        can_be_used(pupil, lambda _: [answer, lock])
        pupil.press("Lock my prediction, and go")
        expect(pupil.distance).to_be_visible()
        can_be_used(pupil, lambda _: [pupil.distance])
        reveal = teacher.button("Reveal")
        can_be_used(teacher, lambda _: [reveal, teacher.button("Freeze all")])
        can_be_used(projector, lambda _: [screen.locator(".code"), screen.locator(".shown-card")])

        # The reveal.
        teacher.press("Reveal")
        expect(pupil.page.locator(".own-dot")).to_have_count(1)
        can_be_used(pupil, lambda _: [pupil.page.locator(".own-dot")])
        can_be_used(projector, lambda _: [screen.locator(".code"), screen.locator(".act-place")])
        can_be_used(teacher, lambda _: [teacher.button("Next: One run")])
        teacher.page.locator(".code-button").tap()
        expect(teacher.page.locator(".large-code")).to_be_visible()
        can_be_used(teacher, lambda _: [])
        assert projector.complaints == []
