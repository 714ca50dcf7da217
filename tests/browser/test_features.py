"""The page without some of its features: it says nothing of them, and a race runs."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Route, expect

from app.api.deps import PageFiles
from app.api.pages import page_features
from app.installed_features import load
from hexapods import assets
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving

pytestmark = pytest.mark.timeout(300)

NAMES = [feature["name"] for feature in page_features(PageFiles(assets.static_dir()))]
FORM = {"depth": "study", "simulator": "kinematic", "steps": "20", "lanes": "q-learning,greedy"}
WORDS = {
    "classroom": "lesson|room",
    "tournaments": "tournament",
    "demo": "demo",
    "what_if": "What if",
    "exports": "Joints and feet|Video",
    "archives": "Archive|Import|Export",
    "robots": "Edit the body|Your robot",
    "presenter": "Present|Remote",
}
"""How the page speaks of a feature."""


@pytest.fixture
def server(without: set[str], tmp_path: Path) -> Iterator[Serving]:
    """A server that leaves out those of its features."""
    left_out = {feature.name for feature in load().classes} & without
    with serving(tmp_path, without=",".join(sorted(left_out))) as fresh:
        yield fresh


def leave_out(dashboard: Dashboard, server: Serving, without: set[str]) -> None:
    """Serve the page as if those of its features had no folders that are no server's."""

    def reduce(route: Route) -> None:
        response = route.fetch()
        remaining = [
            f for f in page_features(PageFiles(assets.static_dir())) if f["name"] not in without
        ]
        folders = "|".join(without)
        body = re.sub(
            r'(id="features">).*?(</script>)',
            lambda match: match[1] + json.dumps(remaining) + match[2],
            re.sub(rf"<link [^>]*features/(?:{folders})/[^>]*>\n", "", response.text()),
        )
        route.fulfill(response=response, body=body)

    dashboard.page.route(re.compile(rf"^{re.escape(server.address)}(\?.*)?$"), reduce)
    for name in without:
        dashboard.page.route(
            f"**/static/features/{name}/**", lambda route: route.fulfill(status=404)
        )


@pytest.mark.parametrize(
    "without", [{"classroom", "tournaments", "demo"}, {*NAMES}], ids=["the farthest", "all"]
)
def test_a_race_runs_on_a_page_without_features(
    dashboard: Dashboard, server: Serving, without: set[str]
) -> None:
    leave_out(dashboard, server, without)
    dashboard.open(server.link(**FORM))
    dashboard.page.get_by_role("button", name=re.compile("^Train 20 steps")).first.click()
    dashboard.eventually(lambda: dashboard.has_figures(2), "both lanes have a distance")
    dashboard.page.locator("body").press("e")
    dashboard.choose_depth("Watch")
    explains = dashboard.page.get_by_role("button", name=re.compile("^Explain"))
    expect(explains).to_have_count(0 if "explanations" in without else 1)
    dashboard.page.get_by_label("More", exact=True).first.click()
    expect(dashboard.page.get_by_role("menuitem", name="Keys and help")).to_be_visible()
    said = dashboard.page.locator("#app").inner_text()
    response = dashboard.page.request.get(f"{server.address}static/features/classroom/feature.js")
    assert response.status == 404
    heard = [name for name in without & {*WORDS} if re.search(rf"\b(?:{WORDS[name]})s?\b", said)]
    assert heard == []
