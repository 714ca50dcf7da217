"""A person whose browser opens a refused address gets a page; programs get the document."""

import pytest

from tests.api.calls import Api, refused

BROWSER = {"Accept": "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"}


@pytest.mark.parametrize("path", ["/nothing", "/api/v1/races/none", "/api/v1/runs?kind=walk"])
def test_browsers_get_a_page_with_a_link_to_the_dashboard(api: Api, path: str) -> None:
    document = api.client.get(path)
    page = api.client.get(path, headers=BROWSER)
    assert page.status_code == document.status_code
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.headers["vary"] == document.headers["vary"] == "Accept"
    assert page.headers["content-security-policy"] == document.headers["content-security-policy"]
    assert document.json()["title"] in page.text
    levels = path.partition("?")[0].count("/") - 1
    assert f'<a href="{"../" * levels or "./"}">' in page.text
    head = api.client.head(path, headers=BROWSER)
    assert (head.status_code, head.text) == (page.status_code, "")
    assert head.headers["content-length"] == page.headers["content-length"]


def test_what_an_address_says_is_escaped(api: Api) -> None:
    page = api.client.get("/%3Cscript%3Ealert(1)%3C/script%3E", headers=BROWSER)
    assert page.status_code == 404
    assert "<script>" not in page.text
    assert "&lt;script&gt;" in page.text


def test_programs_get_the_document_and_pages_stay_as_they_are(api: Api) -> None:
    refused(api.client.get("/nothing", headers={"Accept": "application/json, text/html"}), 404)
    refused(api.client.get("/nothing", headers={"Accept": "*/*"}), 404)
    assert "REST" in api.client.get("/docs", headers=BROWSER).text
    assert "items" in api.client.get("/api/v1/runs", headers=BROWSER).json()
