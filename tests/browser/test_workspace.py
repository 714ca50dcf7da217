"""The workspace: each tab of each depth keeps its budgets, never scrolls, and is accessible."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import ViewportSize, expect

from tests.browser.budget import Shown, shown_on
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold
from tests.promises.length import at_length

pytestmark = pytest.mark.timeout(300)

TABS = {
    "Watch": [""],
    "Try": ["Board", "Train", "World", "Why"],
    "Study": ["Board", "Train", "World", "Why", "Gait", "Table", "What if"],
}
BUDGETS = {"Watch": Shown(12, 150), "Try": Shown(40, 220), "Study": Shown(60, 300)}
DESK: ViewportSize = {"width": 1440, "height": 900}
SIZES: list[ViewportSize] = [
    DESK,
    {"width": 1280, "height": 720},
    # What fits in these fits there.
    *at_length([], [ViewportSize(width=1920, height=1080)]),
]
LEAST_PX = 24
"""Of a control: WCAG 2.2, 2.5.8."""
_OVERFLOW = """() => {
    const {scrollWidth, scrollHeight} = document.scrollingElement;
    return [Math.max(0, scrollWidth - innerWidth), Math.max(0, scrollHeight - innerHeight)];
}"""

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}
PRACTICE = {**WALK, "steps": 100_000, "pace": 8}
LEARNER = {"agent": "q-learning", "training": {"steps": 500}}
RACE = {**WALK, "lanes": [LEARNER, {"agent": "greedy"}, {"agent": "two-step"}]}


def each_tab(dashboard: Dashboard) -> Iterator[tuple[str, str]]:
    """Open each tab of each depth, with all that it loads; in Watch there are none."""
    for depth, titles in TABS.items():
        dashboard.choose_depth(depth)
        for title in titles:
            if title:
                dashboard.open_tab(title)
            waiting = dashboard.page.get_by_role("status").filter(has_text="…")
            expect(waiting).to_have_count(0)
            yield depth, title


def keeps_budgets(dashboard: Dashboard, state: str) -> None:
    """Check each tab of each depth; their head and their button can be seen in all of them."""
    over, scrolled = dict[str, Shown](), dict[str, list[int]]()
    for depth, tab in each_tab(dashboard):
        name = f"{state} {depth} {tab}"
        shown, budget = shown_on(dashboard.page), BUDGETS[depth]
        if shown.controls > budget.controls or shown.words > budget.words:
            over[name] = shown
        for size in SIZES[1:] + SIZES[:1]:
            dashboard.page.set_viewport_size(size)
            overflow = dashboard.page.evaluate(_OVERFLOW)
            if overflow != [0, 0]:
                scrolled[f"{name} {size}"] = overflow
            if tab:
                expect(dashboard.page.get_by_role("tab").last).to_be_in_viewport(ratio=1)
        expect(dashboard.headline).to_be_in_viewport(ratio=1)
        expect(dashboard.actions.get_by_role("button").last).to_be_in_viewport(ratio=1)
    assert over == {}
    assert scrolled == {}


def is_accessible(dashboard: Dashboard) -> None:
    """Check each tab of each depth, in both themes; each control can be met by a pointer."""
    problems: dict[str, list[str]] = {}
    for depth, tab in each_tab(dashboard):
        if too_small := dashboard.small_targets(LEAST_PX):
            problems[f"{depth} {tab} targets"] = too_small
        if violations := dashboard.violations_in_both_themes():
            problems[f"{depth} {tab}"] = violations
    assert problems == {}


def test_each_tab_keeps_its_budget_and_never_scrolls(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    page.set_viewport_size(DESK)
    dashboard.open(server.link(simulator="kinematic"))
    dashboard.stand_in_for_stage()
    keeps_budgets(dashboard, "first")
    # The page tells in a list of tabs what it shows.
    title = re.compile(r"^Q-learning walks .* so far · Racing Hexapods$")
    with server.api() as api:
        practice = api.post("trainings", json=PRACTICE).json()
        expect(page).to_have_title(title)
        keeps_budgets(dashboard, "practising")
        api.post(f"trainings/{practice['id']}/stop").raise_for_status()

        hold(api, finished(api, "races", RACE), 5.0)
        expect(dashboard.headline).to_have_text(re.compile("leads|level"))
        keeps_budgets(dashboard, "racing")
        api.put("stage", json={"time_s": 1e6, "playing": True}).raise_for_status()
        expect(page).to_have_title(re.compile("^Greedy wins by .* · Racing Hexapods$"))
        keeps_budgets(dashboard, "ended")
    is_accessible(dashboard)
