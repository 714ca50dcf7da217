"""`hx.view`: a race as a page that plays it without a server."""

from pathlib import Path

import pytest

import hexapods as hx


def test_a_race_is_a_page(tmp_path: Path) -> None:
    race = hx.race(["greedy", "wave"], steps=3, simulator="kinematic")
    view = hx.view(race, title="A <race>")
    page = view.save(tmp_path / "race.html").read_text("utf-8")
    assert "<title>A &lt;race&gt;</title>" in page
    assert '"kind": "race"' in page
    assert "default-src 'none'" in page
    assert 'srcdoc="&lt;!' in view._repr_html_().lower()
    assert repr(view).startswith("<View of A <race>: ")


def test_a_training_walks_alone() -> None:
    training = hx.train(steps=20, simulator="kinematic", seed=3)
    assert hx.view(training).title == "Q-learning: 50 steps"


def test_an_unknown_clock_is_refused() -> None:
    with pytest.raises(hx.UnknownName, match="paper, wall, free"):
        hx.view(hx.race(["wave"], steps=2, simulator="kinematic"), clock="sun")  # type: ignore[arg-type]
