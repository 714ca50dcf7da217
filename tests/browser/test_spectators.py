"""Spectators: every setting to read, What if within an allowance, and replays of their own."""

import re
import socket
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold, serving

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


WHAT_IFS = 3
"""That a spectator may ask a minute."""


def test_a_spectator_reads_the_settings_tries_others_and_replays(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    address = f"http://localhost:{port}/"
    served = serving(tmp_path, port, TOKEN, public_url=address, what_ifs_per_minute=WHAT_IFS)
    with served as server, server.api(TOKEN) as api:
        race = finished(api, "races", RACE)
        hold(api, race, 5.0)
        read_settings_on_stage(dashboard, server)
        begin_a_replay_with_space(dashboard)
        replay_explain_and_download(dashboard, race["id"])
        try_settings_until_refused(dashboard)

        # A link with settings opens them; back on stage are those of the race.
        dashboard.open(server.link(alpha=0.9, depth="study", tab="train"))
        expect(alpha_of(dashboard)).to_have_value("0.9")
        dashboard.button("Back to the settings of the stage").click()
        expect(alpha_of(dashboard)).to_have_value("0.7")
        expect(dashboard.page).not_to_have_url(re.compile("alpha"))
        assert {race["id"]} == {run["id"] for run in api.get("races").json()["items"]}


def begin_a_replay_with_space(dashboard: Dashboard) -> None:
    """The key of the play button does what the button does: the stage is not the spectator's."""
    page = dashboard.page
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("Space")
    expect(page).to_have_url(re.compile(r"[?&]run="))
    dashboard.button("Back to the stage").click()
    expect(page).not_to_have_url(re.compile(r"[?&]run="))


def alpha_of(dashboard: Dashboard) -> Locator:
    """The field of the learning rate."""
    return dashboard.page.get_by_role("spinbutton", name="Learning rate, as a number")


def read_settings_on_stage(dashboard: Dashboard, server: Serving) -> None:
    """Every setting of the race on stage can be read, none changed, and the address has none."""
    page = dashboard.page
    link = server.link(depth="study", tab="train")
    dashboard.open(link)
    expect(alpha_of(dashboard)).to_have_value("0.7")
    dashboard.unfold("More settings", "Race")
    expect(page.get_by_role("radio", name="Left-right, mirrored")).to_be_checked()
    disabled = reads_only(dashboard)
    dashboard.open_tab("World")
    dashboard.unfold("Robot")
    expect(page.get_by_label("Simulator")).to_have_value("kinematic")
    expect(page.get_by_role("group", name="Sensor noise")).to_be_visible()
    expect(page.get_by_label("Add a disturbance")).to_be_hidden()
    assert disabled + reads_only(dashboard) > 20
    expect(page).to_have_url(server.link(depth="study", tab="world").rstrip("#"))


def reads_only(dashboard: Dashboard) -> int:
    """Check that no field of the open tab can be changed; return how many there are."""
    settings = dashboard.page.get_by_role("tabpanel").locator("fieldset").first
    assert settings.locator(":is(input, select, button):enabled").count() == 0
    assert dashboard.violations() == []
    return settings.locator(":is(input, select):disabled").count()


def replay_explain_and_download(dashboard: Dashboard, race_id: str) -> None:
    """Replay, explain and download as a spectator, by buttons and on this page only."""
    page = dashboard.page
    region = page.get_by_role("region", name="You are watching")
    region.get_by_role("button", name="Replay").click()
    expect(page).to_have_url(re.compile(f"run={race_id}"))
    expect(dashboard.button("One robot step on")).to_be_visible()
    explained = dashboard.open_tab("Why")
    expect(explained.get_by_role("textbox", name="Step", exact=True)).to_be_in_viewport()
    dashboard.button("Back to the stage").click()
    expect(page).not_to_have_url(re.compile("run="))
    region.get_by_text("Download it").click()
    with page.expect_download() as saved:
        region.get_by_role("link", name="Recording", exact=True).click()
    assert Path(saved.value.path()).read_bytes()[:1] == b"{"
    assert dashboard.violations() == []


def try_settings_until_refused(dashboard: Dashboard) -> None:
    """Ask what-ifs as a spectator until the server refuses more."""
    page = dashboard.page
    panel = dashboard.open_tab("What if")
    panel.get_by_role("button", name="Try the settings as they are").click()
    expect(panel.get_by_role("img", name=re.compile(r"^These settings: \d+ of 30"))).to_be_visible()
    dashboard.button("Try other settings").click()
    expect(alpha_of(dashboard)).to_be_enabled()
    expect(page).to_have_url(re.compile("alpha=0.7"))
    alpha_of(dashboard).fill("0.1")
    answered = panel.get_by_text("Ideal (no slip)")
    expect(answered).to_be_visible()
    alert = panel.get_by_role("alert").filter(has_text=f"may ask {WHAT_IFS} times a minute here")
    # On a busy machine one takes longer than a second, and counts as several.
    for percent in range(20, 20 + 2 * WHAT_IFS):
        if alert.count():
            break
        alpha_of(dashboard).fill(str(percent / 100))
        expect(alert.or_(answered).first).to_be_visible()
        page.wait_for_timeout(500)
    expect(alert).to_be_visible()
    assert [
        complaint for complaint in dashboard.complaints if not complaint.startswith("429 ")
    ] == []
    dashboard.complaints.clear()
    assert dashboard.violations() == []
