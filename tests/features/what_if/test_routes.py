"""What-ifs and estimates over REST: what is answered, refused and limited."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter
from starlette.testclient import TestClient

from app.api.answers import ComparisonView
from app.api.deps import Services
from app.api.policy import policies
from app.features.what_if.allowance import WHAT_IF
from app.features.what_if.estimate import Estimates
from app.features.what_if.response_models import EstimateView
from app.features.what_if.settings import WhatIfSettings
from app.features.what_if.what_if import MAX_STEPS, SEEDS, WhatIf
from app.jobs.submissions import TrainingStart
from app.server import create_app
from app.settings import Settings
from app.storage.errors import Busy
from hexapods.runs.config import training_config
from tests.api.calls import ADDRESS, WALK, Api, refused
from tests.storage.stores import temporary_store

Serve = Callable[..., Api]
TOKEN = "a-token-for-tests"


@pytest.mark.parametrize("body", [{"gait": "hop"}, {"gait": "left-right-origin", "steps": 2_001}])
def test_invalid_what_if_is_refused(serve: Serve, body: dict[str, Any]) -> None:
    refused(serve().call("POST", "/what-if", json=body), 422)


def test_what_if_that_continues_a_training_is_refused(serve: Serve) -> None:
    body = {"gait": "left-right-origin", "continue_from": "abc"}
    refused(serve().call("POST", "/what-if", json=body), 422, "continue_from")


def test_what_if_compares_chosen_with_default_settings(api: Api) -> None:
    body = {"gait": "left-right-origin", "steps": 20, "seed": 3, "name": "x"}
    body["settings"] = {"alpha": 0.7}
    answer = api.call("POST", "/what-if", json=body).json()
    assert (answer["seeds"], len(answer["chosen"]["distances_m"])) == (30, 30)
    assert (answer["chosen"]["settings"]["alpha"], answer["default"]["settings"]["alpha"]) == (
        0.7,
        0.3,
    )
    assert answer["compute_s"] > 0


def test_what_ifs_of_spectators_are_limited_by_address(serve: Serve) -> None:
    api = serve(features=(WhatIfSettings(what_ifs_per_minute=3),), token=TOKEN)
    for _ in range(3):
        refused(api.call("POST", "/what-if", json={"steps": 0}), 422)
    answer = api.call("POST", "/what-if", json={"steps": 0})
    refused(answer, 429, "3 times a minute", "ask again in 20 s", "HEXAPODS_WHAT_IFS_PER_MINUTE")
    assert answer.headers["retry-after"] == "20"
    # Reading goes on, operators have no such limit, and the answer to a spectator is a whole one.
    assert api.get("/stage")["run_id"] is None
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    for _ in range(5):
        refused(api.call("POST", "/what-if", json={"steps": 0}, headers=bearer), 422)
    other = serve(token=TOKEN).call("POST", "/what-if", json={**WALK, "steps": 5})
    assert other.status_code == 200, other.text
    assert len(other.json()["chosen"]["distances_m"]) == other.json()["seeds"]


def test_what_ifs_have_slots_of_their_own(api: Api) -> None:
    of_routes = policies(api.client.app)  # type: ignore[arg-type]
    assert of_routes["post", "/api/v1/what-if"].work is WHAT_IF


def test_answers_match_their_models(api: Api) -> None:
    practice = {**WALK, "steps": 5}
    race = {**WALK, "lanes": [{"agent": "greedy"}], "steps": 5}
    comparison = api.call("POST", "/what-if", json=practice).json()
    TypeAdapter(ComparisonView).validate_python(comparison)
    for path, body in (("trainings", practice), ("races", race)):
        estimate = api.call("POST", f"/{path}/estimate", json=body).json()
        TypeAdapter(EstimateView).validate_python(estimate)
        assert estimate["workers"] is None


def test_options_have_the_seeds_and_the_most_steps_of_a_what_if(serve: Serve) -> None:
    options = serve().get("/options")
    assert options["defaults"]["what_if"] == {"seeds": SEEDS}
    assert options["limits"]["what_if_steps"] == [1, MAX_STEPS]
    assert "steps" in options["help"]["what_if_steps"]
    without = serve(without=("what_if",)).get("/options")
    assert "what_if" not in without["defaults"]
    assert "what_if_steps" not in without["limits"].keys() | without["help"].keys()


def test_pools_end_with_the_server(tmp_path: Path) -> None:
    with temporary_store() as store:
        app = create_app(Settings(data=tmp_path), store)
        with TestClient(app, base_url=ADDRESS):
            services: Services = app.state.services
        training = training_config(**WALK, steps=5)
        with pytest.raises(Busy, match="the server is stopping"):
            services.of(WhatIf).ask(training)
        with pytest.raises(Busy, match="the server is stopping"):
            services.of(Estimates).of(TrainingStart(training))
