"""The guide: the documentation as pages of the server."""

import re
from collections.abc import Callable
from urllib.parse import urljoin

from app.features.guide.pages import contents, names_of
from hexapods import assets
from tests.api.calls import Api, refused

DOCS = assets.docs_dir()
NAMES = sorted(names_of(DOCS))


def test_the_guide_has_four_parts_with_every_page_but_those_for_who_publishes() -> None:
    assert [*contents(DOCS)] == ["Tutorial", "How to", "Reference", "Explanation"]
    written = {path.stem for path in DOCS.glob("*.md")}
    assert written - {*NAMES} == {"index", "releasing"}


def test_each_page_is_shown_with_its_title_and_links_to_the_others(
    shared: Callable[..., Api],
) -> None:
    client = shared().client
    for name in NAMES:
        page = client.get(f"/guide/{name}")
        assert page.status_code == 200
        title = (DOCS / f"{name}.md").read_text("utf-8").partition("\n")[0][2:]
        assert f"<title>{title}" in page.text.replace("&#39;", "'")
        assert "{toctree}" not in page.text  # a directive of Sphinx
        assert re.findall(r"</\w+ |<a[^>]*></a>", page.text) == [], name


def test_links_lead_to_pages_of_the_server_or_elsewhere_and_to_no_file_that_it_lacks(
    shared: Callable[..., Api],
) -> None:
    client = shared().client
    for name in NAMES:
        [_, rest] = client.get(f"/guide/{name}").text.split("<main>")
        [main, _] = rest.split("</main>")
        assert [
            href
            for href in re.findall(r'<a [^>]*href="([^"]*)"', main)
            if not re.fullmatch(r"https?://.+|[\w-]+(#[\w-]+)?", href)
        ] == [], name


def test_links_of_the_contents_lead_to_pages(shared: Callable[..., Api]) -> None:
    """As a browser follows them: relative to the page, since its policy forbids another base."""
    client = shared().client
    page = client.get("/guide/page")
    assert "<base" not in page.text
    around = re.sub(r"<main>.*</main>", "", page.text, flags=re.DOTALL)
    hrefs = re.findall(r'href="([^"]+)"', around)
    assert {"../", "../docs", "tutorial", "#contents"} <= {*hrefs}
    for href in hrefs:
        assert client.get(urljoin("/guide/page", href)).status_code == 200, href


def test_links_to_a_part_of_a_page_find_it(shared: Callable[..., Api]) -> None:
    client = shared().client
    for name in NAMES:
        for other, anchor in re.findall(
            r'href="([\w-]+)#([\w-]+)"', client.get(f"/guide/{name}").text
        ):
            assert f'id="{anchor}"' in client.get(f"/guide/{other}").text, (name, other, anchor)


def test_the_address_of_the_guide_leads_to_its_first_page_below_any_prefix(
    shared: Callable[..., Api],
) -> None:
    answer = shared().client.get("/guide", follow_redirects=False)
    assert (answer.status_code, answer.headers["location"]) == (307, "guide/page")
    assert shared().client.get("/guide", follow_redirects=True).status_code == 200


def test_an_unknown_page_is_refused_with_the_pages_that_there_are(
    shared: Callable[..., Api],
) -> None:
    refused(shared().client.get("/guide/nothing"), 404, "nothing", "tutorial", "architecture")
