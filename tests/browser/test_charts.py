"""Charts answer: read, seek, zoom and save them, by pointer, keys and touch."""

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Browser, FloatRect, Locator, Page, Position, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

STEPS = 8
SHORT = {
    "steps": STEPS,
    "evaluate_every": 2,
    "race_steps": 5,
    "simulator": "kinematic",
    "lanes": "q-learning,greedy",
}
PHONE: ViewportSize = {"width": 360, "height": 780}
PNG = b"\x89PNG"
TOKEN = "for-the-operator"


@pytest.mark.test
def test_charts_answer(dashboard: Dashboard, flat_browser: Browser, tmp_path: Path) -> None:
    with serving(tmp_path / "data", token=TOKEN) as server:
        dashboard.open(server.link(token=TOKEN, depth="study", tab="board", **SHORT))
        dashboard.primary.click()
        expect(dashboard.headline).to_have_text(re.compile("wins|tie"))
        dashboard.button("Keep watching").click()
        race = values_of(dashboard.page, "the race")
        end_s = end_of_race(dashboard)
        dashboard.eventually(lambda: abs(position(race) - end_s) < 0.1, "the whole race is shown")
        reads_and_seeks(dashboard, race, end_s)
        zooms(dashboard, race)
        answers_keys(dashboard, race)
        is_saved(dashboard, tmp_path)
        assert dashboard.violations() == []
        on_a_spectators_phone(flat_browser, server)
        taps_ahead_of_what_is_shown(dashboard, flat_browser, server)
        seeks_in_the_practice_on_stage(dashboard)


def values_of(page: Page, name: str) -> Locator:
    return page.get_by_role("slider", name=f"Values of {name}")


def box_of(chart: Locator) -> FloatRect:
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box is not None
    return box


def position(chart: Locator) -> float:
    """Return the position of the crosshair, or its first one: seconds or steps."""
    words = chart.get_attribute("aria-valuetext") or ""
    return float(words.split("\u00a0")[0].split(" ")[0])


def set_stage(page: Page, change: dict[str, object]) -> None:
    """Change the stage as the operator whose page it is."""
    page.evaluate(
        """change => fetch("/api/v1/stage", {
            method: "PUT", headers: {"Content-Type": "application/json"},
            body: JSON.stringify(change),
        })""",
        change,
    )


def numbers_of_axis(chart: Locator) -> list[str]:
    ticks = chart.locator("..").locator("svg > text:not([text-anchor], .line-label)")
    return ticks.all_text_contents()


def sought(page: Page, act: Callable[[], object]) -> float:
    """Return the moment that an action asks the stage for [s]."""
    with page.expect_request(
        lambda request: request.method == "PUT" and "/stage" in request.url
    ) as sent:
        act()
    body = sent.value.post_data_json or {}
    assert list(body) == ["time_s"]
    return float(body["time_s"])


def end_of_race(dashboard: Dashboard) -> float:
    """Return the race time at which the last lane of the only race has ended [s]."""
    [race] = dashboard.get("/api/v1/races")["items"]
    clock = dashboard.get("/api/v1/stage")["clock"]
    timeline = dashboard.get(f"/api/v1/races/{race['id']}/timeline?clock={clock}")
    return max(float(lane["total_s"]) for lane in timeline["lanes"])


def reads_and_seeks(dashboard: Dashboard, race: Locator, end: float) -> None:
    page, box = dashboard.page, box_of(race)
    race.hover(position={"x": box["width"] / 2, "y": 40})
    expect(race).to_contain_text(
        re.compile(r"^\d+\.\d\ss\s*Q-learning −?\d\.\d\d\sm\s*Greedy \d\.\d\d\sm")
    )
    assert 0 < position(race) < end
    time_s = sought(page, lambda: race.click(position={"x": box["width"] / 4, "y": 40}))
    assert time_s == pytest.approx(end / 4, rel=0.2)
    page.mouse.move(0, 0)
    expect(race).to_have_text("")
    dashboard.button("Pause the stage").click()
    expect(dashboard.button("Play the stage")).to_be_visible()
    # The axis keeps its length, so that one can go on from here as well.
    later_s = sought(page, lambda: race.click(position={"x": 0.9 * box["width"], "y": 40}))
    assert later_s == pytest.approx(0.9 * end, rel=0.1)

    # The practice is not on stage: its curve is read, and does not seek.
    expect(race).to_have_class(re.compile("seeks"))
    dashboard.open_tab("Train")
    expect(values_of(page, "the learning curve")).not_to_have_class(re.compile("seeks"))
    dashboard.open_tab("Board")


def zooms(dashboard: Dashboard, race: Locator) -> None:
    page, box = dashboard.page, box_of(race)
    before = numbers_of_axis(race)
    y = box["y"] + 40
    page.mouse.move(box["x"] + 0.2 * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.4 * box["width"], y, steps=3)
    expect(race.locator(".selection")).to_be_visible()
    page.mouse.up()
    expect(race.locator(".selection")).to_have_count(0)
    dashboard.eventually(lambda: numbers_of_axis(race) != before, "the axis shows a part")
    methods: list[str] = []
    page.on("request", lambda request: methods.append(request.method))
    race.dblclick(position={"x": box["width"] / 2, "y": 40})
    dashboard.eventually(lambda: numbers_of_axis(race) == before, "the axis shows all")
    page.wait_for_timeout(500)  # longer than the first click of two waits for the second
    assert "PUT" not in methods


def answers_keys(dashboard: Dashboard, race: Locator) -> None:
    page = dashboard.page
    before = numbers_of_axis(race)
    race.press("Home")
    assert position(race) == 0
    race.press("ArrowRight")
    assert position(race) > 0
    at = position(race)
    assert sought(page, lambda: race.press("Enter")) == pytest.approx(at, abs=0.05)
    race.press("+")
    dashboard.eventually(lambda: numbers_of_axis(race) != before, "the axis shows a part")
    follow = page.get_by_role("combobox", name="Follow")
    followed = follow.input_value()
    race.press("0")
    dashboard.eventually(lambda: numbers_of_axis(race) == before, "the axis shows all")
    assert follow.input_value() == followed  # the page's own key 0 frees the camera
    # As for those who touch: the menu acts on what is read.
    page.get_by_label("More of the race: zoom, download").press("Enter")
    show = page.get_by_role("button", name=f"Show this moment: {at:.1f}\u00a0s")
    assert sought(page, show.click) == pytest.approx(at, abs=0.05)
    page.keyboard.press("Escape")
    race.press("Escape")
    expect(race).to_have_text("")
    page.keyboard.press("?")
    help_dialog = page.get_by_role("dialog", name="Keys")
    expect(help_dialog).to_contain_text("show that moment on the stage")
    assert dashboard.violations() == []
    page.keyboard.press("Escape")


def is_saved(dashboard: Dashboard, folder: Path) -> None:
    page = dashboard.page
    page.get_by_label("More of the race: zoom, download").click()
    assert dashboard.violations() == []
    files = {}
    for kind, words in (("PNG", "as PNG"), ("SVG", "as SVG"), ("CSV", "its numbers as CSV")):
        with page.expect_download() as saved:
            dashboard.button(f"Download {words}").click()
        assert saved.value.suggested_filename == f"the-race.{kind.lower()}"
        saved.value.save_as(folder / kind)
        files[kind] = (folder / kind).read_bytes()
    assert files["PNG"].startswith(PNG)
    drawing = files["SVG"].decode()
    title, *_ = ElementTree.fromstring(drawing).itertext()
    assert title.startswith("The race after")
    assert "Greedy" in drawing
    assert not re.search(r"var\(|oklab|color\(|class=", drawing)  # any program can draw it
    head, first, *_ = files["CSV"].decode().splitlines()
    assert head == '"Race time, s",Q-learning (m),Greedy (m)'
    assert first == "0,0,0"
    page.keyboard.press("Escape")


def on_a_spectators_phone(browser: Browser, server: Serving) -> None:
    with new_page(browser, viewport=PHONE, has_touch=True, color_scheme="dark") as page:
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(server.link(depth="study", tab="board"))
        race = values_of(page, "the race")
        expect(race).to_be_visible()
        expect(race).not_to_have_class(re.compile("seeks"))
        box = box_of(race)
        race.tap(position={"x": box["width"] / 2, "y": 40})
        expect(race).to_contain_text("Greedy")
        # Two fingers move apart.
        before = numbers_of_axis(race)
        for number, share in ((1, 0.4), (2, 0.6)):
            finger(race, "pointerdown", number, share, box)
        for number, share in ((1, 0.1), (2, 0.9)):
            finger(race, "pointermove", number, share, box)
            finger(race, "pointerup", number, share, box)
        dashboard.eventually(lambda: numbers_of_axis(race) != before, "the axis shows a part")
        page.get_by_label("More of the race: zoom, download").tap()
        expect(page.get_by_role("button", name=re.compile("^Show this moment"))).to_have_count(0)
        expect(dashboard.button("Zoom out")).to_be_visible()
        dashboard.button("Show all").tap()
        dashboard.eventually(lambda: numbers_of_axis(race) == before, "the axis shows all")
        assert dashboard.scroll_width() == PHONE["width"]
        assert dashboard.violations() == []
        assert dashboard.complaints == []


def taps_ahead_of_what_is_shown(operator: Dashboard, browser: Browser, server: Serving) -> None:
    """An operator's tap seeks there; a spectator's says that it is not shown yet, over no line."""

    def opened(page: Page, **role: str) -> tuple[Locator, Callable[[], None]]:
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(server.link(depth="try", tab="board", **role))
        race = values_of(page, "the race")
        box = box_of(race)
        set_stage(operator.page, {"time_s": 0.5, "playing": False})
        dashboard.eventually(lambda: position(race) == 0.5, "the beginning is shown")
        place: Position = {"x": 0.8 * box["width"], "y": 60}
        return race, lambda: race.tap(position=place)

    with new_page(browser, viewport=PHONE, has_touch=True) as page:
        race, tap = opened(page)
        tap()
        expect(race).to_have_attribute("aria-valuetext", re.compile("s: not shown yet$"))
        expect(race).to_have_text(re.compile("not shown yet$"))
    with new_page(browser, viewport=PHONE, has_touch=True) as page:
        race, tap = opened(page, token=TOKEN)
        time_s = sought(page, tap)
        operator.eventually(lambda: abs(position(race) - time_s) < 0.1, "that moment is shown")
        expect(race).to_have_text("")


def finger(chart: Locator, event: str, number: int, share: float, box: FloatRect) -> None:
    chart.dispatch_event(
        event,
        {"pointerId": number, "pointerType": "touch", "clientX": box["x"] + share * box["width"]},
    )


def seeks_in_the_practice_on_stage(dashboard: Dashboard) -> None:
    page = dashboard.page
    [training] = dashboard.get("/api/v1/trainings")["items"]
    set_stage(page, {"run_id": training["id"], "time_s": 0, "playing": False})
    dashboard.open_tab("Train")
    curve = values_of(page, "the learning curve")
    expect(curve).to_have_class(re.compile("seeks"))
    box = box_of(curve)
    # The bar has the steps of the practice, the stage their time.
    expect(dashboard.moment).to_have_attribute("max", str(STEPS))
    time_s = sought(page, lambda: curve.click(position={"x": box["width"] / 2, "y": 40}))
    dashboard.eventually(lambda: int(dashboard.moment.input_value()) > 0, "that step is shown")
    assert float(dashboard.moment.input_value()) == pytest.approx(STEPS / 2, abs=2)
    assert time_s > 0
