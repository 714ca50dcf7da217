"""The first lesson by a visitor who only presses what is highlighted.

Each card's promise is on the screen when the card is shown.
"""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, ViewportSize, expect

from tests.browser.budget import shown_on
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, serving
from tests.browser.test_keyboard import tab_to
from tests.browser.test_workspace import BUDGETS, DESK

pytestmark = pytest.mark.timeout(400)

MAX_PRESSES = 30
"""More than there are cards: some cards are pressed twice."""
Seen = dict[str, str]
"""Card → what it said."""


def highlighted(dashboard: Dashboard) -> Locator:
    """What is highlighted on the page: a button, or the lanes to vote for."""
    return dashboard.page.locator(".to-press")


def open_card(dashboard: Dashboard) -> str:
    """Name of the open card, as the browser keeps it."""
    kept = dashboard.page.evaluate("localStorage['hexapods:first-lesson'] ?? '{}'")
    return str(json.loads(kept).get("at", "start"))


def curve(dashboard: Dashboard) -> Locator:
    """The learning curve, which says in words what it shows."""
    return dashboard.panel.get_by_role("region", name=re.compile("^Learning"))


PROMISES: dict[str, Callable[[Dashboard], Locator]] = {
    "start": lambda d: d.page.get_by_role("region", name="Stage", exact=True),
    "tries": lambda d: d.headline.filter(has_text=re.compile("practises|walks")),
    "step": lambda d: d.page.get_by_role("region", name="Explanation"),
    "test": curve,
    "changed": curve,
    "newest": curve,
    "vote": lambda d: d.group("Your vote"),
    "ready": lambda d: d.lesson.filter(has_text="Your vote: Q-learning"),
    "race": lambda d: d.rows.first,
    "finish": lambda d: d.headline.filter(has_text="wins"),
    "why": lambda d: d.headline.filter(has_text="wins"),
    "turn": lambda d: d.lesson.filter(has_text="Your turn"),
}
"""Card → what has to be on the screen with it."""


_PRESS_ON = """card => {
    const kept = JSON.parse(localStorage['hexapods:first-lesson'] ?? '{}');
    const what = document.querySelector('.to-press');
    if ((kept.at ?? 'start') !== card || !what) return false;
    (what.matches('[role=group]') ? what.querySelector('button') : what).click();
    return true;
}"""


def press_highlighted(dashboard: Dashboard, card: str) -> bool:
    """Press what is highlighted, of a group its first button, unless another card is open now."""
    what = highlighted(dashboard)
    is_group = what.get_attribute("role") == "group"
    # Nothing covers it; the press itself comes with the look at the card, which may turn by itself.
    (what.get_by_role("button").first if is_group else what).click(trial=True)
    return bool(dashboard.page.evaluate(_PRESS_ON, card))


def press_until_it_is_over(dashboard: Dashboard) -> Seen:
    """Press what is highlighted until the lesson is over; return what each card said."""
    page, seen, looked = dashboard.page, Seen(), False
    page.set_viewport_size(DESK)
    for _ in range(MAX_PRESSES):
        enabled = page.locator(".to-press:not([aria-disabled=true])")
        expect(
            enabled.or_(dashboard.page.get_by_role("tab", name="Train", selected=True))
        ).to_have_count(1)
        if dashboard.lesson.count() == 0:
            return seen
        card = open_card(dashboard)
        if card not in seen:
            expect(PROMISES[card](dashboard)).to_be_in_viewport()
            shown, budget = shown_on(page), BUDGETS["Watch"]
            if card != "step":  # an explanation has the controls of its own tab
                assert shown.controls <= budget.controls, card
                assert shown.words <= budget.words, card
        # What happens may have turned it meanwhile.
        if open_card(dashboard) != card:
            continue
        seen[card] = dashboard.lesson.inner_text()
        if card == "race" and looked:
            expect(dashboard.lesson).not_to_contain_text("Hatched")
            continue
        looked = looked or card == "race"
        if press_highlighted(dashboard, card) and card == "ready":
            expect(dashboard.lesson).not_to_contain_text("ends the race")
    raise AssertionError(f"the lesson is not over: {seen}")


def test_who_only_presses_what_is_highlighted_learns_why_greedy_won(
    dashboard: Dashboard, server: Serving
) -> None:
    dashboard.open(server.address)
    expect(highlighted(dashboard)).to_have_count(1)
    assert dashboard.violations_in_both_themes() == []
    seen = press_until_it_is_over(dashboard)
    assert {"start", "test", "changed", "newest", "vote", "ready", "finish", "why", "turn"} <= {
        *seen
    }
    assert re.search(r"Greedy wins by .*Your vote: Q-learning", seen["finish"], re.DOTALL)
    assert re.search(r"Greedy: \d+ steps of \d+.mm", seen["why"])
    # α was changed while it practised, and the race uses what was learned then.
    [practice] = dashboard.get("api/v1/trainings")["items"]
    [race] = dashboard.get("api/v1/races")["items"]
    assert [change["settings"] for change in practice["changes"] if change.get("settings")]
    assert race["config"]["lanes"][0]["training_id"] == practice["id"]


TOKEN = "for-the-operator"
WALK = {"gait": "left-right-origin", "simulator": "kinematic"}
RACE = {**WALK, "steps": 20, "lanes": [{"agent": "greedy"}, {"agent": "random-walk"}]}
HAS_FOCUS = """() => document.activeElement.closest(".to-press") !== null
    && document.activeElement.matches(":focus-visible")"""
SAID = "() => document.querySelector('.card-bar')?.innerText"
_AT_THE_END = ":is(.to-press:not([aria-disabled=true]), [role=tab][aria-selected=true])"


def test_a_spectator_goes_through_by_keys_alone_while_the_server_crashes(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    page = dashboard.page
    first = Serving(tmp_path, token=TOKEN)
    dashboard.open(first.address)
    expect(dashboard.lesson).to_contain_text("It goes on once a practice is started here.")
    with first.api(TOKEN) as api:
        finished(api, "races", RACE)
        practice = {**WALK, "steps": 100_000, "pace": 8}
        api.post("trainings", json=practice).raise_for_status()
        expect(dashboard.lesson).to_contain_text(re.compile("It tries moves|First test"))
    tab_to(page, highlighted(dashboard))
    first.kill()
    expect(dashboard.lesson).to_contain_text(
        "The server is away. The lesson goes on when it is back."
    )
    expect(highlighted(dashboard)).to_have_attribute("aria-disabled", "true")
    assert page.evaluate(HAS_FOCUS)
    assert dashboard.violations() == []

    with serving(tmp_path, first.port, token=TOKEN):
        expect(dashboard.lesson).not_to_contain_text("The server is away.")
        expect(dashboard.connection).to_contain_text("connected")
        # The browser itself says that there was no answer.
        dashboard.complaints.clear()
        cards = goes_on_by_enter(dashboard)
        assert {"newest", "vote", "ready", "race", "finish", "why", "turn"} <= {*cards}
        expect(page.get_by_role("tab", name="Why", selected=True)).to_be_focused()
        page.goto("about:blank")


def goes_on_by_enter(dashboard: Dashboard) -> list[str]:
    """Press Enter on what is highlighted, which keeps the focus, until the lesson is over."""
    page, cards = dashboard.page, list[str]()
    for _ in range(MAX_PRESSES):
        expect(page.locator(_AT_THE_END)).to_have_count(1)
        if dashboard.lesson.count() == 0:
            return cards
        cards.append(open_card(dashboard))
        if cards[-2:] == ["race", "race"]:
            expect(dashboard.lesson).to_contain_text("Why?")
            continue
        page.wait_for_function(HAS_FOCUS)
        said = page.evaluate(SAID)
        page.keyboard.press("Enter")
        page.wait_for_function(f"said => ({SAID})() !== said", arg=said)
    raise AssertionError(f"the lesson is not over: {cards}")


SMALL: list[ViewportSize] = [
    {"width": 320, "height": 640},
    {"width": 844, "height": 390},
    {"width": 390, "height": 844},
    {"width": 1280, "height": 600},
]
"""A narrow window, a phone on its side and upright, and the window of a small laptop."""
_OUTLINE_PX = """element => {
    const {outlineStyle, outlineWidth} = getComputedStyle(element);
    return outlineStyle === "none" ? 0 : parseFloat(outlineWidth);
}"""


def test_what_is_highlighted_can_be_reached_in_small_windows_and_is_seen_in_forced_colours(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page, what = dashboard.page, highlighted(dashboard)
    dashboard.open(shared_server.address)
    for size in SMALL:
        page.set_viewport_size(size)
        expect(what).to_be_in_viewport(ratio=1)
        assert dashboard.scroll_width() <= size["width"], size
    page.emulate_media(forced_colors="active", reduced_motion="reduce")
    assert what.evaluate(_OUTLINE_PX) >= 2
    what.focus()
    assert what.evaluate(_OUTLINE_PX) >= 2
