"""What a person types or a link says is never changed; what is not valid is explained."""

import random
import re
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

WRONG_VALUES = 10
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
            f"{digits}.{digits}.{digits}",
            f"{digits};;{digits}",
            f"{digits}e{digits}{digits}{digits}",
            " " * chance.randint(1, 3),
            f"0x{digits}",
        ]
    )


def explanation(page: Page, field: Locator) -> Locator:
    """The message that describes a field that is not valid."""
    described = field.get_attribute("aria-describedby") or ""
    return page.locator(f"#{described.split()[0]}")


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
            assert field.input_value() == text, name
            assert field.get_attribute("aria-invalid") == "true", (name, text)
            assert len(explanation(page, field).inner_text()) > len("Must be"), (name, text)
            assert button.get_attribute("aria-disabled") == "true", (name, text)
            reason = page.locator(f"#{button.get_attribute('aria-describedby')}")
            assert explanation(page, field).inner_text() in reason.inner_text(), (name, text)
        field.fill(before)
        assert button.get_attribute("aria-disabled") is None, name
    return names


def test_ten_wrong_values_of_each_field_stay_and_are_explained(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    page.get_by_text("More settings").click()
    fields = page.locator(".settings").get_by_role("spinbutton")
    expect(page.locator(".settings input[type=number]")).to_have_count(0)
    names = check_each_field_keeps_what_is_typed(page, fields, dashboard.primary)
    assert {"field-steps", "field-seed", "field-alpha", "field-grid_side_m"} <= set(names)
    assert dashboard.violations() == []

    page.goto(f"{shared_server.address}#experiments?experiment=sweep")
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


def test_a_link_is_kept_as_it_says(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    wrong = {
        "gait": "nonsense",
        "alpha": "7",
        "seed": "−5",
        "robot": "tank",
        "lanes": "greedy,ghost",
    }
    robot = '{"preset":"stiff","femur_m":0.1}'
    dashboard.open(f"{shared_server.address}?{urlencode(wrong)}")
    page.get_by_text("More settings").click()
    for field in wrong:
        expect(page.locator(f"#mistake-{field}")).to_be_visible()
    expect(
        page.get_by_role("radiogroup", name="Gait").get_by_role("radio", checked=True)
    ).to_have_count(0)
    expect(page.locator("#field-alpha")).to_have_value("7")
    expect(page.locator("#field-seed")).to_have_value("−5")
    expect(page.locator("#mistake-seed")).to_have_text("Must be at least 0")
    expect(page.get_by_label("Robot").locator("option:checked")).to_have_text("tank: not valid")
    expect(dashboard.primary).to_have_attribute("aria-disabled", "true")
    expect(page.locator("#held-start li")).to_have_count(len(wrong))
    assert dashboard.violations() == []

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
    page.get_by_label("Robot").select_option("slippery")
    page.get_by_role("checkbox", name="Q-learning").check()
    expect(page.locator("#held-start")).to_have_count(0)
    expect(dashboard.primary).not_to_have_attribute("aria-disabled", "true")
    expect(page).to_have_url(re.compile(r"seed=6.*alpha=0\.05"))

    dashboard.open(f"{shared_server.address}?{urlencode({'robot': robot})}")
    page.get_by_text("More settings").click()
    chosen = page.get_by_label("Robot").locator("option:checked")
    expect(chosen).to_have_text("Custom: stiff, femur 0.1\u00a0m")
    expect(dashboard.primary).not_to_have_attribute("aria-disabled", "true")
