"""Typed text and links are never changed; invalid ones are explained."""

import random
import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.promises.length import at_length

pytestmark = pytest.mark.timeout(300)

WRONG_VALUES = at_length(2, 10)
"""Of each field, of ten kinds by chance."""
NOT_OF_A_NUMBER = "abcdfghijklmnopqrstuvwxyz%/()!?=*#~<>&\"'äλ"


def wrong_value(chance: random.Random) -> str:
    """A text that is no valid value of any number or list field."""
    digits = str(chance.randint(1, 999))
    letters = "".join(chance.choices(NOT_OF_A_NUMBER, k=chance.randint(1, 6)))
    return chance.choice(
        [
            letters,
            digits + letters,
            f"{letters} {digits}",
            f"−{digits}",
            f"-{digits},5",
            f"{digits}.2.{digits}",  # of three digits each, its points would group thousands
            f"{digits};;{digits}",
            f"{digits}e{digits}{digits}{digits}",
            " " * chance.randint(1, 3),
            f"0x{digits}",
        ]
    )


# In one call, because each costs more than all that it asks.
_STATE = """([field, button]) => {
    const texts = node => (node.getAttribute("aria-describedby") ?? "").split(" ").filter(Boolean)
        .map(id => document.getElementById(id).innerText);
    return {
        text: field.value,
        isInvalid: field.getAttribute("aria-invalid"),
        mistake: texts(field)[0],
        isHeld: button.getAttribute("aria-disabled"),
        reason: texts(button)[0] ?? "",
    };
}"""


def check_each_field_keeps_what_is_typed(page: Page, fields: Locator, button: Locator) -> list[str]:
    """Type wrong values into each field; return the ids of the fields."""
    chance = random.Random(20)
    names = [field.get_attribute("id") or "" for field in fields.all()]
    for name in names:
        field = page.locator(f"#{name}")
        before = field.input_value()
        for text in [wrong_value(chance) for _ in range(WRONG_VALUES)]:
            field.fill(text)
            field.blur()
            state = page.evaluate(_STATE, [field.element_handle(), button.element_handle()])
            assert state["text"] == text, name
            assert (state["isInvalid"], state["isHeld"]) == ("true", "true"), (name, text)
            assert re.search("Must be|must be|Enter|can mean", state["mistake"]), (name, text)
            assert state["mistake"] in state["reason"], (name, text)
        field.fill(before)
        assert button.get_attribute("aria-disabled") is None, name
    return names


def test_wrong_values_of_each_field_stay_and_are_explained(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.link(depth="study", tab="train"))
    names: list[str] = []
    for tab, groups in (("Train", ("More settings", "Race")), ("World", ("Robot",))):
        panel = dashboard.open_tab(tab)
        dashboard.unfold(*groups)
        fields = panel.get_by_role("spinbutton")
        # The browser's own field for numbers drops what it does not understand.
        expect(panel.locator("input[type=number]")).to_have_count(0)
        names += check_each_field_keeps_what_is_typed(page, fields, dashboard.primary)
        assert dashboard.violations() == []
    assert {"field-steps", "field-seed", "field-alpha", "field-grid_side_m"} <= set(names)

    page.goto(f"{shared_server.address}#experiments?experiment=sweep")
    page.get_by_role("button", name="All settings").click()
    page.get_by_text("Robots and gaits").click()
    fields = page.locator(".experiment-fields input[inputmode]")
    button = page.get_by_role("button", name=re.compile("^Run Sweep"))
    names = check_each_field_keeps_what_is_typed(page, fields, button)
    assert {"experiment-seeds", "experiment-alpha", "experiment-steps"} <= set(names)

    alpha = page.locator("#experiment-alpha")
    for text in ("0.1 0.3", "0.1; 0.3", "0,1; 0,3"):
        alpha.fill(text)
        alpha.blur()
        expect(alpha).to_have_value(text)
        expect(button).to_have_text(f"Run Sweep: {4 * (1 + 2 * 30)} trials")
        expect(page).to_have_url(re.compile(r"alpha=0\.1,0\.3$"))
    alpha.fill("foo")
    page.get_by_role("checkbox", name="Feet measured").uncheck()
    expect(page.locator("#wrong-observations")).to_have_text("Choose at least 1 of these")
    assert dashboard.violations() == []
    page.locator("#held-experiment").get_by_role("button", name="α").click()
    expect(alpha).to_be_focused()


def test_a_link_with_invalid_fields_keeps_their_texts(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    wrong = {
        "gait": "nonsense",
        "alpha": "7",
        "seed": "−5",
        "robot": "tank",
        "lanes": "greedy,ghost",
        "world": "flatland",
    }
    dashboard.open(shared_server.link(**wrong, alhpa="0.5", depth="study", tab="train"))
    unknown = page.get_by_role("status").filter(has_text="alhpa=0.5")
    expect(unknown).to_be_visible()
    unknown.get_by_role("button", name="Dismiss").click()
    expect(unknown).to_have_count(0)
    dashboard.unfold("Race")
    for field in ("gait", "alpha", "seed", "lanes"):
        expect(page.locator(f"#mistake-{field}")).to_be_visible()
    expect(
        page.get_by_role("radiogroup", name="Gait").get_by_role("radio", checked=True)
    ).to_have_count(0)
    expect(page.locator("#field-alpha")).to_have_value("7")
    expect(page.locator("#field-seed")).to_have_value("−5")
    expect(page.locator("#mistake-seed")).to_have_text("Must be at least 0")
    dashboard.open_tab("World")
    dashboard.unfold("Robot")
    for field in ("robot", "world"):
        expect(page.locator(f"#mistake-{field}")).to_be_visible()
    robot = page.get_by_label("Robot", exact=True)
    expect(robot.get_by_role("option", selected=True)).to_have_text("tank: not valid")
    expect(dashboard.primary).to_have_attribute("aria-disabled", "true")
    expect(page.locator("#held-start li")).to_have_count(len(wrong))
    assert dashboard.violations() == []

    page.get_by_role("radio", name="Flat ground").check(force=True)
    robot.select_option("slippery")
    # The name of a field leads to it, wherever it is.
    page.locator("#held-start").get_by_role("button", name="Seed").click()
    page.get_by_role("radio", name="Front-back, mirrored").check(force=True)
    page.locator("#held-start").get_by_role("button", name="Seed").click()
    seed = page.locator("#field-seed")
    expect(seed).to_be_focused()
    seed.fill("5")
    seed.press("ArrowUp")
    expect(seed).to_have_value("6")
    alpha = page.locator("#field-alpha")
    alpha.fill("0,06")
    alpha.blur()
    expect(alpha).to_have_value("0,06")
    expect(page.get_by_role("slider", name="Learning rate α")).to_have_value("0.06")
    alpha.press("ArrowDown")
    expect(alpha).to_have_value("0.05")
    dashboard.unfold("Race")
    page.get_by_role("checkbox", name="Q-learning", exact=True).check()
    expect(page.locator("#held-start")).to_have_count(0)
    expect(dashboard.primary).not_to_have_attribute("aria-disabled", "true")
    expect(page).to_have_url(re.compile(r"seed=6.*alpha=0\.05"))
    # A held button starts nothing, however it is pressed.
    alpha.fill("7")
    expect(dashboard.button("Train, don’t race")).to_have_attribute("aria-disabled", "true")
    methods: list[str] = []
    page.on("request", lambda request: methods.append(request.method))
    dashboard.button("Train, don’t race").dispatch_event("click")
    page.evaluate("() => fetch('healthz').then(answer => answer.text())")
    assert "POST" not in methods


def test_a_custom_robot_stays_whole_from_link_to_run_to_form(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    name = "The robot with long legs"
    link = {
        "robot": '{"preset":"stiff","femur_m":0.1}',
        "name": name,
        "steps": 20,
        "evaluate_every": 0,
        "simulator": "kinematic",
    }

    def expect_custom_robot() -> None:
        dashboard.open_tab("World")
        dashboard.unfold("Robot")
        robot = page.get_by_label("Robot", exact=True)
        chosen = robot.get_by_role("option", selected=True)
        expect(chosen).to_have_text("Custom: stiff, femur 0.1\u00a0m")

    dashboard.open(shared_server.link(**link, depth="study"))
    expect_custom_robot()
    dashboard.open_tab("Train")
    dashboard.button("Train, don’t race").click()
    page.get_by_role("link", name="Runs").click()
    row = dashboard.runs.filter(has_text=name)
    expect(row).to_contain_text("Custom: stiff, femur 0.1\u00a0m")
    expect(row).to_contain_text("finished")
    [run] = [run for run in dashboard.get("/api/v1/trainings")["items"] if run["name"] == name]
    assert run["config"]["robot"] == {"preset": "stiff", "femur_m": 0.1}

    page.goto("about:blank")
    dashboard.open(shared_server.link("runs", depth="study"))
    row.get_by_label("More for this training").click()
    row.get_by_role("link", name="Use its settings").click()
    page.get_by_role("link", name="Race", exact=True).click()
    expect_custom_robot()
    expect(page).to_have_url(re.compile("femur_m"))
