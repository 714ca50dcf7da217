"""Answers about experiments match their response models."""

import pytest

from app.features.experiments.response_models import (
    ExperimentPage,
    ExperimentView,
    SummaryView,
    TrialsView,
)
from hexapods.domain.records import from_json
from tests.api.calls import Api
from tests.experiments.sample_experiments import around, summary_of, walked


def test_real_responses_match_their_models(api: Api) -> None:
    body = {"experiment": "sweep", "seeds": 2, "steps": 20, "gaits": "left-right-origin"}
    experiment = api.start("/experiments", {**body, "simulator": "kinematic", "workers": 1})
    address = f"/experiments/{experiment['id']}"
    from_json(ExperimentView, experiment)
    from_json(SummaryView, api.get(f"{address}/summary"))
    from_json(ExperimentView, api.finished(experiment))
    from_json(SummaryView, api.get(f"{address}/summary"))
    from_json(TrialsView, api.get(f"{address}/trials"))
    assert from_json(ExperimentPage, api.get("/experiments")).items


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
def test_summaries_of_every_experiment_match_the_model(experiment: str) -> None:
    agents = {} if experiment == "table1" else {"agents": ("q-learning", "greedy")}
    if experiment == "figure4":
        agents = {}
    for seeds in (1, 10):
        summary = summary_of(experiment, lambda setting: around(0.4), seeds=seeds, **agents)
        from_json(SummaryView, summary)
        assert summary["settings"]


def test_summary_of_a_run_experiment_matches_the_model() -> None:
    from hexapods.experiments.summary import summarise

    tried, results = walked("table1", 2, gaits=("left-right-origin",))
    from_json(SummaryView, summarise(tried, results, {"key#0": "it died"}))
