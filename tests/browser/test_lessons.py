"""A lesson made on the page: exported, imported on another server, and taught there."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from app.features.classroom.names import in_groups, normalized
from tests.browser.dashboard import Dashboard
from tests.browser.rooms import PUBLIC_URL, TOKEN, RoomPage, phone
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(400)

PICK = {"lane": 0, "what": "leg", "leg": 1, "x": 200, "y": 200}
"""What the 3D view says of a leg that was clicked."""
SETTINGS = {"depth": "try", "tab": "train", "simulator": "kinematic", "steps": 100, "alpha": 0.5}


def test_a_lesson_is_made_exported_imported_and_taught(
    dashboard: Dashboard, server: Serving, flat_browser: Browser, tmp_path: Path
) -> None:
    file = tmp_path / "lesson.yaml"
    dashboard.page.set_viewport_size({"width": 1440, "height": 900})
    dashboard.open(server.link(**SETTINGS))
    makes_a_lesson(dashboard)
    exports_it(dashboard, file)
    opens_its_link(dashboard)
    with (
        serving(tmp_path / "elsewhere", token=TOKEN, public_url=PUBLIC_URL) as elsewhere,
        new_page(flat_browser) as page,
    ):
        other = Dashboard(page, has_3d=False)
        other.open(f"{elsewhere.address}?token={TOKEN}")
        code = imports_it(other, elsewhere, file)
        with phone(flat_browser) as pupil:
            pupil.enter(elsewhere, code)
            is_taught(pupil)
        assert other.complaints == []


def lessons_of(dashboard: Dashboard) -> None:
    dashboard.page.get_by_label("More", exact=True).click()
    dashboard.page.get_by_role("menuitem", name="Lessons").click()


def makes_a_lesson(dashboard: Dashboard) -> None:
    page = dashboard.page
    lessons_of(dashboard)
    expect(page.get_by_role("heading", name="Lessons", exact=True)).to_be_visible()
    assert dashboard.violations_in_both_themes() == []
    dashboard.button("New lesson").click()
    dashboard.button("Save the lesson").click()
    # What is not valid is told, with the field.
    expect(page.get_by_role("alert").filter(has_text="title")).to_be_visible()
    assert [complaint.partition(" ")[0] for complaint in dashboard.complaints] == ["422"]
    dashboard.complaints.clear()
    page.get_by_label("Title", exact=True).fill("Guess first")
    page.get_by_label("Aims, one a line").fill("Guess.\nLook.")
    page.get_by_label("Title of the card").fill("How far?")
    page.get_by_label("Text, in Markdown").fill("It practises **100** steps.")
    dashboard.button("Take the page as it is").click()
    expect(page.get_by_text(re.compile("alpha 0.5"))).to_be_visible()
    kinds = dashboard.group("Kind of the question")
    kinds.get_by_role("button", name="Choice").click()
    page.get_by_label("The question, in Markdown").fill("Will it walk?")
    page.get_by_label(re.compile("^Answers to choose from")).fill("Yes\nNo")
    dashboard.group("Go runs").get_by_role("button", name="Training").click()
    page.get_by_label("Open a setting").select_option("alpha")
    bounds = dashboard.group("Learning rate α")
    bounds.get_by_label("From").fill("0.2")
    bounds.get_by_label("to", exact=True).fill("0.8")
    for tab in ("World", "Gait", "Table", "What if"):
        page.get_by_role("checkbox", name=tab, exact=True).uncheck()
    page.get_by_label("Revealed afterwards, in Markdown").fill("Most do.")
    preview = page.get_by_role("region", name="As a phone shows it")
    expect(preview).to_contain_text("It practises 100 steps.")
    expect(preview.get_by_role("button", name="Yes")).to_be_visible()
    expect(preview).to_contain_text("From 0.2 to 0.8")
    assert dashboard.violations_in_both_themes() == []


def exports_it(dashboard: Dashboard, file: Path) -> None:
    page = dashboard.page
    # The draft is the browser's until it is saved.
    page.reload()
    expect(page.get_by_label("Title", exact=True)).to_have_value("Guess first")
    dashboard.button("Save the lesson").click()
    expect(page.locator(".saved-lesson .address")).to_be_visible()
    # Phones cannot come to this server.
    expect(page.get_by_role("img", name=re.compile("^QR code of"))).to_have_count(0)
    with page.expect_download() as download:
        page.get_by_role("link", name="YAML").click()
    download.value.save_as(file)
    assert "Guess first" in file.read_text("utf-8")


def opens_its_link(dashboard: Dashboard) -> None:
    page = dashboard.page
    dashboard.open(f"http://{page.locator('.saved-lesson .address').inner_text()}")
    reader = page.get_by_role("dialog", name="How far?")
    expect(reader).to_contain_text("nothing is locked")
    assert dashboard.violations_in_both_themes() == []
    reader.get_by_role("button", name="Yes").click()
    reader.get_by_role("button", name="Reveal").click()
    expect(reader).to_contain_text("Most do.")
    reader.get_by_role("button", name="To the page").click()
    expect(page.get_by_role("tab")).to_have_text(["Board", "Train", "Why"])
    closes_what_the_card_does_not_open(dashboard)
    expect(dashboard.lesson).to_contain_text("Card 1 of 1")
    dashboard.lesson.get_by_role("button", name="Done").click()
    expect(page).not_to_have_url(re.compile("lesson="))


def closes_what_the_card_does_not_open(dashboard: Dashboard) -> None:
    page = dashboard.page
    alpha = page.get_by_role("spinbutton", name=re.compile("Learning rate"))
    gamma = page.get_by_role("spinbutton", name=re.compile("Discount"))
    expect(alpha).to_have_value("0.5")
    expect(alpha).to_be_enabled()
    for closed in (gamma, page.get_by_label("Robot", exact=True), page.locator("#field-gait")):
        expect(closed).to_be_disabled()
    alpha.fill("0.9")
    expect(page.get_by_text(re.compile("0.2.*0.8")).first).to_be_visible()
    alpha.fill("0.7")
    assert dashboard.violations_in_both_themes() == []
    # It is courtesy, says so, and has a way out.
    note = page.get_by_role("note").filter(has_text="Nothing is locked here")
    expect(note).to_be_visible()
    note.get_by_role("button", name="Open all settings").click()
    expect(gamma).to_be_enabled()
    expect(alpha).to_have_value("0.7")
    expect(note).to_have_count(0)
    # Typed parameters go before the card's; what is unknown is told.
    link = page.url.partition("?")[0] + "l/" + page.url.partition("lesson=")[2].partition("&")[0]
    dashboard.open(f"{link}?alpha=0.3&depth=study&alhpa=0.5")
    page.get_by_role("dialog", name="How far?").get_by_role("button", name="To the page").click()
    expect(alpha).to_have_value("0.3")
    expect(page.locator("#field-steps")).to_have_value("100")
    expect(page.get_by_text("alhpa=0.5")).to_be_visible()
    expect(page.locator("#field-observation")).to_be_disabled()
    expect(page.locator("#field-lanes")).to_be_disabled()
    closes_what_happens_to_the_robots(dashboard, link)


def closes_what_happens_to_the_robots(dashboard: Dashboard, link: str) -> None:
    """The world, what happens in the next run, and what can be let happen to the one that runs."""
    page = dashboard.page
    dashboard.open(f"{link}?depth=study&tab=world&steps=2000&pace=1&simulator=mujoco")
    page.get_by_role("dialog", name="How far?").get_by_role("button", name="To the page").click()
    dashboard.actions.locator("button.primary").click()
    now = page.get_by_role("region", name="Disturbances now")
    closed = (
        page.locator("#field-world"),
        page.get_by_label("Add a disturbance"),
        now.get_by_label("A press on a leg"),
        now.get_by_role("button", name="Leg 1", exact=True),
        now.get_by_label("Slope", exact=True),
    )
    for control in closed:
        expect(control).to_be_disabled()
    # Another run on the stage would close what was picked.
    expect(dashboard.shown_run).to_contain_text("of 2")
    dashboard.stand_in_for_stage({"type": "hexapods:pick", "pick": PICK})
    menu = page.get_by_role("region", name=re.compile(", leg 1$"))
    expect(menu).to_contain_text("The lesson's card")
    expect(menu.get_by_role("button", name="Let it happen")).to_have_count(0)
    assert dashboard.violations_in_both_themes() == []
    menu.get_by_role("button", name="Open all settings").click()
    expect(menu.get_by_role("button", name="Let it happen")).to_be_visible()
    for control in closed:
        expect(control).to_be_enabled()
    page.keyboard.press("Escape")
    dashboard.button("Stop").click()


def imports_it(other: Dashboard, elsewhere: Serving, file: Path) -> str:
    page = other.page
    lessons_of(other)
    page.get_by_label("Import…").set_input_files(file)
    expect(page.get_by_label("Title", exact=True)).to_have_value("Guess first")
    other.button("Teach…").click()
    other.button("Open the room").click()
    code = normalized(page.locator(".room-code").inner_text())
    address = f"{PUBLIC_URL}/r/{in_groups(code)}"
    expect(page.get_by_role("img", name=f"QR code of {address}")).to_be_visible()
    page.get_by_role("link", name="Teach: open the cockpit").click()
    expect(page).to_have_url(f"{elsewhere.address}r/{code}")
    expect(other.button("Freeze all")).to_be_visible()
    return code


def is_taught(pupil: RoomPage) -> None:
    pupil.press("Join")
    pupil.press("Yes")
    expect(pupil.page.get_by_label(re.compile("Learning rate")).first).to_have_value("0.5")
    pupil.press("Lock my prediction, and go")
    expect(pupil.distance).to_be_visible()
    pupil.sees("α 0.5")
