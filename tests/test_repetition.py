"""`hx.experiment`: many seeds in one call."""

from pathlib import Path
from typing import Any

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
    assert [(one.name, one.seeds) for one in done.settings] == [
        ("Greedy", 1),
        ("Q-learning, 20\N{NO-BREAK SPACE}steps, α\N{NO-BREAK SPACE}0.1", 2),
        ("Q-learning, 20\N{NO-BREAK SPACE}steps, α\N{NO-BREAK SPACE}0.3", 2),
    ]
    assert all(one.iqm_m is not None for one in done.settings)
    again = hx.experiment("sweep", folder=tmp_path / "kept", on_trial=seen.append, **SWEEP)
    assert len(seen) == 5
    assert again.settings == done.settings
    page = done.save_report(tmp_path / "report")
    assert "<html" in page.read_text("utf-8")
    assert "Greedy" in done._repr_html_()


def test_invalid_arguments_are_refused() -> None:
    with pytest.raises(hx.UnknownName, match="unknown experiment 'swep'; choose one of: table1"):
        hx.experiment("swep")
    with pytest.raises(hx.InvalidInput, match=r"agents is a list, such as \['q-learning'\]"):
        hx.experiment("sweep", agents="q-learning")
    with pytest.raises(hx.UnknownName, match="unknown field of sweep 'gait'"):
        hx.experiment("sweep", gait=["left-right-origin"])
