"""Below a path of a site, behind a real nginx: every page, and no request leaves the path."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2
import pytest
from playwright.sync_api import Browser, Page, expect

from app.features.classroom.names import in_groups
from tests.browser.dashboard import Dashboard
from tests.browser.rooms import PHONE, TOKEN, RoomPage
from tests.browser.serving import Serving, finished, serving
from tests.conftest import new_page
from tests.proxied import Location, Proxy, free_port, proxied

pytestmark = pytest.mark.timeout(400)

RACE: dict[str, Any] = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 10,
    "lanes": [{"agent": "q-learning", "training": {"steps": 40}}, {"agent": "greedy"}],
}
SHORT = "simulator=kinematic&lanes=q-learning,greedy&steps=40&depth=try"
LESSON: dict[str, Any] = {
    "title": "Below a path",
    "cards": [{"text": "Guess.", "ask": {"kind": "number", "text": "How far?"}}],
}


class Site:
    """A site that has the server below a path.

    Attributes:
        path: where, with slashes around it.
        address: of the path, with a slash at its end.
        strays: addresses outside the path that its pages have asked for.
    """

    def __init__(self, server: Serving, proxy: Proxy, path: str) -> None:
        """Describe a site; the proxy listens on this machine."""
        self.server, self._proxy, self.path = server, proxy, path
        self.origin = f"http://localhost:{proxy.port}"
        self.address = f"{self.origin}{path}"
        self.strays: list[str] = []

    def watch(self, page: Page) -> None:
        """Note what a page asks for outside the path."""

        def note(address: str) -> None:
            if urlsplit(address).scheme in ("http", "https") and not self.has(address):
                self.strays.append(address)

        page.on("request", lambda request: note(request.url))

    def check(self) -> None:
        """Check that nothing was asked for outside the path."""
        assert self.strays == []
        requested = self._proxy.requested()
        assert [path for path in requested if not self.has(f"{self.origin}{path}")] == []

    @contextmanager
    def api(self) -> Iterator[httpx2.Client]:
        """A client of the API through the proxy, of the operator."""
        headers = {"Authorization": f"Bearer {TOKEN}"}
        base = f"{self.address.replace('localhost', '127.0.0.1')}api/v1/"
        with httpx2.Client(base_url=base, headers=headers, timeout=60, trust_env=False) as client:
            yield client

    def has(self, address: str) -> bool:
        """Whether an address is the path, or below it."""
        return f"{address}/".startswith(self.address)


@contextmanager
def site(
    folder: Path,
    path: str,
    *,
    is_told: bool = True,
    is_stripped: bool = True,
    is_forwarded: bool = False,
) -> Iterator[Site]:
    """Serve below a path.

    Args:
        folder: an empty folder.
        path: with slashes around it.
        is_told: whether the server has the address as `HEXAPODS_PUBLIC_URL`.
        is_stripped: whether the proxy removes the path from requests.
        is_forwarded: whether the proxy sends the path in a header.
    """
    port = free_port()
    public_url = f"http://localhost:{port}{path}" if is_told else ""
    proxies = "127.0.0.1"
    data = folder / "data"
    with serving(data, token=TOKEN, public_url=public_url, trusted_proxies=proxies) as server:
        location = Location(path, server.address, is_stripped, forwards_path=is_forwarded)
        with proxied(folder / "proxy", port, [location]) as proxy:
            yield Site(server, proxy, path)


@contextmanager
def tab(
    browser: Browser, site: Site, *, has_3d: bool = False, **options: Any
) -> Iterator[RoomPage]:
    """A tab whose requests are noted, and that must not complain."""
    with new_page(browser, **options) as page:
        site.watch(page)
        watched = RoomPage(page, has_3d=has_3d)
        yield watched
        assert watched.complaints == [], watched.complaints


@pytest.mark.looks_at_3d
def test_every_page_stays_below_the_path(browser: Browser, tmp_path: Path) -> None:
    with site(tmp_path, "/hex/") as school:
        with tab(browser, school, has_3d=True) as operator:
            logs_in_and_races(operator, school)
        with tab(browser, school) as operator:
            opens_the_views(operator, school)
            reads_the_guide_and_the_documents(operator, school)
            shows_a_room(operator, browser, school)
            shows_a_tournament(operator, school)
        school.check()


def logs_in_and_races(operator: Dashboard, school: Site) -> None:
    """The link with the token leads to the page, in a session of the path alone; a race is held."""
    page = operator.page
    assert path_of_session_that_races(operator, school) == "/hex/"
    assert page.url.startswith(f"{school.address}?")
    assert "token" not in page.url
    [cookie] = page.context.cookies(school.address)
    assert cookie["sameSite"] == "Strict"
    assert page.context.cookies(f"{school.origin}/") == []
    # Of the 3D view, which is a page of its own.
    assert any(frame.url.startswith(f"{school.address}viewer/") for frame in page.frames)


def opens_the_views(operator: Dashboard, school: Site) -> None:
    """Views have addresses below the path, and what is downloaded and shared is there as well."""
    page = operator.page
    with school.api() as api:
        race = finished(api, "races", RACE)
        assert api.get("spectators").json()["address"] == school.address
        again = api.post(f"runs/{race['id']}/again")
        assert again.headers["location"] == f"/hex/api/v1/races/{again.json()['id']}"
        # With a slash too many it is found nevertheless.
        slashed = api.get("trainings/", follow_redirects=True)
        assert (slashed.status_code, slashed.url.path) == (200, "/hex/api/v1/trainings")
    operator.open(f"{school.address}?token={TOKEN}&run={race['id']}")
    expect(operator.button("One robot step on")).to_be_visible()
    for view in ("runs", "compare", "experiments"):
        page.goto(f"{school.address}{view}")
        expect(operator.connection).to_contain_text("connected")
        expect(page).to_have_url(f"{school.address}#{view}")
    page.goto(f"{school.address}runs")
    operator.run_names.first.click()
    details = operator.details
    expect(details).to_be_visible()
    links = details.get_by_role("link").evaluate_all("links => links.map(link => link.href)")
    assert [link for link in links if not link.startswith(school.address)] == []
    missing = page.request.get(f"{school.address}nothing/here", headers={"Accept": "text/html"})
    assert missing.status == 404
    assert 'href="../"' in missing.text()


def reads_the_guide_and_the_documents(operator: Dashboard, school: Site) -> None:
    """Guide and API document lead to pages below the path, and name addresses there."""
    page = operator.page
    page.goto(f"{school.address}guide")
    expect(page).to_have_url(f"{school.address}guide/page")
    links = page.get_by_role("link").evaluate_all("links => links.map(link => link.href)")
    assert [link for link in links if link.startswith(school.origin) and not school.has(link)] == []
    page.get_by_role("link", name="Host a demo", exact=True).first.click()
    expect(page).to_have_url(f"{school.address}guide/hosting")
    expect(page.get_by_role("heading", name="Host a demo")).to_be_visible()
    page.goto(f"{school.address}docs")
    expect(page.locator("body")).to_contain_text(f"curl {school.address}api/v1/runs")
    document = page.request.get(f"{school.address}openapi.json").json()
    assert document["servers"] == [{"url": "/hex"}]
    page.get_by_role("link", name="Back to the dashboard").click()
    expect(page).to_have_url(school.address)


def shows_a_room(operator: RoomPage, browser: Browser, school: Site) -> None:
    """Teacher, phone, projector and the stage of a room; its address has the path."""
    page = operator.page
    with school.api() as api:
        lesson = api.post("lessons", json=LESSON).raise_for_status().json()
        assert lesson["link"] == f"{school.address}l/{lesson['id']}"
        opened = api.post("rooms", json={"lesson": lesson["id"]}).raise_for_status().json()
    code = opened["code"]
    assert opened["address"] == f"{school.address}r/{in_groups(code)}"
    assert opened["qr_code"] is not None
    page.goto(lesson["link"])
    expect(operator.lesson).to_contain_text("Guess.")
    page.goto(f"{school.address}r/{code}")
    operator.sees("Nobody yet")
    with tab(browser, school, viewport=PHONE, has_touch=True, is_mobile=True) as pupil:
        pupil.page.goto(opened["address"])
        pupil.press("Join")
        name, _ = pupil.who
        [cookie] = pupil.page.context.cookies(school.address)
        assert cookie["path"] == "/hex/"
        operator.sees(name)
        page.goto(f"{school.address}r/{code}?projector")
        operator.sees(f"{opened['address'].removeprefix('http://')}")
        pupil.page.reload()
        assert pupil.who[0] == name
    # The dashboard of its stage.
    operator.open(f"{school.address}r/{code}/")


def shows_a_tournament(operator: RoomPage, school: Site) -> None:
    """The page of a tournament, with its address."""
    rules = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 20, "draws": 5}
    with school.api() as api:
        tournament = api.post("tournaments", json={"rules": rules}).raise_for_status().json()
    assert tournament["address"] == f"{school.address}t/{tournament['id']}"
    operator.page.goto(tournament["address"])
    operator.sees(tournament["commitment"][:8])


@pytest.mark.parametrize(
    ("path", "how"),
    [
        ("/user/ada@school/proxy/8000/", {"is_told": False, "is_forwarded": True}),
        ("/user/ada/proxy/absolute/8000/", {"is_stripped": False}),
    ],
)
def test_a_notebook_server_proxies_it(
    flat_browser: Browser, tmp_path: Path, path: str, how: dict[str, bool]
) -> None:
    """jupyter-server-proxy strips its path and forwards it, or passes it on as it is."""
    with site(tmp_path, path, **how) as hub, tab(flat_browser, hub) as operator:
        assert path_of_session_that_races(operator, hub) == path
        with hub.api() as api:
            opened = api.post("rooms").raise_for_status().json()
        assert urlsplit(opened["address"]).path == f"{path}r/{in_groups(opened['code'])}"
        if not how.get("is_stripped", True):
            operator.page.goto(hub.address.rstrip("/"))
            expect(operator.page).to_have_url(hub.address)
        hub.check()


def test_pages_work_below_a_path_of_which_the_server_knows_nothing(
    flat_browser: Browser, tmp_path: Path
) -> None:
    with site(tmp_path, "/plain/", is_told=False) as plain, tab(flat_browser, plain) as operator:
        assert path_of_session_that_races(operator, plain) == "/"
        operator.page.goto(f"{plain.address}guide")
        expect(operator.page).to_have_url(f"{plain.address}guide/page")
        operator.page.goto(f"{plain.address}api/v1/trainings/")
        expect(operator.page).to_have_url(f"{plain.address}api/v1/trainings")
        plain.check()


def path_of_session_that_races(operator: Dashboard, site: Site) -> str:
    """Log in and hold a race; return the path of the session's cookie."""
    operator.open(f"{site.address}?token={TOKEN}&{SHORT}")
    [cookie] = operator.page.context.cookies(site.address)
    operator.primary.click()
    expect(operator.rows).to_have_count(2)
    operator.eventually(lambda: operator.has_figures(2), "distances of both lanes")
    return cookie["path"]
