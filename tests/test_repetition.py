"""`hx.experiment`: many seeds in one call."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hexapods as hx

SWEEP: dict[str, Any] = {
    "simulator": "kinematic",
    "seeds": 2,
    "gaits": ["left-right-origin"],
    "agents": [hx.QLearning],
    "steps": [20],
    "alpha": [0.1, 0.3],
    "workers": 1,
}


def test_each_setting_has_its_mean_and_goes_on_where_it_ended(tmp_path: Path) -> None:
    seen: list[object] = []
    done = hx.experiment("sweep", folder=tmp_path / "kept", on_trial=seen.append, **SWEEP)
    assert len(seen) == len(done.trials) == 5
    assert [(setting.name, setting.seeds) for setting in done.settings] == [
        ("Greedy", 1),
        ("Q-learning, 20 steps, α 0.1", 2),
        ("Q-learning, 20 steps, α 0.3", 2),
    ]
    assert all(setting.iqm_m is not None for setting in done.settings)
    again = hx.experiment("sweep", folder=tmp_path / "kept", on_trial=seen.append, **SWEEP)
    assert len(seen) == 5
    assert again.settings == done.settings
    page = done.save_report(tmp_path / "report")
    assert "<html" in page.read_text("utf-8")
    assert "Greedy" in done._repr_html_()


def test_one_value_is_a_list_of_one() -> None:
    experiment = hx.experiment(
        "sweep",
        simulator="kinematic",
        seeds=1,
        workers=1,
        agents=hx.QLearning,
        gaits={"right_leg": 1, "left_leg": 2, "symmetry": "origin"},
        robots={"femur_m": 0.081},
        observations="measured",
        steps=np.arange(5, 7),
        alpha=0.3,
    )
    assert experiment.config.agents == ("q-learning",)
    assert experiment.config.gaits == (hx.Gait(1, 2, "origin"),)
    assert experiment.config.steps == (5, 6)
    assert [robot.femur_m for robot in experiment.config.robots] == [0.081]
    assert experiment.config.settings["alpha"] == (0.3,)
    assert len(experiment.trials) == 3


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"gaits": 3}, "gait is one of left-right-origin, .* or its legs, not 3"),
        ({"gaits": [["left-right-origin"]]}, r"or its legs, not \['left"),
        ({"robots": [3]}, "robot is stiff or .* a mapping or a Robot, not 3"),
        ({"agents": [3]}, "by its name or its class, not as 3"),
        ({"seeds": None}, "seeds must not be None; leave it out for its default"),
        ({"alpha": None}, "alpha must not be None"),
        ({"steps": ["a"]}, "steps must be a whole number .*, not 'a'"),
        ({"folder": 3}, "a folder is given by its path, .* not by 3"),
        ({"on_trial": 3}, "on_trial is a function"),
        ({"worlds": 3}, 'a text such as "ice" or "limp:legs=1,4", not 3'),
    ],
)
def test_invalid_values_of_lists_are_refused(arguments: dict[str, Any], reason: str) -> None:
    with pytest.raises(hx.InvalidInput, match=reason):
        hx.experiment("sweep", **{**SWEEP, **arguments})


AGENT = """
class Mine(hx.QLearning):
    pass
"""
GUARD = 'if __name__ == "__main__":'


@pytest.mark.promises
@pytest.mark.parametrize(
    ("agent", "line", "trials"),
    [("", "if True:", 2), (AGENT, GUARD, 2), (AGENT, "if True:", None)],
    ids=["no agents", "agents, guarded", "agents, not guarded"],
)
def test_only_a_program_that_defines_agents_needs_a_guard(
    tmp_path: Path, agent: str, line: str, trials: int | None
) -> None:
    program = tmp_path / "program.py"
    agents = ", agents=[Mine]" if agent else ""
    arguments = "simulator='kinematic', seeds=1, workers=1, gaits='left-right-origin', steps=5"
    call = f"print(len(hx.experiment('sweep', {arguments}{agents}).trials))"
    program.write_text(f"import hexapods as hx\n{agent}\n{line}\n    {call}\n")
    done = subprocess.run(
        [sys.executable, program.name], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    if trials is not None:
        assert done.stdout == f"{trials}\n", done.stderr
    else:
        error = "import program.py again for its agents, which would begin it again: put the lines"
        assert error in done.stderr.splitlines()[-1]
        assert "distributed" not in done.stderr


def test_invalid_arguments_are_refused() -> None:
    with pytest.raises(hx.UnknownName, match="unknown experiment 'swep'; choose one of: table1"):
        hx.experiment("swep")
    with pytest.raises(hx.UnknownName, match="unknown field of sweep 'gait'"):
        hx.experiment("sweep", gait=["left-right-origin"])
