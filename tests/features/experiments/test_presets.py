"""A preset is data: one value more is an experiment in every place."""

from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from app.features.experiments.options import experiment_options
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.experiments.config import experiment_config
from hexapods.experiments.names import experiment_name
from hexapods.experiments.plan import Plan
from hexapods.experiments.presets import PRESETS, Preset
from hexapods.experiments.report.command import command
from tests.cli.running import in_process, refusal

TWO_WORLDS = Preset(
    name="two-worlds",
    title="Two worlds",
    description="Q-learning on flat ground, and with noise.",
    fields=("seeds", "agents", "gaits", "worlds", "steps", "simulator"),
    defaults={
        "gaits": ("left-right-origin",),
        "observations": ("measured",),
        "worlds": ("flat", "noise"),
        "steps": (30,),
    },
    measure="practice",
    reached_share=0.8,
)


@pytest.fixture(autouse=True)
def added(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PRESETS, TWO_WORLDS.name, TWO_WORLDS)


def test_an_added_preset_is_planned_named_and_summarised() -> None:
    config = experiment_config("two-worlds", {"seeds": 2, "simulator": "kinematic"})
    assert experiment_name(config) == "Two worlds: Flat ground, Sensor noise · 2 seeds"
    learners = [s for s in Plan(config).settings if s.role == "learner"]
    assert [(s.world, s.trial.evaluations) for s in learners] == [
        ("flat", (25, 30)),
        ("noise", (25, 30)),
    ]
    done = hx.experiment("two-worlds", seeds=2, simulator="kinematic", workers=1)
    curves = [entry for entry in done.summary["worlds"] if entry["curve"]]
    assert [(entry["world"], entry["until_greedy"]["of"]) for entry in curves] == [
        ("flat", 0.8),
        ("noise", 0.8),
    ]
    assert done.summary["finding"].startswith("Q-learning walks ")
    assert (done.summary["claims"], done.summary["story"]) == ([], [])
    assert command(done.summary["config"]).startswith("hexapods experiment two-worlds ")


def test_an_added_preset_is_among_the_options() -> None:
    *_, option = experiment_options(["q-learning", "greedy"])
    assert (option["name"], option["title"]) == ("two-worlds", "Two worlds")
    assert option["fields"] == list(TWO_WORLDS.fields)
    assert option["defaults"]["worlds"] == ["flat", "noise"]
    assert option["agents"] == ["q-learning", "greedy"]


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"tolerance": 0.1}, UnknownName, "choose one of: seeds, agents, gaits, worlds, steps"),
        ({"worlds": ()}, InvalidInput, "worlds must name at least one"),
        ({"alpha": (0.1,)}, UnknownName, "field of two-worlds 'alpha'"),
    ],
)
def test_what_a_preset_does_not_take_is_refused_with_what_is_valid(
    values: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        experiment_config("two-worlds", values)


def test_an_added_preset_is_a_choice_of_the_command(tmp_path: Path) -> None:
    arguments = ("experiment", "two-worlds", "--reward", "track")
    message = refusal(*arguments, folder=tmp_path, run=in_process)
    assert "--reward is for league, recovery, groups and bodies, not two-worlds" in message
