"""Settings compared and figures drawn by REST."""

import io
import zipfile
from typing import Any
from urllib.parse import quote

import pytest

from tests.api.calls import Api, refused
from tests.features.experiments.test_routes import SMALL


@pytest.fixture(scope="module")
def compared(api: Api) -> dict[str, Any]:
    """Return a finished sweep of two settings, with their keys."""
    run = api.finished(api.start("/experiments", {**SMALL, "seeds": 6}))
    settings = api.get(f"/experiments/{run['id']}/summary")["settings"]
    return {"id": run["id"], "keys": [entry["key"] for entry in settings]}


def test_two_settings_are_compared(compared: dict[str, Any], api: Api) -> None:
    greedy, *learners = map(quote, compared["keys"])
    path = f"/experiments/{compared['id']}/comparison"
    answer = api.get(f"{path}?a={learners[0]}&b={learners[1]}")
    assert answer["a"]["seeds"] == answer["b"]["seeds"] == 6
    assert answer["is_paired"] is False
    difference = answer["difference"]
    assert difference["value"] == answer["a"]["iqm"]["value"] - answer["b"]["iqm"]["value"]
    assert difference["low"] <= difference["value"] <= difference["high"]
    assert answer == api.get(f"{path}?a={learners[0]}&b={learners[1]}")
    assert api.get(f"{path}?a={greedy}&b={learners[1]}&unit=greedy")["a"]["iqm"]["value"] == 1
    refused(api.call("GET", f"{path}?a={greedy}&b=nobody"), 422, "nobody")
    refused(api.call("GET", f"{path}?a={greedy}&b={greedy}"), 422, "compared with itself")
    refused(api.call("GET", f"{path}?a={greedy}&b={learners[0]}&unit=km"), 422)
    refused(api.call("GET", "/experiments/nobody/comparison?a=x&b=y"), 404)


def test_a_figure_is_returned_as_a_picture_and_as_an_archive(
    compared: dict[str, Any], api: Api
) -> None:
    pytest.importorskip("matplotlib")
    _, *learners = map(quote, compared["keys"])
    path = f"/experiments/{compared['id']}/figure"
    chosen = "&".join(f"setting={key}" for key in learners)
    answer = api.call("GET", f"{path}?kind=comparison&{chosen}")
    assert answer.headers["content-type"] == "application/zip"
    assert f'filename="comparison-{compared["id"]}.zip"' in answer.headers["content-disposition"]
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        pdf = archive.read("figure.pdf")
    assert pdf.startswith(b"%PDF-")
    assert api.call("GET", f"{path}?kind=comparison&{chosen}&format=pdf").content == pdf
    refused(api.call("GET", f"{path}?kind=comparison"), 422, "of two settings, and 0 are named")
    refused(api.call("GET", f"{path}?columns=3"), 422, "must be 1 or 2")
    refused(api.call("GET", f"{path}?kind=x"), 422, "must be seeds, comparison or profile")
    refused(api.call("GET", f"{path}?setting={'x' * 1001}"), 422, "at most 1000 characters")
