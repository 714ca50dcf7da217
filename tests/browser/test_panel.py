"""The panel of a race and a practice: what a screen reader hears, and that tabs never move."""

import re

import pytest
from playwright.sync_api import ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.read_aloud import read_aloud
from tests.browser.serving import Serving, finished, hold
from tests.browser.test_workspace import PRACTICE, RACE

pytestmark = pytest.mark.timeout(300)

LEAST_CHART = (360, 220)
"""Least width and height of what is plotted [px]."""
LEAST_STAGE_PX = 828
"""Least width of the picture beside the panel [px]."""
WIDTHS: list[ViewportSize] = [
    {"width": 1920, "height": 1080},
    {"width": 1440, "height": 900},
    {"width": 1280, "height": 720},
    {"width": 1000, "height": 700},
]


def hears(dashboard: Dashboard, words: str) -> list[str]:
    """Wait until a live region says it, and return all that is then read of the page."""
    said = re.compile(rf"^{words}$")
    expect(dashboard.page.get_by_role("status").filter(has_text=said)).to_have_count(1)
    return read_aloud(dashboard.page)


def table_of(spoken: list[str]) -> list[str]:
    """Return who is where: the rows of the board that begin with a rank."""
    return [line for line in spoken if re.match(r"\d, ", line)]


def test_a_race_is_read_aloud(dashboard: Dashboard, server: Serving) -> None:
    with server.api() as api:
        race = finished(api, "races", RACE)
        hold(api, race, 1.2)
        dashboard.open(server.address)
        bars = dashboard.rows.first.get_by_role("img")
        expect(bars).to_have_accessible_name(re.compile(r"of 0\.45\sm to the finish line"))

        # Who leads.
        spoken = hears(dashboard, r"Q-learning takes the lead, 0\.0\d\sm")
        assert "landmark: Panel" in spoken
        panel = spoken[spoken.index("landmark: Panel") :]
        assert re.match(r"heading: Q-learning leads by \d+ [cm]m$", panel[1])
        places = table_of(panel)
        assert [place.split(", ")[1].split(" ")[0] for place in places] == [
            "Q-learning",
            "Greedy",
            "Two-step",
        ]
        assert any("of 0.45 m to the finish line; walking 0:01" in line for line in panel), panel

        # What changed.
        hold(api, race, 9.0)
        spoken = hears(dashboard, r"Greedy takes the lead, 0\.2\d\sm")
        assert any(re.match(r"heading: Greedy leads by \d+ cm$", line) for line in spoken)
        assert table_of(spoken)[0].startswith("1, Greedy")
        why = next(line for line in spoken if line.startswith("Its steps are longer: "))
        assert re.search(r" mm against .* mm of Q-learning\.", why)

        # Who won.
        api.put("stage", json={"time_s": 1e6, "playing": True}).raise_for_status()
        spoken = hears(dashboard, r"Greedy wins by \d+\scm")
        assert any(re.match(r"heading: Greedy wins by \d+ cm$", line) for line in spoken)
        clocks = spoken[spoken.index("table: The same race by each clock") :]
        assert any(line.startswith("Paper clock, 0.") for line in clocks)


def heads(dashboard: Dashboard) -> dict[str, float]:
    """Return where the tabs begin, by tab and width of the window [px]; the board is open then."""
    tops = dict[str, float]()
    for size in WIDTHS:
        dashboard.page.set_viewport_size(size)
        for title in ("Train", "Why", "Board"):
            dashboard.open_tab(title)
            tops[f"{title} at {size['width']}"] = dashboard.box(".tabs")["y"]
    return tops


def test_tabs_never_move(dashboard: Dashboard, server: Serving) -> None:
    dashboard.page.set_viewport_size(WIDTHS[0])
    dashboard.open(server.link(simulator="kinematic", depth="study"))
    first = heads(dashboard)
    assert len({round(top) for top in first.values()}) == 1, first
    with server.api() as api:
        practice = api.post("trainings", json=PRACTICE).raise_for_status().json()
        expect(dashboard.headline).to_have_text(re.compile("walks .* so far"))
        assert heads(dashboard) == first
        api.post(f"trainings/{practice['id']}/stop").raise_for_status()
        expect(dashboard.headline).to_have_text(re.compile("^Stopped at step"))
        assert heads(dashboard) == first

        race = finished(api, "races", RACE)
        for moment in (0.1, 3.0, 9.0, 1e6):
            hold(api, race, moment)
            expect(dashboard.standings).to_be_visible()
            assert heads(dashboard) == first, moment
        expect(dashboard.reason).to_be_visible()


def test_what_is_scrolled_is_scrolled_by_keys_wherever_it_is(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    with shared_server.api() as api:
        hold(api, finished(api, "races", RACE), 5.0)
    page = dashboard.page
    page.set_viewport_size({"width": 1280, "height": 720})
    dashboard.open(shared_server.address)
    body = page.locator("#panel-body")
    expect(dashboard.standings).to_be_visible()
    # What it has grows, which changes nothing of its own size.
    page.set_viewport_size({"width": 1280, "height": 2000})
    expect(body).not_to_have_attribute("tabindex", "0")
    dashboard.scoreboard.evaluate("element => element.style.minHeight = '3000px'")
    expect(body).to_have_attribute("tabindex", "0")
    body.evaluate("element => element.scrollTop = element.scrollHeight")
    expect(body).not_to_have_class(re.compile("follows"))
    assert dashboard.violations("scrollable-region-focusable") == []


def plotted(dashboard: Dashboard, selector: str) -> tuple[float, float]:
    """Return width and height from the first to the last that is plotted [px]."""
    expect(dashboard.page.locator(selector).first).to_be_visible()
    boxes = [box for one in dashboard.page.locator(selector).all() if (box := one.bounding_box())]
    top, bottom = min(box["y"] for box in boxes), max(box["y"] + box["height"] for box in boxes)
    return min(box["width"] for box in boxes), bottom - top


def test_charts_fill_the_panel_with_what_there_is(dashboard: Dashboard, server: Serving) -> None:
    with server.api() as api:
        race = finished(api, "races", RACE)
        hold(api, race, 5.0)
    small = dict[str, tuple[float, float]]()
    dashboard.open(server.link(depth="study"))
    for size in WIDTHS[:3]:
        dashboard.page.set_viewport_size(size)
        for title, selector in {
            "Board": ".crosshair",
            "Train": ".crosshair",
            "Gait": ".walk-plot",
        }.items():
            dashboard.open_tab(title)
            width, height = plotted(dashboard, selector)
            if width < LEAST_CHART[0] or height < LEAST_CHART[1]:
                small[f"{title} at {size['width']}"] = (width, height)
        assert dashboard.box(".picture")["width"] >= LEAST_STAGE_PX
    assert small == {}

    # Of a race of 90 s five are shown, and of 0.45 m to the finish line 0.11.
    dashboard.open_tab("Board")
    chart = dashboard.page.get_by_role("slider", name="Values of the race")
    seconds = chart.locator("..").locator("svg > text:not([text-anchor], .line-label)")
    assert float(seconds.all_text_contents()[-1]) <= 8
    axis = chart.locator("..").locator("svg > text[text-anchor=end]").all_text_contents()
    numbers = [float(text) for text in axis if re.fullmatch(r"\d\.\d+", text)]
    assert 0.1 <= max(numbers) < 0.2
    assert "distance, m" in chart.locator("..").inner_text()
