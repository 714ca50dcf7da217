"""Spectators: every setting to read, What if? within an allowance, and the presenter view."""

import re
import socket
import time
from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving

pytestmark = pytest.mark.timeout(300)

TOKEN = "for-the-operator"
RACE: dict[str, Any] = {
    "gait": "left-right-vertical",
    "simulator": "kinematic",
    "steps": 20,
    "lanes": [
        {"agent": "q-learning", "training": {"steps": 60, "settings": {"alpha": 0.7}}},
        {"agent": "greedy"},
    ],
    "disturbances": [{"kind": "sensor-noise", "sd_m": 0.001, "at_step": 5}],
}


WHAT_IFS = 8
"""That a spectator may ask a minute."""


def test_a_spectator_reads_the_settings_tries_others_and_presents(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    address = f"http://localhost:{port}/"
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    with (
        serving(tmp_path, port, TOKEN, public_url=address, what_ifs_per_minute=WHAT_IFS),
        httpx2.Client(base_url=f"{address}api/v1/", headers=bearer) as api,
    ):
        race = finished_race(api)
        read_settings_on_stage(dashboard, address)
        replay_explain_and_download(dashboard, race["id"])
        try_settings_until_refused(dashboard)

        # A link with settings opens them; back on stage are those of the race.
        dashboard.open(f"{address}?alpha=0.9")
        expect(alpha_of(dashboard)).to_have_value("0.9")
        dashboard.button("Back to the settings on stage").click()
        expect(alpha_of(dashboard)).to_have_value("0.7")
        assert dashboard.page.url == address

        present_replay(dashboard, f"{address}?run={race['id']}&t=2.5")
        assert {race["id"]} == {one["id"] for one in api.get("races").json()["items"]}


def alpha_of(dashboard: Dashboard) -> Locator:
    """The field of the learning rate."""
    return dashboard.page.get_by_role("spinbutton", name="Learning rate, as a number")


def read_settings_on_stage(dashboard: Dashboard, address: str) -> None:
    """Every setting of the race on stage can be read, none changed, and the address has none."""
    page = dashboard.page
    dashboard.open(address)
    expect(alpha_of(dashboard)).to_have_value("0.7")
    expect(alpha_of(dashboard)).to_be_disabled()
    dashboard.unfold_settings()
    expect(page.get_by_role("radio", name="Left-right, mirrored")).to_be_checked()
    expect(page.get_by_label("Simulator")).to_have_value("kinematic")
    expect(page.get_by_role("group", name="Sensor noise")).to_be_visible()
    expect(page.get_by_label("Add a disturbance")).to_be_hidden()
    settings = page.get_by_role("group", name="Settings", exact=True)
    assert settings.locator(":is(input, select):disabled").count() > 20
    assert settings.locator(":is(input, select, button):enabled").count() == 0
    assert page.url == address
    assert dashboard.violations() == []


def replay_explain_and_download(dashboard: Dashboard, race_id: str) -> None:
    """What a spectator can do is offered as buttons, and does it on this page only."""
    page = dashboard.page
    panel = page.get_by_role("region", name="Run on stage")
    panel.get_by_role("button", name="Replay it here").click()
    expect(page).to_have_url(re.compile(f"run={race_id}"))
    expect(dashboard.button("One robot step on")).to_be_visible()
    panel.get_by_role("button", name="Step by step").click()
    steps = page.get_by_role("region", name="Step by step")
    expect(steps.get_by_role("textbox", name="Step")).to_be_in_viewport()
    panel.get_by_role("button", name="Back to the stage").click()
    expect(page).not_to_have_url(re.compile("run="))
    panel.get_by_text("Download it").click()
    with page.expect_download() as saved:
        panel.get_by_role("link", name="Joints and feet (CSV)").click()
    assert saved.value.suggested_filename == f"race-{race_id}.csv"
    assert dashboard.violations() == []


def try_settings_until_refused(dashboard: Dashboard) -> None:
    """What if? is asked when the spectator says so, and as often as the server allows."""
    page = dashboard.page
    panel = page.get_by_role("region", name="What if?")
    panel.get_by_role("button", name="Try the settings as they are").click()
    expect(panel.get_by_role("img", name=re.compile(r"^These settings: \d+ of 30"))).to_be_visible()
    dashboard.button("Try other settings").click()
    expect(alpha_of(dashboard)).to_be_enabled()
    expect(page).to_have_url(re.compile("alpha=0.7"))
    alpha_of(dashboard).fill("0.1")
    expect(panel.locator(".trial.old")).to_have_count(0)
    expect(panel).to_contain_text("Ideal (no slip)")
    alert = panel.get_by_role("alert").filter(has_text=f"may ask {WHAT_IFS} times a minute here")
    # On a busy machine one takes longer than a second, and counts as several.
    for percent in range(20, 20 + 2 * WHAT_IFS):
        if alert.count():
            break
        alpha_of(dashboard).fill(str(percent / 100))
        expect(alert.or_(panel.locator(".trial:not(.old)")).first).to_be_visible()
        page.wait_for_timeout(500)
    expect(alert).to_be_visible()
    assert [one for one in dashboard.complaints if not one.startswith("429 ")] == []
    dashboard.complaints.clear()
    assert dashboard.violations() == []


def present_replay(dashboard: Dashboard, address: str) -> None:
    """The presenter view of a replay, by a link and by its button, in large type."""
    page, width = dashboard.page, 1920
    page.set_viewport_size({"width": width, "height": 1080})
    dashboard.open(f"{address}&present")
    audience = page.get_by_role("region", name="Watch along")
    expect(audience).to_contain_text("watching")
    home = address.partition("?")[0]
    expect(audience.get_by_text(home[len("http://") : -1], exact=True)).to_be_visible()
    code = audience.get_by_role("img", name=f"QR code of {home}")
    assert code.evaluate("image => image.naturalWidth") > 20
    expect(page.get_by_role("banner")).to_be_hidden()
    expect(page.get_by_role("region", name="Learning", exact=True)).to_be_visible()
    dashboard.eventually(lambda: dashboard.has_figures(lanes=2), "the scoreboard is there")
    expect(audience).to_contain_text(
        re.compile(r"The farthest at time-out wins: .* \(paper clock\)")
    )
    # The reason why the leader is ahead, by its figures.
    expect(audience).to_contain_text(re.compile(r"\(paper clock\)\..*\d"))
    assert font_px(dashboard, ".audience-rule") > 20
    large = font_px(dashboard, ".board .agent")
    assert dashboard.box(".picture")["width"] > 0.6 * width
    assert dashboard.scroll_width() <= width
    assert dashboard.violations() == []
    page.keyboard.press("Escape")
    expect(page.get_by_role("banner")).to_be_visible()
    assert page.url == f"{address}0"
    assert large > 1.5 * font_px(dashboard, ".board .agent")

    dashboard.button("Present").click()
    expect(audience).to_be_visible()
    assert page.url == f"{address}0&present"
    is_full = "document.fullscreenElement !== null"
    dashboard.eventually(lambda: page.evaluate(is_full), "it fills the screen")
    page.keyboard.press("p")
    expect(audience).to_have_count(0)
    dashboard.eventually(lambda: not page.evaluate(is_full), "it fills the screen no more")


def finished_race(api: httpx2.Client) -> dict[str, Any]:
    """Start a race as the operator, and return it once it has finished, held at its end."""
    started = api.post("races", json=RACE).raise_for_status().json()
    for _ in range(600):
        race: dict[str, Any] = api.get(f"races/{started['id']}").json()
        if race["state"] == "finished":
            api.put("stage", json={"run_id": race["id"], "playing": False}).raise_for_status()
            return race
        time.sleep(0.1)
    raise AssertionError(race)


def font_px(dashboard: Dashboard, selector: str) -> float:
    """Return the size of the type of the first element of a selector [px]."""
    size: float = dashboard.page.locator(selector).first.evaluate(
        "one => parseFloat(getComputedStyle(one).fontSize)"
    )
    return size
