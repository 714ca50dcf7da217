"""A tournament in a room: two phones, the operator, the projector; and opened from the menu."""

import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Download, Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.rooms import (
    PHONE,
    SCREEN,
    TOKEN,
    RoomPage,
    is_accessible,
    is_read_from_afar,
    phone,
)
from tests.browser.serving import Serving, finished, serving
from tests.browser.test_connection import proxy_that_holds_streams_back
from tests.conftest import new_page
from tests.forked import start_hexapods

pytestmark = pytest.mark.timeout(400)

LESSON: dict[str, Any] = {
    "title": "Before the tournament",
    "cards": [
        {
            "title": "Think",
            "text": "Which learner is best?",
            "state": {"form": {"gait": "left-right-origin", "simulator": "kinematic"}},
        }
    ],
}
WALK: dict[str, Any] = {"gait": "left-right-origin", "simulator": "kinematic"}
RULES: dict[str, Any] = {**WALK, "steps": 40, "draws": 5}
ENDLESS: dict[str, Any] = {**RULES, "draws": 100, "simulator": "mujoco", "steps": 500}
"""Of a tournament whose references are judged as long as a page looks."""
REFERENCES = ("Greedy", "Random walk", "Linear model")


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    with serving(tmp_path_factory.mktemp("data"), token=TOKEN) as server:
        yield server


def visit(page: RoomPage, server: Serving, tournament_id: str) -> None:
    """Open the page of a tournament."""
    page.page.goto(f"{server.address}t/{tournament_id}")


def row_of(page: RoomPage, name: str) -> Locator:
    """The row of an entry in the ranking."""
    return page.page.get_by_role("row").filter(has=page.page.get_by_text(name, exact=True))


def ranked(page: RoomPage, name: str) -> str:
    """Wait until an entry is ranked, and return what its row says."""
    row = row_of(page, name)
    expect(row).to_have_count(1)
    return " ".join(row.inner_text().split())


def choose(page: RoomPage, agent: str) -> None:
    """Choose what enters."""
    page.page.get_by_label("Agent", exact=True).select_option(label=agent)


@pytest.fixture
def teacher(flat_browser: Browser, school: Serving) -> Iterator[RoomPage]:
    """A phone of an operator."""
    with phone(flat_browser) as page:
        page.page.goto(f"{school.address}?token={TOKEN}")
        yield page


def test_a_tournament_of_a_room(
    flat_browser: Browser, school: Serving, teacher: RoomPage, tmp_path: Path
) -> None:
    with (
        school.api(TOKEN) as api,
        phone(flat_browser) as first_pupil,
        phone(flat_browser) as second_pupil,
        new_page(flat_browser, viewport=SCREEN) as screen,
    ):
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        for pupil in (first_pupil, second_pupil):
            pupil.enter(school, code)
            pupil.press("Join")
        opens_it_in_the_cockpit(teacher, school, code)

        names = first_pupil.who[0], second_pupil.who[0]
        for pupil in (first_pupil, second_pupil):
            pupil.page.get_by_role("link", name="Enter the tournament: Cup of the class").tap()
            pupil.sees("practises at most 40 steps, then walks 50, on 5 secret seeds")
            pupil.sees(
                "everybody sees what you entered, and without your name once the room is gone"
            )
        enters_a_learner(first_pupil)
        enters_by_keys_alone(second_pupil)
        sees_the_ranking(second_pupil, names)

        projector = RoomPage(screen, has_3d=False)
        screen.context.add_cookies(teacher.page.context.cookies())  # type: ignore[arg-type]
        projector.enter(school, code, "?projector")
        projector.sees("Tournament: Cup of the class")
        is_read_from_afar(projector)
        projector.page.goto(f"{first_pupil.page.url}?projector")
        ranked(projector, names[0])
        is_read_from_afar(projector)

        ends_it(teacher, first_pupil.page.url)
        repeats_it(teacher, tmp_path)
        first_pupil.sees("Ended")
        expect(row_of(second_pupil, names[0])).to_contain_text("Sarsa, α 0.5, 30 steps")
        first_pupil.sees("Secret and draws")
        first_pupil.sees("Flat ground")
        is_accessible(first_pupil)
        projector.sees("Ended")
        is_read_from_afar(projector)
        is_accessible(projector, is_touched=False)
        assert projector.complaints == []


def opens_it_in_the_cockpit(teacher: RoomPage, school: Serving, code: str) -> None:
    teacher.enter(school, code)
    teacher.press("Start a tournament…")
    dialog = teacher.page.get_by_role("dialog", name="Open a tournament")
    expect(dialog).to_contain_text("ideal (no slip)")
    dialog.get_by_label("Title").fill("Cup of the class")
    steps = dialog.get_by_label("Most steps of practice")
    steps.fill("40.5")
    teacher.sees("Enter a whole number")
    steps.fill("40")
    seeds = dialog.get_by_label("Secret seeds")
    seeds.fill("3")
    expect(seeds).to_have_accessible_description("Must be from 5 to 100")
    seeds.fill("5")
    # The refusal of the server stands beside the field that it is about.
    simulated = dialog.get_by_label("Transitions a search may simulate")
    expect(simulated).to_have_value("40000")
    simulated.fill("500")
    teacher.press("Open the tournament")
    expect(simulated).to_have_accessible_description(
        re.compile("^Transitions a search may simulate must be at least 600 here")
    )
    is_accessible(teacher)
    teacher.complaints.clear()
    simulated.fill("800")
    teacher.press("Open the tournament")
    expect(teacher.page.get_by_role("dialog", name="The tournament is open")).to_be_visible()
    teacher.press("Close")
    expect(teacher.page.get_by_role("link", name="Cup of the class")).to_be_visible()


def enters_a_learner(pupil: RoomPage) -> None:
    pupil.sees("6 of 6 entries left this hour.")
    choose(pupil, "Sarsa")
    pupil.page.get_by_label("Steps of practice").first.fill("41")
    pupil.sees("Must be from 1 to 40")
    pupil.page.get_by_label("Steps of practice").first.fill("30")
    pupil.page.locator("summary").get_by_text("Settings", exact=True).tap()
    alpha = pupil.page.get_by_role("textbox", name="Learning rate α")
    alpha.fill("2")
    expect(pupil.button("Enter")).to_have_attribute("aria-disabled", "true")
    alpha.fill("0.5")
    is_accessible(pupil)
    pupil.press("Enter")
    expect(pupil.page.get_by_role("status").filter(has_text="judged on 5 draws")).to_have_count(1)
    expect(pupil.page.locator(":focus")).to_contain_text("Sarsa, α 0.5, 30 steps")
    pupil.sees("5 of 6 entries left this hour.")
    # The same is judged once.
    pupil.press("Enter")
    expect(pupil.page.get_by_role("status").filter(has_text="was entered before")).to_have_count(1)
    pupil.sees("5 of 6 entries left this hour.")


def enters_by_keys_alone(pupil: RoomPage) -> None:
    keyboard = pupil.page.keyboard
    pupil.page.locator("body").focus()
    for _ in range(20):
        keyboard.press("Tab")
        if pupil.page.evaluate("document.activeElement.id") == "entry-agent":
            break
    keyboard.type("Double")
    expect(pupil.page.get_by_label("Agent", exact=True)).to_have_value("double-q")
    for _ in range(20):
        keyboard.press("Tab")
        if pupil.page.evaluate("document.activeElement.type") == "submit":
            break
    keyboard.press("Enter")
    expect(pupil.page.locator(":focus")).to_contain_text("Double Q")


def sees_the_ranking(pupil: RoomPage, names: tuple[str, str]) -> None:
    name_of_other, own_name = names
    for name in (*REFERENCES, *names):
        assert re.search(r"\d\.\d\d m", ranked(pupil, name))
    # What others have entered is shown at the end alone.
    assert "Sarsa" not in ranked(pupil, name_of_other)
    assert "Double Q" in ranked(pupil, own_name)
    marks = pupil.page.get_by_role("img", name=re.compile(r"m, 95 % interval .+ to .+ m$"))
    expect(marks).to_have_count(5)
    expect(pupil.page.get_by_role("heading", name="Being judged")).to_have_count(0)
    is_accessible(pupil)


def ends_it(teacher: RoomPage, address: str) -> None:
    teacher.page.goto(address)
    teacher.sees("For you as an operator")
    # Operators see what has been entered.
    teacher.sees("Sarsa, α 0.5")
    is_accessible(teacher)
    teacher.press("End…")
    is_accessible(teacher)
    teacher.press("End the tournament")
    teacher.sees("Secret and draws")
    is_accessible(teacher)


def repeats_it(teacher: RoomPage, folder: Path) -> None:
    with teacher.page.expect_download() as loading:
        teacher.page.get_by_role("link", name="Download the file").tap()
    download: Download = loading.value
    file = folder / download.suggested_filename
    download.save_as(file)
    teacher.sees(f"hexapods verify {file.name}")
    verify = start_hexapods(["verify", str(file)], os.environ, stderr=subprocess.STDOUT)
    assert verify.stdout is not None
    said = verify.stdout.read()
    assert verify.wait() == 0, said
    verify.stdout.close()


def test_an_operator_opens_one_from_the_menu_and_deletes_it(
    flat_browser: Browser, school: Serving
) -> None:
    with school.api(TOKEN) as api, new_page(flat_browser) as page:
        trained = finished(api, "trainings", {**WALK, "steps": 10, "name": "Early riser"})
        finished(api, "trainings", {**WALK, "steps": 11})
        later = {**WALK, "steps": 8, "name": "Late riser", "continue_from": trained["id"]}
        finished(api, "trainings", later)
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(f"{school.address}?token={TOKEN}&simulator=kinematic")
        page.get_by_label("More", exact=True).click()
        page.get_by_role("menuitem", name="Tournaments…").click()
        assert dashboard.violations_in_both_themes() == []
        dashboard.button("Open a tournament…").click()
        dialog = page.get_by_role("dialog", name="Open a tournament")
        dialog.get_by_label("Title").fill("Cup of operators")
        dialog.get_by_label("Most steps of practice").fill("10")
        dialog.get_by_label("Secret seeds").fill("100")
        limits_searches(dashboard, dialog)
        dialog.get_by_text("Other creatures that may enter").click()
        dialog.get_by_role("checkbox", name="Ant", exact=True).check()
        dialog.get_by_role("checkbox", name="Trained tables may enter").check()
        assert dashboard.violations_in_both_themes() == []
        dashboard.button("Open the tournament").click()
        page.get_by_role("link", name="Go to the tournament").click()

        watched = RoomPage(page, has_3d=False)
        watched.sees("Creatures that may enter")
        watched.sees("A search simulates at most 8000 transitions on each")
        is_refused_beside_the_field(page, "Late riser, 8 steps")
        assert dashboard.violations_in_both_themes() == []
        dashboard.complaints.clear()  # the browser complains about each 422
        watched.complaints.clear()
        page.get_by_label("What enters").select_option(index=0)
        page.get_by_label("Name of the entry").fill("A" * 30)
        page.get_by_label("Creature", exact=True).select_option(index=1)
        dashboard.button("Enter").click()
        expect(page.locator(":focus")).to_contain_text("A" * 30)
        assert dashboard.violations_in_both_themes() == []
        enters_a_table(page, trained["name"])
        dashboard.button("End…").click()
        page.get_by_role("checkbox", name=re.compile("^Drop the")).check()
        dashboard.button("End the tournament").click()
        watched.sees("Not judged, since the tournament ended before")
        watched.sees("Secret and draws")
        dashboard.button("Delete…").click()
        dashboard.button("Delete the tournament").click()
        is_restored_by_the_list(dashboard)
        watched.complaints.clear()
        assert dashboard.complaints == []


def is_restored_by_the_list(dashboard: Dashboard) -> None:
    """See on the page of a tournament that its deletion can be undone, and do so elsewhere."""
    page = dashboard.page
    expect(page.get_by_role("heading", name="No tournament here")).to_be_visible()
    deleted = page.get_by_role("list", name="Deleted")
    expect(deleted).to_contain_text(re.compile(r"It can be restored until \d\d:\d\d"))
    assert dashboard.violations_in_both_themes() == []
    page.get_by_role("link", name="Go to the dashboard").click()
    page.get_by_label("More", exact=True).click()
    page.get_by_role("menuitem", name="Tournaments…").click()
    deleted.get_by_role("button", name="Undo").click()
    expect(deleted).to_have_count(0)
    page.get_by_role("dialog").get_by_role("link", name="Cup of operators").click()
    expect(page.get_by_role("heading", name="Secret and draws")).to_be_visible()
    dashboard.complaints.clear()  # the browser complains about each 404


def limits_searches(dashboard: Dashboard, dialog: Locator) -> None:
    """Ask for more transitions of a search than there may be, then for fewer."""
    simulated = dialog.get_by_label("Transitions a search may simulate")
    simulated.fill("100001")
    expect(simulated).to_have_attribute("aria-invalid", "true")
    expect(dialog.locator("#about-tournament-transitions")).to_contain_text("Must be from 500 to")
    expect(dashboard.button("Open the tournament")).to_have_attribute("aria-disabled", "true")
    simulated.fill("8000")


def is_refused_beside_the_field(page: Page, table: str) -> None:
    """Enter with a training that is beyond the budget with the one that it continues."""
    field = page.get_by_label("What enters")
    field.select_option(label=table)
    page.get_by_role("button", name="Enter", exact=True).click()
    error = page.locator("#refused-training_id")
    expect(error).to_contain_text("has practised 18 steps, with all that it continues")
    expect(field).to_have_attribute("aria-invalid", "true")
    expect(field).to_have_attribute("aria-describedby", "refused-training_id")
    expect(page.locator(".problem")).to_have_count(0)


def enters_a_table(page: Page, name: str) -> None:
    """Enter with a training that is within the budget; the longer one is not offered."""
    field = page.get_by_label("What enters")
    expect(field.get_by_role("option")).to_have_count(3)
    field.select_option(label=f"{name}, 10 steps")
    expect(page.get_by_label("Agent", exact=True)).to_have_count(0)
    page.get_by_role("button", name="Enter", exact=True).click()
    expect(page.locator(":focus")).to_contain_text("Q-learning, a trained table")


def test_a_missing_tournament_is_reported_and_an_open_one_is_watched(
    flat_browser: Browser, school: Serving
) -> None:
    with school.api(TOKEN) as api:
        with phone(flat_browser) as none, phone(flat_browser) as watches:
            visit(none, school, "0123456789abcdef")
            none.sees("No tournament here")
            is_accessible(none)
            none.complaints.clear()
            tournament = api.post("tournaments", json={"title": "Open", "rules": ENDLESS}).json()
            visit(watches, school, tournament["id"])
            watches.sees("The references are the first")
            expect(watches.button("Enter")).to_have_count(0)
            expect(watches.button("End…")).to_have_count(0)
            is_accessible(watches)
        api.delete(f"tournaments/{tournament['id']}").raise_for_status()


@pytest.mark.test
def test_a_tournament_goes_on_when_its_server_comes_back(
    flat_browser: Browser, tmp_path: Path
) -> None:
    with new_page(flat_browser, viewport=PHONE, has_touch=True, is_mobile=True) as page:
        pupil = RoomPage(page, has_3d=False)
        with serving(tmp_path, token=TOKEN) as first, first.api(TOKEN) as api:
            tournament = api.post("tournaments", json={"title": "Cup", "rules": ENDLESS}).json()
            visit(pupil, first, tournament["id"])
            pupil.sees("The references are the first")
            first.kill()
            pupil.sees("Reconnecting. This is the last that is known; entries are kept.")
            is_accessible(pupil)
        with serving(tmp_path, port=first.port, token=TOKEN) as second, second.api(TOKEN) as api:
            expect(page.get_by_text("Reconnecting")).to_have_count(0)
            api.post(f"tournaments/{tournament['id']}/end", json={}).raise_for_status()
            pupil.sees("Judging the last entries")


@pytest.mark.promises
@pytest.mark.parametrize("place", ["", "?projector"])
def test_where_streams_are_held_back_the_ranking_is_followed_all_the_same(
    place: str, flat_browser: Browser, school: Serving
) -> None:
    with (
        school.api(TOKEN) as api,
        proxy_that_holds_streams_back(school.port) as address,
        new_page(flat_browser, viewport=SCREEN) as page,
    ):
        opened = api.post("tournaments", json={"title": "Cup", "rules": RULES})
        path = f"tournaments/{opened.raise_for_status().json()['id']}"
        page.goto(f"{address}t/{opened.json()['id']}{place}")
        said = "This network holds live updates back. The page asks every 2 seconds."
        expect(page.get_by_text(said)).to_be_visible()
        expect(page.get_by_text("Reconnecting")).to_have_count(0)
        api.post(f"{path}/end").raise_for_status()
        expect(page.get_by_text("Ended", exact=True).first).to_be_visible()
        api.delete(path).raise_for_status()
