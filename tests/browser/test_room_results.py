"""Results in a room's page: a what-if that is kept, and participants who must be approved."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.rooms import SCREEN, TOKEN, RoomPage, phone
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(400)

FORM = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 60}
NUMBER = {"kind": "number", "text": "How far?", "minimum": -1, "maximum": 2, "unit": "m"}
WHAT_IF = {
    "title": "Thirty robots",
    "text": "Choose how long they practise.",
    "state": {"form": FORM},
    "may": {"steps": {"minimum": 20, "maximum": 200}},
    "go": "what-if",
}
TRAINING = {"title": "One", "text": "Go.", "state": {"form": FORM}, "ask": NUMBER, "go": "training"}


@pytest.fixture
def school(tmp_path: Path) -> Iterator[Serving]:
    with serving(tmp_path, token=TOKEN) as server:
        yield server


def open_room(school: Serving, *cards: Any, needs_approval: bool = False) -> str:
    """Open a room, and return its code."""
    lesson = {"title": "Results", "cards": list(cards)}
    with school.api(TOKEN) as api:
        body = {"lesson": lesson, "needs_approval": needs_approval}
        return str(api.post("rooms", json=body).raise_for_status().json()["code"])


def teach(teacher: RoomPage, school: Serving, code: str) -> None:
    """Open the cockpit as the operator."""
    teacher.page.goto(f"{school.address}?token={TOKEN}")
    teacher.enter(school, code)


def test_a_what_if_is_there_after_a_reload(flat_browser: Browser, school: Serving) -> None:
    code = open_room(school, WHAT_IF)
    with (
        phone(flat_browser) as teacher,
        phone(flat_browser) as first_pupil,
        phone(flat_browser) as second_pupil,
    ):
        teach(teacher, school, code)
        for pupil in (first_pupil, second_pupil):
            pupil.enter(school, code)
            pupil.press("Join")
        first_pupil.page.get_by_role("textbox", name=re.compile("steps", re.IGNORECASE)).fill("120")
        first_pupil.press("Go: try it on thirty robots")
        thirty = first_pupil.page.get_by_role("region", name="Thirty robots")
        expect(thirty).to_contain_text("With these settings")
        before = thirty.inner_text()
        # What was asked already is not offered again until the settings differ.
        expect(first_pupil.button("Go again with these settings")).to_have_count(0)
        first_pupil.page.reload()
        expect(thirty).to_have_text(re.compile(r"With these settings: typically"))
        assert thirty.inner_text() == before
        figures = teacher.page.get_by_label("How far the class is")
        expect(figures).to_have_text(re.compile(r"joined2\s*started1\s*finished1"))
        teacher.sees("went")
        teacher.press("Reveal")
        second_pupil.sees("1 seed")
        expect(second_pupil.page.get_by_role("region", name="Thirty robots")).to_have_count(0)
        first_pupil.sees("Rank 1 of 1 seed")
        assert first_pupil.violations_in_both_themes() == []


def test_what_is_not_approved_is_shown_to_nobody(flat_browser: Browser, school: Serving) -> None:
    code = open_room(school, TRAINING, needs_approval=True)
    with (
        phone(flat_browser) as teacher,
        phone(flat_browser) as first_pupil,
        phone(flat_browser) as second_pupil,
        new_page(flat_browser, viewport=SCREEN) as screen,
    ):
        teach(teacher, school, code)
        projector = RoomPage(screen, has_3d=False)
        screen.context.add_cookies(teacher.page.context.cookies())  # type: ignore[arg-type]
        projector.enter(school, code, "?projector")
        for pupil in (first_pupil, second_pupil):
            pupil.enter(school, code)
            pupil.press("Join")
            pupil.page.get_by_label("Your prediction").fill("0.3")
            pupil.press("Lock my prediction, and go")
            expect(pupil.distance).to_be_visible()
        name = second_pupil.who[0]
        teacher.press("Reveal")
        first_pupil.sees("Rank 1 of 1 seed")
        expect(screen.get_by_role("img", name="0 predictions: 0", exact=True)).to_be_visible()

        teacher.press(f"Approve {name}")
        expect(teacher.page.get_by_role("button", name=f"Approve {name}")).to_have_count(0)
        projector.sees("1 robot, typically")
        first_pupil.sees(re.compile(r"Rank [12] of 2 seeds"))
        second_pupil.sees("Rank 1 of 1 seed")
        assert teacher.violations_in_both_themes() == []
