"""The presentation's state is stored with the stage, and published to all who watch it."""

from pathlib import Path

from app.settings import Settings
from tests.api.calls import Api, refused
from tests.api.conftest import running

START = {"card": None, "shows_why": False, "is_blank": False, "code": "large"}


def test_the_presentation_is_set_and_returned_with_the_stage(api: Api) -> None:
    assert api.get("/stage")["presentation"] == START
    shown = {**START, "card": 3, "code": "small"}
    assert api.call("PUT", "/stage", json={"presentation": shown}).json()["presentation"] == shown
    stage = api.call("PUT", "/stage", json={"playing": False}).json()
    assert (stage["presentation"], stage["playing"]) == (shown, False)
    api.call("PUT", "/stage", json={"playing": True, "presentation": {}})
    assert api.get("/stage")["presentation"] == START


def test_an_invalid_presentation_is_refused(api: Api) -> None:
    invalid: list[tuple[object, str]] = [
        ({"card": 0}, "presentation.card must be the number of a card, from 1 to 99, or null"),
        ({"card": 100}, "presentation.card must be the number of a card, from 1 to 99, or null"),
        ({"code": "huge"}, "presentation.code must be large, small or none"),
        ({"shows_why": 1}, "presentation.shows_why must be true or false"),
        ({"lights": "off"}, "choose one of: card, shows_why, is_blank, code"),
        (3, "presentation must be an object with any of card"),
    ]
    for presentation, words in invalid:
        refused(api.call("PUT", "/stage", json={"presentation": presentation}), 422, words)
    assert api.get("/stage")["presentation"] == START


def test_without_the_feature_the_stage_has_none(tmp_path: Path) -> None:
    with running(Settings(data=tmp_path, without=("presenter",))) as api:
        assert "presentation" not in api.get("/stage")
        refused(api.call("PUT", "/stage", json={"presentation": START}), 422, "presentation")
        assert api.call("PUT", "/stage", json={"playing": False}).json()["playing"] is False
        described = api.client.get("/openapi.json").json()["components"]["schemas"]
        assert "presentation" not in described["StageView"]["properties"]
