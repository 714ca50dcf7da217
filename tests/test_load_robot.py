"""Robots from files in Python."""

from pathlib import Path

import pytest

import hexapods as hx
from hexapods.domain.robot import document_of
from tests.imports.robots import dog


@pytest.mark.test
def test_a_robot_from_a_file_is_trained_and_known_by_its_id(tmp_path: Path) -> None:
    (tmp_path / "spot.xml").write_text(dog())
    spot = hx.load_robot(tmp_path / "spot.xml")
    assert spot.name == "spot"
    trained = hx.train("q-learning", gait="trot", robot=spot, steps=3, evaluate_every=0)
    again = hx.train("q-learning", gait="trot", robot={"id": spot.id}, steps=3, evaluate_every=0)
    assert trained.result == again.result
    trained.save(tmp_path / "q.npz")
    (tmp_path / "spot.json").write_bytes(document_of(spot))
    assert hx.load_robot(tmp_path / "spot.json", "Rover").id == spot.id
    assert hx.load(tmp_path / "q.npz").config.robot == spot


def test_a_file_without_a_robot_is_refused(tmp_path: Path) -> None:
    with pytest.raises(hx.InvalidInput, match="cannot read"):
        hx.load_robot(tmp_path / "no.xml")
    (tmp_path / "bad.json").write_text("{}")
    with pytest.raises(hx.DamagedFile, match="damaged"):
        hx.load_robot(tmp_path / "bad.json")
    (tmp_path / "bad.xml").write_text("<mujoco/>")
    with pytest.raises(hx.InvalidInput):
        hx.load_robot(tmp_path / "bad.xml")
