"""Promise 21: names are text: 200 XSS payloads as run names in a real browser.

0 scripts run, 0 policy violations, on every page of the server and in the file that replays a run.
The gate has every seventh payload, which are all tags, each behind a few of the prefixes; in full
by `make soak`.
"""

import html
import time
from itertools import product
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2
import pytest
from playwright.sync_api import ConsoleMessage, Dialog, Frame, Page, expect

from tests.browser.dashboard import PATIENCE_MS, WITHOUT_3D
from tests.browser.serving import Serving
from tests.promises.length import at_length

PAYLOADS, EVERY = 200, at_length(7, 1)
ON_STAGE = at_length(1, PAYLOADS)
"""Number of payloads shown on stage, as 3D label and as caption."""

RUNS = "window.xss=1"
TAGS = [
    "<script>{}</script>",
    "<img src=x onerror={}>",
    "<svg onload={}>",
    "<svg><script>{}</script></svg>",
    "<iframe srcdoc='<script>parent.{}</script>'>",
    "<iframe src=javascript:parent.{}>",
    "<a href=javascript:{} autofocus onfocus={}>x</a>",
    "<input autofocus onfocus={}>",
    "<details open ontoggle={}>",
    "<video><source onerror={}>",
    "<style onload={}></style>",
    "<style>@import'//evil.example/{}'</style>",
    "<math><mtext></form><img src onerror={}>",
    "<template><img src onerror={}></template>",
    "<object data=javascript:{}>",
    "<base href=//evil.example/><!--{}",
    "<meta http-equiv=refresh content=0;url=javascript:{}>",
    "<link rel=stylesheet href=//evil.example/{}>",
    "${{{}}}",
    "{{{{constructor.constructor('{}')()}}}}",
    "javascript:{}",
    "`-({})-`",
    "',{},'",
    "<!--><img src onerror={}>",
    "]]><script>{}</script>",
]
PREFIXES = ["", '"', "'", "'>", '">', "</title>", "</script>", "\u0301\ufe0f\u0336"]


def payloads() -> list[str]:
    """Return distinct payloads, each at most as long as a name may be."""
    names = [prefix + tag.replace("{}", RUNS) for prefix, tag in product(PREFIXES, TAGS)]
    return list(dict.fromkeys(name[:100] for name in names))[:PAYLOADS]


BREAKS_OUT = payloads()[100]
"""A script after the end of an attribute; in text, a script too."""

WATCH = """
window.violations = [];
addEventListener("securitypolicyviolation", ({ violatedDirective, blockedURI }) =>
  violations.push(`${violatedDirective} ${blockedURI}`));
"""


class Watched:
    """A page monitored for executed payloads, policy violations and foreign requests."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.violations: list[str] = []
        page.set_default_timeout(PATIENCE_MS)
        page.add_init_script(WATCH)
        page.on("dialog", self._on_dialog)
        page.on("pageerror", lambda error: self.violations.append(str(error)))
        page.on("console", self._on_console)
        page.on("request", lambda request: self._on_request(request.url))

    def check(self) -> None:
        for frame in self.page.frames:
            self.violations += self._violations_in(frame)
        assert self.violations == []

    def _violations_in(self, frame: Frame) -> list[str]:
        violations: list[str] = frame.evaluate("[...(window.violations ?? ['not watched'])]")
        return violations + (["a script ran"] if frame.evaluate("'xss' in window") else [])

    def _on_dialog(self, dialog: Dialog) -> None:
        self.violations.append(dialog.message)
        dialog.dismiss()

    def _on_console(self, message: ConsoleMessage) -> None:
        if "Content Security Policy" in message.text:
            self.violations.append(message.text)

    def _on_request(self, url: str) -> None:
        # The page's own address may name it.
        if "evil.example" in (urlsplit(url).hostname or ""):
            self.violations.append(url)


@pytest.fixture
def payload_runs(server: Serving) -> list[dict[str, Any]]:
    """A run for each payload; imported, since that needs no job process."""
    names = payloads()[::EVERY]
    assert len(names) == -(-PAYLOADS // EVERY)
    with httpx2.Client(base_url=f"{server.address}api/v1", timeout=60) as client:
        body = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 20}
        first = client.post("/trainings", json={**body, "name": names[0]}).json()
        path = f"/trainings/{first['id']}"
        while client.get(path).json()["state"] != "finished":
            time.sleep(0.05)
        table = client.get(f"{path}/q-table?format=npz").content
        runs = []
        for name in names:
            answer = client.post("/trainings/import", params={"name": name}, content=table)
            assert answer.status_code == 201, (name, answer.text)
            runs.append(answer.json())
        race = {**body, "steps": 3, "lanes": [{"agent": "greedy"}], "name": names[1]}
        runs.append(client.post("/races", json=race).json())
        while client.get(f"/races/{runs[-1]['id']}").json()["state"] != "finished":
            time.sleep(0.05)
    return runs


@pytest.mark.timeout(900)
@pytest.mark.looks_at_3d
def test_no_payload_in_a_run_name_is_executed(
    page: Page, server: Serving, payload_runs: list[dict[str, Any]], tmp_path: Path
) -> None:
    watched = Watched(page)
    page.goto(f"{server.address}#runs")
    rows = page.locator("li.run")
    expect(rows.first).to_be_visible()
    while (shown := rows.count()) < len(payload_runs):
        page.get_by_role("button", name="Show older runs").click()
        expect(rows).not_to_have_count(shown)
    text = page.locator("li.run").get_by_role("heading").all_text_contents()
    assert {run["name"] for run in payload_runs} <= set(text)
    watched.check()

    page.goto(server.address)
    for run in [payload_runs[-1], *payload_runs[:: len(payload_runs) // ON_STAGE]][: ON_STAGE + 1]:
        put = {"run_id": run["id"]}
        assert httpx2.put(f"{server.address}api/v1/stage", json=put).status_code == 200
        expect(page.locator("body")).to_contain_text(run["name"].strip()[:20])
        expect(page.locator(".stage")).to_have_attribute("data-status", "connected")
        watched.check()

    file = tmp_path / "race.html"
    answer = httpx2.get(f"{server.address}api/v1/runs/{payload_runs[-1]['id']}/page")
    file.write_bytes(answer.content)
    page.goto(file.as_uri())
    page.wait_for_selector(".player", state="visible")
    watched.check()


@pytest.mark.parametrize("path", ["docs", "nothing/", "viewer/", "api/v1/trainings/", "?x="])
def test_no_payload_in_a_url_is_executed(page: Page, quiet_server: Serving, path: str) -> None:
    watched = Watched(page)
    # This browser cannot draw; the view says so as an error, where a page stays long enough.
    page.add_init_script(WITHOUT_3D)
    for payload in at_length([BREAKS_OUT], payloads()):
        page.goto(quiet_server.address + path + html.escape(payload).replace("#", "%23"))
        page.goto(quiet_server.address + path + payload.replace("#", "%23"))
        watched.check()
