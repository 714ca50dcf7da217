"""A whole lesson in a room: a teacher with a phone, two participants, and a projector."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from app.features.classroom.names import in_groups
from tests.browser.rooms import (
    PHONE,
    PUBLIC_URL,
    SCREEN,
    TOKEN,
    RoomPage,
    is_accessible,
    is_read_from_afar,
    phone,
)
from tests.browser.serving import Serving, serving
from tests.browser.type_sizes import small_texts
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(400)

STOP_PX = 90
"""Of the type that stops a class."""
FORM = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 100}
LESSON: dict[str, Any] = {
    "title": "Why one run proves nothing",
    "cards": [
        {
            "title": "The same settings",
            "text": "Only the **seed** differs.",
            "state": {"depth": "watch", "form": FORM},
            "ask": {
                "kind": "number",
                "text": "How far will your robot walk?",
                "minimum": -1,
                "maximum": 2,
                "unit": "m",
            },
            "go": "training",
            "reveal": "Nothing differs but *luck*.",
        },
        {
            "title": "One run",
            "text": "It goes farther with α = 0.5.",
            "ask": {
                "kind": "choice",
                "text": "What does that show?",
                "choices": ["It is better", "Nothing"],
            },
            "reveal": {"text": "Nothing yet.", "answer": "Nothing"},
        },
        {
            "title": "Choose an α",
            "text": "Draw first.",
            "state": {"depth": "try", "form": {**FORM, "alpha": 0.3}},
            "may": {"alpha": {"minimum": 0.1, "maximum": 0.9}},
            "ask": {"kind": "curve", "text": "Draw the curve."},
            "go": "training",
        },
        {
            "title": "A point that takes some words",
            "text": "Where does it get to? " * 20,
            "ask": {"kind": "point", "text": "Tap where the curve is after its practice."},
        },
    ],
}


@pytest.fixture
def school(tmp_path: Path) -> Iterator[Serving]:
    with serving(tmp_path, token=TOKEN, public_url=PUBLIC_URL) as server:
        yield server


def test_a_lesson_from_the_code_to_the_reveal(flat_browser: Browser, school: Serving) -> None:
    with (
        school.api(TOKEN) as api,
        phone(flat_browser) as teacher,
        new_page(flat_browser, viewport=SCREEN) as screen,
    ):
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        teacher.page.goto(f"{school.address}?token={TOKEN}")
        teacher.enter(school, code)
        teacher.sees("Nobody yet")
        projector = RoomPage(screen, has_3d=False)
        screen.context.add_cookies(teacher.page.context.cookies())  # type: ignore[arg-type]
        projector.enter(school, code, "?projector")
        projector.sees(f"{PUBLIC_URL.removeprefix('http://')}/r/{in_groups(code)}")
        is_read_from_afar(projector)
        is_accessible(projector, is_touched=False)
        with phone(flat_browser) as first_pupil, phone(flat_browser) as second_pupil:
            gets_to_its_robot_in_three_taps(first_pupil, school, code)
            keeps_name_and_seed(first_pupil, school, code)
            second_pupil.enter(school, code)
            second_pupil.press("Join")
            assert second_pupil.who[1] != first_pupil.who[1]
            answers_in_two_steps(second_pupil)
            shows_the_class(teacher, projector, first_pupil, second_pupil)
            follows_to_a_choice(teacher, projector, first_pupil, second_pupil)
            draws_a_curve_by_keys(teacher, projector, first_pupil)
            taps_a_point(teacher, second_pupil)
            stands_still_and_ends(teacher, projector, first_pupil)
        # A page of it that asks just now would be told that there is no such room.
        assert projector.complaints == []
        screen.goto("about:blank")
        deletes_the_room(teacher, school, code)


def gets_to_its_robot_in_three_taps(pupil: RoomPage, school: Serving, code: str) -> None:
    pupil.enter(school, code)
    expect(pupil.page.get_by_role("heading", name=LESSON["title"])).to_be_visible()
    is_accessible(pupil)
    pupil.press("Join")
    field = pupil.page.get_by_label("Your prediction")
    field.tap()
    field.press_sequentially("3")
    pupil.sees("Must be from -1 to 2")
    field.fill("0,45")
    is_accessible(pupil)
    pupil.press("Lock my prediction, and go")
    expect(pupil.distance).to_have_text(re.compile(r"^−?\d\.\d\d\sm$"))
    expect(pupil.page.get_by_role("region", name="Your robot")).to_be_visible()
    pupil.sees("Locked. It cannot be changed any more.")
    pupil.sees("Wait for the reveal.")
    expect(pupil.page.get_by_role("region", name="The class")).to_have_count(0)
    is_accessible(pupil)


def keeps_name_and_seed(pupil: RoomPage, school: Serving, code: str) -> None:
    before, distance = pupil.who, pupil.distance.inner_text()
    pupil.page.reload()
    assert pupil.who == before
    expect(pupil.distance).to_have_text(distance)
    pupil.sees("0.45 m")
    pupil.page.context.set_offline(True)
    pupil.page.context.set_offline(False)
    # However the code is typed.
    pupil.enter(school, f"{code[:3].lower()}-{code[3:]}")
    assert pupil.who == before


def answers_in_two_steps(pupil: RoomPage) -> None:
    pupil.page.get_by_label("Your prediction").fill("0.2")
    pupil.press("Lock my prediction")
    pupil.sees("Locked.")
    pupil.press("Go: let it practise")
    expect(pupil.distance).to_be_visible()


def shows_the_class(
    teacher: RoomPage, projector: RoomPage, first_pupil: RoomPage, second_pupil: RoomPage
) -> None:
    figures = teacher.page.get_by_label("How far the class is")
    expect(figures).to_have_text(re.compile(r"joined2\s*locked2\s*started2\s*finished2"))
    teacher.sees("said 0.45 m · went")
    is_accessible(teacher)
    projector.sees("2 of 2 locked")
    projector.sees("2 robots, typically")
    expect(projector.page.get_by_role("img", name=re.compile("predictions"))).to_have_count(0)
    is_read_from_afar(projector)

    teacher.press("Reveal")
    for pupil in (first_pupil, second_pupil):
        pupil.sees(re.compile(r"Rank [12] of 2 seeds"))
        pupil.sees("Nothing differs but luck.")
        pupil.sees("of all robots went less far than you said")
        expect(pupil.page.locator(".own-dot")).to_have_count(1)
    is_accessible(first_pupil)
    expect(projector.page.get_by_role("img", name="2 predictions: 2, 2 robots")).to_be_visible()
    is_read_from_afar(projector)
    is_accessible(projector, is_touched=False)

    name = first_pupil.who[0]
    teacher.press(f"Spotlight {name}")
    projector.sees(name)
    is_read_from_afar(projector)
    teacher.press(f"Hide name: {name}")
    projector.sees("One of you")
    teacher.press("Spotlight off")


def follows_to_a_choice(
    teacher: RoomPage, projector: RoomPage, first_pupil: RoomPage, second_pupil: RoomPage
) -> None:
    teacher.press("Next: One run")
    for pupil, choice in ((first_pupil, "Nothing"), (second_pupil, "It is better")):
        pupil.press(choice)
        pupil.press("Lock my prediction")
        pupil.sees("Locked.")
    projector.sees("2 of 2 locked")
    expect(projector.page.locator(".votes")).to_have_count(0)
    teacher.press("Reveal")
    first_pupil.sees("You were right.")
    second_pupil.sees("That was not it.")
    expect(projector.page.locator(".votes")).to_have_text(
        re.compile(r"better\s*1\s*vote.*✓\s*Nothing\s*1\s*vote", re.DOTALL)
    )
    is_accessible(second_pupil)
    is_read_from_afar(projector)


def draws_a_curve_by_keys(teacher: RoomPage, projector: RoomPage, pupil: RoomPage) -> None:
    teacher.press("Next: Choose an α")
    curve = pupil.page.get_by_role("slider", name=re.compile("^Your curve"))
    curve.focus()
    for key in ("ArrowRight", "PageUp", "ArrowUp", "ArrowRight", "PageUp"):
        pupil.page.keyboard.press(key)
    expect(curve).to_have_attribute("aria-valuetext", "0.10\u00a0m after 25 steps")
    alpha = pupil.page.get_by_role("textbox", name=re.compile("Learning rate"))
    alpha.fill("0.95")
    pupil.sees("Must be from 0.1 to 0.9")
    alpha.fill("0.5")
    is_accessible(pupil)
    pupil.press("Lock my prediction, and go")
    pupil.sees("α 0.5")
    # The same settings are the same run: there is nothing to start again until they change.
    again = pupil.button("Go again with these settings")
    expect(again).to_have_count(0)
    alpha.fill("0.7")
    expect(again).to_be_visible()
    teacher.press("Reveal")
    pupil.sees("from the typical curve")
    expect(projector.page.get_by_role("img", name=re.compile("1 predictions over"))).to_be_visible()
    is_read_from_afar(projector)


def taps_a_point(teacher: RoomPage, pupil: RoomPage) -> None:
    teacher.press(re.compile("^Next: A point"))
    chart = pupil.page.get_by_role("img", name="No point yet")
    chart.click(position={"x": 200, "y": 60})
    expect(pupil.page.get_by_role("img", name=re.compile("^Your point"))).to_be_visible()
    pupil.page.get_by_role("slider", name="Steps of practice").fill("250")
    pupil.sees("after 250 steps")
    is_accessible(pupil)
    pupil.press("Lock my prediction")
    pupil.sees("Locked.")


def stands_still_and_ends(teacher: RoomPage, projector: RoomPage, pupil: RoomPage) -> None:
    teacher.press("Freeze all")
    pupil.sees("The teacher has stopped the class for a moment")
    stop = projector.page.get_by_text("Stop. Look to the front.")
    expect(stop).to_be_visible()
    assert not [small for small in small_texts(projector.page, STOP_PX) if "Stop" in small]
    is_read_from_afar(projector)
    is_accessible(projector, is_touched=False)
    teacher.press("Let them go on")
    expect(pupil.page.get_by_text("stopped the class")).to_have_count(0)
    teacher.press("End the room")
    teacher.press("End it for everybody")
    pupil.sees("The lesson has ended")
    projector.sees("The lesson has ended")
    is_accessible(teacher)
    is_accessible(pupil)


def deletes_the_room(teacher: RoomPage, school: Serving, code: str) -> None:
    teacher.page.goto(f"{school.address}r/{code}")
    teacher.press("Delete the room")
    teacher.sees("Save the results before")
    is_accessible(teacher)
    teacher.press("Delete it with its runs")
    teacher.sees("You have deleted this room.")
    is_accessible(teacher)
    with school.api(TOKEN) as api:
        assert api.get("rooms").json()["items"] == []
        assert api.get("runs").json()["items"] == []


@pytest.mark.test
def test_a_wrong_code_leads_to_a_field_for_the_right_one(
    flat_browser: Browser, school: Serving
) -> None:
    with school.api(TOKEN) as api, new_page(flat_browser, viewport=PHONE) as page:
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        stranger = RoomPage(page, has_3d=False)
        stranger.enter(school, "WRONG2")
        stranger.sees("look again at the code on the projector")
        is_accessible(stranger)
        page.get_by_label("Code on the projector").fill(f"{code[:4].lower()} {code[4:]}")
        page.get_by_role("link", name="Go to the room").click()
        stranger.sees(LESSON["title"])
        # By keys alone.
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")
        assert stranger.who[1] == 0


def test_the_page_of_a_room_is_light(flat_browser: Browser, school: Serving) -> None:
    """A stranger's phone loads less than half of what the dashboard may load: see test_load."""
    with school.api(TOKEN) as api, new_page(flat_browser, viewport=PHONE) as page:
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        sizes: list[int] = []
        session = page.context.new_cdp_session(page)
        session.on("Network.loadingFinished", lambda e: sizes.append(e["encodedDataLength"]))
        session.send("Network.enable")
        stranger = RoomPage(page, has_3d=False)
        stranger.enter(school, code)
        expect(stranger.button("Join")).to_be_visible()
        assert sum(sizes) < 125_000
        assert len(sizes) <= 50


def test_a_class_goes_on_when_its_server_comes_back(flat_browser: Browser, tmp_path: Path) -> None:
    """Where watching needs the token, too: a code is all that a pupil needs."""
    private: dict[str, Any] = {"token": TOKEN, "spectators": "token"}
    with new_page(flat_browser, viewport=PHONE, has_touch=True, is_mobile=True) as page:
        pupil = RoomPage(page, has_3d=False)
        with serving(tmp_path, **private) as first, first.api(TOKEN) as api:
            code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
            pupil.enter(first, code)
            pupil.press("Join")
            who = pupil.who
            page.get_by_label("Your prediction").fill("0.3")
            pupil.press("Lock my prediction, and go")
            distance = pupil.distance.inner_text()
            assert pupil.complaints == []
            first.kill()
            pupil.sees("Reconnecting. Your name and your seed are kept.")
            is_accessible(pupil)
        with serving(tmp_path, port=first.port, **private) as second, second.api(TOKEN) as api:
            expect(page.get_by_text("Reconnecting")).to_have_count(0)
            api.post(f"rooms/{code}/reveal", json={}).raise_for_status()
            pupil.sees("Rank 1 of 1 seed")
            assert pupil.who == who
            expect(pupil.distance).to_have_text(distance)
            page.reload()
            assert pupil.who == who
            pupil.sees("0.30 m")
