"""Participants of a room: the teacher removes them, and tries a room where no phone can come."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.dashboard import Dashboard
from tests.browser.rooms import PUBLIC_URL, TOKEN, RoomPage, is_accessible, phone
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

LESSON: dict[str, Any] = {
    "title": "How far?",
    "cards": [{"text": "Guess.", "ask": {"kind": "choice", "text": "?", "choices": ["A", "B"]}}],
}


@pytest.fixture
def school(tmp_path: Path) -> Iterator[Serving]:
    with serving(tmp_path, token=TOKEN, public_url=PUBLIC_URL) as server:
        yield server


@pytest.mark.test
def test_a_teacher_removes_somebody_whose_phone_says_so(
    flat_browser: Browser, school: Serving
) -> None:
    with school.api(TOKEN) as api, phone(flat_browser) as teacher, phone(flat_browser) as pupil:
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        teacher.page.goto(f"{school.address}?token={TOKEN}")
        teacher.enter(school, code)
        pupil.enter(school, f"{code[:4]}-{code[4:]}".lower())
        pupil.press("Join")
        name, seed = pupil.who
        pupil.press("A")
        pupil.press("Lock my prediction")
        teacher.sees("said A")
        teacher.button(f"Remove {name}…").focus()
        # By keys: it is asked once more, and Escape keeps the participant.
        teacher.page.keyboard.press("Enter")
        dialog = teacher.page.get_by_role("dialog", name=f"Remove {name}?")
        expect(dialog).to_be_visible()
        is_accessible(teacher)
        teacher.page.keyboard.press("Escape")
        expect(dialog).to_be_hidden()
        expect(teacher.button(f"Remove {name}…")).to_be_focused()
        for key in ("Enter", "Shift+Tab", "Enter"):
            teacher.page.keyboard.press(key)
        expect(teacher.page.get_by_role("heading", name="Who is in")).to_be_focused()
        expect(teacher.page.get_by_role("status").last).to_have_text(f"{name} was removed.")
        teacher.sees("Nobody yet")
        note = pupil.page.get_by_role("alert").filter(has_text="You are not in this room any more")
        expect(note).to_be_visible()
        is_accessible(pupil)
        pupil.press("Join")
        assert pupil.who[1] == seed + 1
        expect(note).to_have_count(0)
        assert api.get(f"rooms/{code}").json()["predicted"] == 0


@pytest.mark.test
def test_a_pupil_leaves_and_can_come_back_as_somebody_else(
    flat_browser: Browser, school: Serving
) -> None:
    with school.api(TOKEN) as api, phone(flat_browser) as pupil:
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        pupil.enter(school, code)
        pupil.press("Join")
        name, seed = pupil.who
        pupil.press("A")
        pupil.press("Lock my prediction")
        pupil.sees("Locked.")
        pupil.press("Leave the room…")
        dialog = pupil.page.get_by_role("dialog", name="Leave the room?")
        expect(dialog).to_contain_text(name)
        is_accessible(pupil)
        pupil.press("No, stay")
        expect(dialog).to_be_hidden()
        pupil.press("Leave the room…")
        pupil.press("Leave")
        pupil.press("Join")
        assert pupil.who[1] == seed + 1
        expect(dialog).to_be_hidden()
        assert [seat["is_present"] for seat in api.get(f"rooms/{code}").json()["people"]] == [
            False,
            True,
        ]


def test_where_phones_cannot_come_a_room_is_tried_on_this_computer(
    flat_browser: Browser, tmp_path: Path
) -> None:
    """Everybody is operator there, in a private window too; the link makes that one a pupil's."""
    with (
        serving(tmp_path) as server,
        new_page(flat_browser) as page,
        new_page(flat_browser) as private,
    ):
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(server.address)
        page.get_by_label("More", exact=True).click()
        page.get_by_role("menuitem", name="Open a room…").click()
        dialog = page.get_by_role("dialog", name="Open a room")
        expect(dialog).to_contain_text("Phones cannot come to this server")
        expect(dialog.get_by_role("button", name="Copy hexapods serve --share")).to_be_visible()
        assert dashboard.violations_in_both_themes() == []
        dialog.get_by_role("button", name="Try a room on this computer alone").click()
        link = page.locator("#open-room code").filter(has_text="?join")
        expect(link).to_have_text(re.compile(r"/r/[A-Z2-9]{4}-[A-Z2-9]{4}\?join$"))
        expect(page.get_by_role("img", name=re.compile("^QR code"))).to_have_count(0)
        pupil = RoomPage(private, has_3d=False)
        private.goto(link.inner_text())
        pupil.button("Join").click()
        assert pupil.who[1] == 0
        page.get_by_role("link", name="Teach: open the cockpit").click()
        expect(page.locator(".people")).to_contain_text(pupil.who[0])
        page.locator(".code-button").click()
        code = page.get_by_role("dialog", name="On this computer alone")
        expect(code).to_contain_text("hexapods serve --share")
        assert dashboard.complaints == []
