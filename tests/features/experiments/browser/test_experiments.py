"""Experiments on the page: ask for one, watch its report fill, leave it, and take it away."""

import json
import re
import time
from pathlib import Path
from typing import Any
from urllib.parse import urlencode
from urllib.request import Request, urlopen

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

PHONE: ViewportSize = {"width": 360, "height": 780}
PRESETS = (
    *("A setting", "Learners", "Worlds", "Table 1", "Figure 4", "League", "Recovery"),
    *("Fewer groups learn faster", "Bodies"),
)
CORNER = {
    "simulator": "kinematic",
    "gaits": "left-right-origin",
    "observations": "measured",
}
SMALL = {**CORNER, "seeds": 3, "robots": "stiff"}
FINDING = r"λ\s0\.[19] (leads with|walks farthest:) \d+\s%"
ENDLESS = {**CORNER, "experiment": "sweep", "seeds": 5000, "steps": 2000, "workers": 1}


def visit(dashboard: Dashboard, server: Serving, **form: object) -> None:
    """The view of experiments, with this form; the 3D stage is not waited for."""
    page = dashboard.page
    page.goto(f"{server.address}#experiments?{urlencode(form)}")
    expect(dashboard.connection).to_contain_text("connected")
    expect(page.get_by_role("heading", name="Experiments", exact=True)).to_be_visible()


def opens_by_itself(page: Page, report: str) -> None:
    """Open a report from the server in a tab of its own."""
    tab = page.context.new_page()
    answer = tab.goto(report)
    assert answer is not None
    assert answer.headers["content-security-policy"].startswith("sandbox allow-scripts")
    expect(tab.get_by_role("heading", name="Table 1, with every seed")).to_be_visible()
    expect(tab.get_by_role("heading", name="Method")).to_be_visible()
    tab.close()


def test_table_1_fills_and_is_taken_away(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    visit(dashboard, server, **SMALL)
    expect(page.get_by_role("heading", name="One seed misleads")).to_be_visible()
    dashboard.button("Run Table 1: 9 trials").click()
    expect(dashboard.experiment_state("finished")).to_be_visible()

    table = page.get_by_role("table", name="Distance at time-out and total distance")
    strips = table.get_by_role("img", name=re.compile("^3 seeds from .*; the paper 0.25 m$"))
    expect(strips).to_have_count(2)
    expect(table).to_contain_text("paper: unfinished")
    expect(table.get_by_role("columnheader", name="Best known")).to_be_visible()
    total = table.get_by_role("row", name=re.compile("^Total"))
    expect(total.locator("[data-label='Best known']")).to_have_text("–")
    expect(page.get_by_role("region", name="Table 1, with every seed")).to_contain_text(
        "elsewhere a dash stands"
    )
    greedy = total.locator("[data-label=Greedy] b")
    expect(greedy).to_have_text("0.50\u00a0m")
    dashboard.button("half grid sides").click()
    expect(greedy).to_have_text("24.8\u202fh")
    dashboard.button("relative to greedy").click()
    expect(greedy).to_have_text("100\u202f%")

    claims = page.get_by_role("region", name="The paper’s claims over all seeds")
    expect(claims.get_by_role("listitem").first).to_contain_text(
        re.compile(r"Holds|Does not hold|Not established")
    )
    expect(page.get_by_role("heading", name="Under the real clock")).to_be_visible()
    run_a_seed(dashboard)
    assert dashboard.violations() == []
    page.set_viewport_size(PHONE)
    assert dashboard.scroll_width() == PHONE["width"]
    assert dashboard.violations() == []

    expect(page).to_have_url(re.compile("run="))
    dashboard.experiment.get_by_text("Files", exact=True).click()
    report = dashboard.experiment.get_by_role("link", name="Open the report").get_attribute("href")
    assert report is not None
    opens_by_itself(page, report)
    with page.expect_download() as download:
        dashboard.experiment.get_by_role("link", name="Every trial (CSV)").click()
    assert len(Path(download.value.path()).read_text("utf-8").splitlines()) >= 9

    page.get_by_role("link", name="Runs").click()
    expect(dashboard.runs.filter(has_text="Table 1 · 3 seeds")).to_contain_text("finished")
    dashboard.button("Table 1 · 3 seeds").click()
    dashboard.details.get_by_role("link", name="Report").click()
    page.get_by_label("More about this experiment").click()
    dashboard.button("Delete").click()
    expect(page.get_by_role("heading", name="Experiments", exact=True)).to_be_visible()
    expect(page.get_by_text("None yet.")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollHeight") == PHONE["height"]


def run_a_seed(dashboard: Dashboard) -> None:
    """Click a dot of Table 1, run its seed, and come back to its replay."""
    page = dashboard.page
    page.locator(".to-seed").first.dispatch_event("click")
    row = page.locator(".seed-list tr[aria-current]")
    expect(row).to_be_in_viewport()
    distance = row.locator("td").first.inner_text()
    row.get_by_role("button", name="Run this seed here").click()
    expect(page.get_by_role("region", name="Stage", exact=True)).to_be_visible()

    def races() -> list[dict[str, Any]]:
        items: list[dict[str, Any]] = dashboard.get("/api/v1/races")["items"]
        return items

    dashboard.eventually(lambda: [race["state"] for race in races()] == ["finished"], "its race")
    [race] = races()
    assert f"{race['result']['lanes'][0]['total_distance_m']:.2f}\u00a0m" == distance
    page.get_by_role("link", name="Experiments").click()
    replay = row.get_by_role("link", name="Replay")
    expect(replay).to_have_attribute("href", f"?run={race['id']}")


def test_what_a_dead_server_left_is_resumed_paused_and_stopped(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    page = dashboard.page
    with serving(tmp_path) as server:
        visit(dashboard, server, **ENDLESS)
        expect(page.get_by_text(re.compile(r"about .* on \d+ cores?\.$"))).to_be_visible()
        dashboard.button("Run Sweep: 5001 trials").click()
        expect(dashboard.experiment).to_contain_text("a second")
        expect(dashboard.experiment).to_be_in_viewport(ratio=1)
        expect(page.get_by_role("img", name=re.compile(r"^\d+ seeds from"))).to_be_visible()
        server.kill()
        expect(page.get_by_text("This is the last known state")).to_be_visible()
        assert dashboard.violations() == []
        page.goto("about:blank")
        dashboard.complaints.clear()
    with serving(tmp_path) as server:
        visit(dashboard, server)
        expect(dashboard.experiment_state("interrupted")).to_be_visible()
        done = trials_done(dashboard)
        assert done > 0
        dashboard.button("Resume").click()
        dashboard.button("Pause").click()
        expect(dashboard.experiment_state("paused")).to_be_visible()
        dashboard.button("Resume").click()
        expect(dashboard.experiment_state("running")).to_be_visible()
        page.set_viewport_size(PHONE)
        page.get_by_role("link", name=re.compile("5,000 seeds")).click()
        expect(dashboard.button("Pause")).to_be_in_viewport(ratio=1)
        assert dashboard.experiment.evaluate("one => one.scrollWidth <= one.clientWidth")
        dashboard.eventually(lambda: trials_done(dashboard) > done, "another trial")
        # A rate is there once its process has tried something itself.
        expect(dashboard.experiment).to_contain_text("a second")
        dashboard.button("Stop").click()
        expect(dashboard.experiment).to_contain_text("The report covers the completed trials.")
        dashboard.experiment.get_by_text("Files", exact=True).click()
        expect(dashboard.experiment.get_by_role("link", name="Open the report")).to_be_visible()


def trials_done(dashboard: Dashboard) -> int:
    (experiment,) = dashboard.get("api/v1/experiments")["items"]
    done: int = experiment["progress"]["done"]
    return done


def test_a_preset_shows_few_fields_and_a_link_carries_them(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    visit(dashboard, shared_server)
    dashboard.button("New experiment").click()
    dialog = page.get_by_role("dialog", name="New experiment")
    expect(dialog.get_by_role("radio", name="A setting")).to_be_checked()
    expect(dialog.get_by_role("status").first).to_contain_text(
        re.compile(r"151 trials, about .*\.")
    )
    fits(dashboard)
    dialog.get_by_label("Learner", exact=True).select_option("Sarsa(λ)")
    dialog.get_by_label("Setting", exact=True).select_option("Trace decay λ")
    written = dialog.get_by_label("Values", exact=True)
    expect(written).to_have_value("0.1, 0.3, 0.5, 0.7, 0.9")
    written.fill("0.1, oops")
    expect(page.get_by_role("alert").filter(has_text="separated by commas")).to_be_visible()
    button = page.get_by_role("button", name=re.compile("^Run Sweep"))
    expect(button).to_have_attribute("aria-disabled", "true")
    written.fill("0.1, 0.9")
    dialog.get_by_label("Seeds", exact=True).fill("2")
    expect(button).to_have_text("Run Sweep: 5 trials")
    assert dashboard.violations() == []
    link = page.url
    page.goto("about:blank")

    page.goto(link)
    expect(button).to_have_text("Run Sweep: 5 trials")
    expect(written).to_have_value("0.1, 0.9")
    button.click()
    expect(dashboard.experiment).to_contain_text("λ 0.1, 0.9 · 2 seeds")
    expect(dashboard.experiment_state("finished")).to_be_visible()
    expect(dashboard.experiment.get_by_role("heading", name=re.compile(FINDING))).to_be_visible()
    is_renamed(dashboard)
    page.get_by_role("button", name="Repeat with…").click()
    expect(dialog.get_by_label("Learner", exact=True)).to_have_value("sarsa-lambda")
    expect(written).to_have_value("0.1, 0.9")
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()


def is_renamed(dashboard: Dashboard) -> None:
    """Change name and notes in the report; the row has the name and the result."""
    page = dashboard.page
    more = page.get_by_label("More about this experiment")
    more.click()
    dashboard.button("Rename").click()
    page.keyboard.type("How long is memory?")
    page.keyboard.press("Enter")
    row = page.get_by_role("region", name="Experiments").get_by_role("link", name="How long is")
    expect(row).to_contain_text(re.compile(FINDING))
    expect(more).to_be_focused()
    more.click()
    dashboard.button("Add notes").click()
    page.keyboard.type("Too few seeds.")
    page.keyboard.press("Control+Enter")
    expect(dashboard.experiment.get_by_text("Too few seeds.", exact=True)).to_be_visible()
    expect(more).to_be_focused()


def fits(dashboard: Dashboard) -> None:
    """Neither the page nor the dialog has to be scrolled in the smallest window of a computer."""
    page = dashboard.page
    page.set_viewport_size({"width": 1280, "height": 720})
    for title in PRESETS:
        page.get_by_role("radio", name=title, exact=True).check(force=True)
        assert page.evaluate(
            """() => [document.documentElement, document.querySelector(".dialog-fields")]
                .every((one) => one.scrollHeight <= one.clientHeight)"""
        ), title
    page.get_by_role("radio", name="A setting", exact=True).check(force=True)


@pytest.mark.test
def test_all_settings_are_there_and_mistakes_hold_them_back(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    visit(dashboard, shared_server, experiment="sweep")
    dashboard.button("All settings").click()
    alpha = page.get_by_label("α", exact=True)
    alpha.fill("0.1, 0.3, oops")
    expect(page.get_by_role("alert").filter(has_text="separated by commas")).to_be_visible()
    button = page.get_by_role("button", name=re.compile("^Run Sweep"))
    expect(button).to_have_attribute("aria-disabled", "true")
    alpha.fill("0.1, 0.3, 0.6")
    page.get_by_text("Robots and gaits").click()
    page.get_by_role("checkbox", name="Left-right, mirrored").uncheck()
    expect(button).to_have_text(f"Run Sweep: {3 * (1 + 3 * 30)} trials")
    link = page.url
    page.goto("about:blank")

    page.goto(link)
    expect(button).to_have_text("Run Sweep: 273 trials")
    dashboard.button("All settings").click()
    expect(alpha).to_have_value("0.1, 0.3, 0.6")


def test_a_league_takes_worlds_by_their_pictures_and_as_a_text(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    visit(dashboard, shared_server, experiment="league", agents="dyna-q", seeds=2)
    dashboard.button("All settings").click()
    for picture in ("Slope", "Ice"):
        page.get_by_role("checkbox", name=picture, exact=True).uncheck(force=True)
    button = page.get_by_role("button", name=re.compile("^Run League"))
    # In two worlds and two gaits greedy, greedy with the nominal model, and the learner.
    expect(button).to_have_text(f"Run League: {2 * 2 * 3 * 2} trials")
    other_worlds = page.get_by_label("Others")
    other_worlds.press_sequentially("limp:legs=2,5+slope:degrees=40")
    expect(page.get_by_role("alert").filter(has_text="Must be from 0 to 30")).to_be_visible()
    expect(button).to_have_attribute("aria-disabled", "true")
    other_worlds.press("Backspace")
    expect(button).to_have_text("Run League: 36 trials")
    page.get_by_role("textbox", name="Build tolerance").fill("0.05")
    assert dashboard.violations() == []
    link = page.url
    page.goto("about:blank")

    page.goto(link)
    expect(button).to_have_text("Run League: 36 trials")
    expect(other_worlds).to_have_value("limp:legs=2,5+slope:degrees=4")
    expect(page.get_by_role("checkbox", name="Two limp legs")).to_be_checked()
    page.get_by_role("radio", name="Recovery", exact=True).check(force=True)
    page.get_by_label("Seeds", exact=True).fill("1")
    page.get_by_role("checkbox", name="Greedy", exact=True).wait_for(state="detached")
    with page.expect_response("**/api/v1/experiments") as answer:
        page.get_by_role("button", name=re.compile("^Run Recovery")).click()
    config = answer.value.json()["config"]
    assert config["worlds"] == ["flat", "limp-pair", "limp:legs=2,5+slope:degrees=4"]
    assert (config["experiment"], config["tolerance"]) == ("recovery", 0.05)
    dashboard.button("Stop").click()
    expect(dashboard.experiment_state("stopped")).to_be_visible()


def test_reports_fit_a_phone(flat_browser: Browser, small_runs: list[str]) -> None:
    with new_page(flat_browser, viewport=PHONE, color_scheme="light") as page:
        dashboard = Dashboard(page, has_3d=False)
        for address in small_runs:
            page.set_viewport_size(PHONE)
            page.goto(address)
            expect(page.get_by_role("heading", name="Method")).to_be_visible()
            if address == small_runs[0]:
                values = page.get_by_role("slider", name=re.compile("^Values of Left-right"))
                values.first.press("ArrowLeft")
                words = r"1750 steps.*Q-learning \d\.\d\d\sm \(.* – .*\).*Greedy \d\.\d\d\sm$"
                # Both gaits are read at once.
                expect(values).to_have_text([re.compile(words)] * 2)
            assert dashboard.scroll_width() == PHONE["width"]
            assert dashboard.violations_in_both_themes() == []
            if address == small_runs[1]:
                tells_of_its_sweep(dashboard)
            if address == small_runs[-1]:
                tells_who_recovers(dashboard)
            page.goto("about:blank")
        assert dashboard.complaints == []


def tells_of_its_sweep(dashboard: Dashboard) -> None:
    """Rows say what was swept, strips have numbers, and no table is cut within a row."""
    page = dashboard.page
    table = page.get_by_role("region", name="Every setting, with every seed")
    expect(dashboard.experiment).to_contain_text("α 0.1, 0.3 · 3 seeds")
    dashboard.button("Back").click()
    page.get_by_role("link", name=re.compile("^α 0.1, 0.3 · 3 seeds")).click()
    expect(table).to_be_visible()
    for width in (PHONE["width"], 1440):
        page.set_viewport_size({"width": width, "height": 844})
        expect(table.get_by_role("rowheader")).to_have_text(["α\u00a00.1", "α\u00a00.3"])
        numbers = table.locator("tbody tr").first.locator(".axis-number")
        assert [text_.strip() for text_ in numbers.all_text_contents()][:2] == [
            "0.00\u00a0m",
            "0.20\u00a0m",
        ]
        assert page.locator(".scroller").evaluate_all(
            "all => all.every((one) => one.scrollHeight <= one.clientHeight)"
        )


def tells_who_recovers(dashboard: Dashboard) -> None:
    """The curves after it happened, with the walks of greedy, and a table of what is left."""
    page = dashboard.page
    chart = page.get_by_role("img", name=re.compile("^Left-right, opposite: Q-learning .* greedy"))
    expect(chart).to_be_visible()
    table = page.get_by_role("table", name="Agents in Left-right, opposite")
    row = table.get_by_role("row", name=re.compile("^Linear model"))
    expect(row).to_contain_text(re.compile(r"\d\.\d\d\sm"))
    expect(table.get_by_role("row", name=re.compile("^Greedy, nominal model"))).to_have_count(1)
    for title in ("Right after", "Of greedy"):
        expect(table.get_by_role("columnheader", name=title, exact=True)).to_have_count(1)
    practice = page.get_by_role("table", name="Practice in Left-right, opposite")
    until_greedy = practice.get_by_role("columnheader", name="Steps to 90 % of greedy", exact=True)
    expect(until_greedy).to_have_count(1)
    dashboard.button("relative to greedy").click()
    expect(table.get_by_role("row", name=re.compile("^Greedy")).first).to_contain_text("100")
    table_of_worlds = page.get_by_role("table", name="All worlds: share of the best known distance")
    titles = ["Agent", "Sensor noise, of greedy", "Sensor noise 10\u00a0mm, of greedy"]
    expect(table_of_worlds.get_by_role("columnheader")).to_have_text(titles)
    greedy = table_of_worlds.get_by_role("row", name=re.compile("^Greedy, true model"))
    expect(greedy.get_by_role("cell")).to_have_text([" 100\u202f% "] * 2)
    dashboard.button("Sensor noise 10\u00a0mm").click()
    expect(page.get_by_role("region", name="Recovery by agent")).to_contain_text(
        "Sensor noise 10\u00a0mm: share of"
    )


@pytest.fixture(scope="module")
def small_runs(shared_server: Serving) -> list[str]:
    """The views of a finished Figure 4, a finished sweep and a finished recovery."""
    corner = {**CORNER, "robots": "stiff", "seeds": 3, "workers": 1}
    bodies = [
        {"experiment": "figure4", **corner, "gaits": ["left-right-origin", "left-right-vertical"]},
        {"experiment": "sweep", **corner, "settings": {"alpha": [0.1, 0.3]}, "steps": 100},
        {
            "experiment": "recovery",
            **corner,
            "agents": ["q-learning", "linear-model"],
            "steps": 20,
            "worlds": ["noise", "sensor-noise:sd_m=0.01"],
        },
    ]
    ids = [call(shared_server, body)["id"] for body in bodies]
    deadline = time.monotonic() + 100
    while any(call(shared_server, path=f"/{run_id}")["state"] != "finished" for run_id in ids):
        assert time.monotonic() < deadline
        time.sleep(0.25)
    return [f"{shared_server.address}#experiments?run={run_id}" for run_id in ids]


def call(server: Serving, body: object = None, path: str = "") -> dict[str, Any]:
    data = None if body is None else json.dumps(body).encode()
    headers = {"Content-Type": "application/json"}
    request = Request(f"{server.address}api/v1/experiments{path}", data, headers)
    with urlopen(request) as answer:
        answered: dict[str, Any] = json.loads(answer.read())
    return answered


@pytest.mark.test
def test_spectators_see_the_report_without_controls(
    dashboard: Dashboard, flat_browser: Browser, tmp_path: Path
) -> None:
    page = dashboard.page
    with serving(tmp_path, token="for-the-operator") as guarded:
        page.goto(f"{guarded.address}#experiments")
        expect(page.get_by_text("No experiment has been run here.")).to_be_visible()

        with new_page(flat_browser) as operators_page:
            operator = Dashboard(operators_page, has_3d=False)
            operator.page.goto(f"{guarded.address}?token=for-the-operator")
            expect(operator.primary).to_be_visible()
            visit(operator, guarded, **SMALL)
            operator.button("Run Table 1: 9 trials").click()
            expect(operator.experiment).to_be_visible()
            assert operator.complaints == []

        expect(page.get_by_role("heading", name="Method")).to_be_visible()
        dashboard.experiment.get_by_text("Files", exact=True).click()
        expect(dashboard.experiment.get_by_role("link", name="Open the report")).to_be_visible()
        for action in ("Run", "Pause", "Resume", "Stop", "Delete", "Repeat", "New"):
            expect(page.get_by_role("button", name=re.compile(f"^{action}"))).to_have_count(0)
