"""Checkpoints: round trip, rejection of invalid files, and fit to the walking problem."""

import io
import json
import pickle
import zipfile
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.agents.q_learning import QLearning
from hexapods.agents.q_table import QTable
from hexapods.agents.table_rows import TableRows
from hexapods.assembly import build_learner
from hexapods.domain.errors import DamagedFile, OtherFormat, TableMismatch
from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import robot
from hexapods.domain.settings import SettingValues
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.tables import (
    FORMAT,
    Checkpoint,
    check_fits,
    continue_from,
    from_bytes,
    snapshot,
    table_of,
    to_bytes,
)
from hexapods.runs.training import train

CONFIG = training_config(
    gait="left-right-origin", simulator="kinematic", steps=120, evaluate_every=0
)


def trained(config: TrainingConfig = CONFIG) -> Checkpoint:
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    return snapshot(learner, config)


TABLE = trained()
FILE = to_bytes(TABLE)


def same(before: Checkpoint, after: Checkpoint) -> bool:
    return (
        before.meta == after.meta
        and set(before.arrays) == set(after.arrays)
        and all(
            a.dtype == after.arrays[name].dtype and a.tobytes() == after.arrays[name].tobytes()
            for name, a in before.arrays.items()
        )
    )


def test_checkpoint_round_trips_through_a_file() -> None:
    assert same(from_bytes(FILE, "q.npz"), TABLE)
    assert to_bytes(from_bytes(FILE, "q.npz")) == FILE


def test_checkpoint_has_everything_needed_to_resume() -> None:
    meta, arrays = TABLE.meta, set(TABLE.arrays)

    assert {"agent.q", "agent.n", "agent.where", "agent.learned", "agent.rates"} <= arrays
    assert {"state.feet", "state.travel"} <= arrays
    assert meta["step"] == 120
    assert json.loads(meta["rng"])["bit_generator"] == "PCG64"
    assert meta["gait"] == "left-right-origin"
    assert meta["pairs"] == [[1, 4], [2, 5], [3, 6]]
    assert meta["observation"] == "measured"


def test_checkpoint_on_mujoco_has_the_full_state_vector() -> None:
    config = replace(CONFIG, simulator="mujoco", steps=2)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass

    row = snapshot(learner, config).arrays["state.row"]
    assert row.tobytes() == learner.walker.state.row.tobytes()  # type: ignore[attr-defined]


def test_numpy_loads_the_file_without_pickle() -> None:
    with np.load(io.BytesIO(FILE), allow_pickle=False) as file:
        assert json.loads(str(file["meta"]))["format"] == FORMAT
        assert np.isfinite(file["agent.q"]).all()


def test_table_of_a_checkpoint_has_the_learned_values() -> None:
    learner = build_learner(CONFIG)
    for _ in train(learner, CONFIG):
        pass
    agent = learner.walker.agent
    assert isinstance(agent, QLearning)
    table = table_of(from_bytes(FILE, "q.npz"))
    assert isinstance(table, TableRows)
    assert isinstance(agent.table, QTable)

    assert table.sha256() == agent.table.sha256()
    for (_, values, visits), (_, expected, counts) in zip(
        table.rows(), agent.table.rows(), strict=True
    ):
        assert np.array_equal(values, expected, equal_nan=True)
        assert np.array_equal(visits, counts, equal_nan=True)
    assert sum(np.nansum(visits) for _, _, visits in table.rows()) == 120


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gait": "front-back-origin"}, "for gait left-right-origin, this run has front-back-orig"),
        ({"gait": "left-right-vertical"}, "for gait left-right-origin, this run has left-right-v"),
        ({"gait": GaitSpec(2, 3, "origin")}, "for gait left-right-origin, this run has right 2,"),
        ({"robot": robot({"n_legs": 8})}, "for legs 6, this run has 8"),
        (
            {"robot": robot({"legs": [{"azimuth_deg": a} for a in (0, 50, 120, 180, 230, 300)]})},
            "for azimuths_deg",
        ),
        ({"divisions": 3}, "for divisions 2, this run has 3"),
        ({"grid_side_m": 0.05}, r"for grid_side_m 0\.04, this run has 0\.05"),
        ({"observation": "commanded"}, "for observation measured, this run has commanded"),
    ],
)
def test_table_of_another_walking_problem_is_refused(changes: dict[str, Any], message: str) -> None:
    config = replace(CONFIG, **changes)
    with pytest.raises(TableMismatch, match=message + ".*; choose a table of the same gait"):
        check_fits(TABLE, config, config.observation)
    with pytest.raises(TableMismatch, match=message):
        build_learner(config, TABLE)


def test_table_fits_another_robot_and_simulator() -> None:
    config = replace(CONFIG, robot=robot("slippery"), simulator="mujoco")

    check_fits(TABLE, config, config.observation)
    check_fits(TABLE, replace(config, observation="commanded"))  # a race takes the table's own


def test_table_of_another_agent_is_refused() -> None:
    wanderer = replace(CONFIG, agent="tests.own_agents:Restless", settings=SettingValues({}))
    foreign = trained(wanderer)

    with pytest.raises(TableMismatch, match="this is no Q-table: it lacks n, q, shape, where"):
        build_learner(CONFIG, foreign)
    with pytest.raises(TableMismatch, match="Restless cannot load what q-learning has learned"):
        build_learner(wanderer, TABLE)
    with pytest.raises(TableMismatch, match="Restless keeps no Q-table"):
        table_of(foreign)


def members() -> dict[str, Any]:
    with np.load(io.BytesIO(FILE), allow_pickle=False) as file:
        return dict(file)


def npz(arrays: dict[str, Any], compressed: bool = False) -> bytes:
    buffer = io.BytesIO()
    (np.savez_compressed if compressed else np.savez)(buffer, **arrays)
    return buffer.getvalue()


def without(name: str) -> dict[str, Any]:
    return {key: value for key, value in members().items() if key != name}


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "worn.npz is not a Q-table of this product"),
        (b"step,distance\n1,2\n", "worn.npz is not a Q-table of this product"),
        (pickle.dumps({"q": 1}), "worn.npz is not a Q-table of this product"),
        (b"PK\x05\x06" + b"\0" * 18, "worn.npz is not a Q-table of this product: .*digest"),
        (npz({"q": np.zeros(3)}), "worn.npz is not a Q-table of this product: .*digest"),
        (npz(without("meta")), "worn.npz is (damaged|not a Q-table)"),
        (npz(without("agent.q")), "worn.npz is damaged: its contents do not match its checksum"),
        (npz({**members(), "more": np.zeros(1)}), "worn.npz is damaged"),
        (npz({**members(), "agent.q": members()["agent.q"] * 2}), "worn.npz is damaged"),
        (npz({**members(), "meta": np.array('{"format": 2}')}), "worn.npz is damaged"),
        (npz({**members(), "meta": np.array("not json")}), "worn.npz is not a Q-table"),
        (npz(members(), compressed=True), "its members are compressed; write it with numpy.savez"),
    ],
)
def test_invalid_file_is_refused_with_its_name(data: bytes, message: str) -> None:
    with pytest.raises(DamagedFile, match=message):
        from_bytes(data, "worn.npz")


@given(st.integers(0, len(FILE) - 1))
def test_truncated_file_is_refused(length: int) -> None:
    with pytest.raises(DamagedFile, match=r"worn.npz is"):
        from_bytes(FILE[:length], "worn.npz")


@given(st.integers(0, 8 * len(FILE) - 1))
def test_flipped_bit_is_detected_or_irrelevant(bit: int) -> None:
    """Irrelevant bits are in metadata of the zip, such as a date."""
    data = bytearray(FILE)
    data[bit // 8] ^= 1 << bit % 8
    try:
        read = from_bytes(bytes(data), "worn.npz")
    except DamagedFile as error:
        assert str(error).startswith("worn.npz is")  # noqa: PT017
    else:
        assert same(read, TABLE)


def test_flipped_bit_in_a_value_is_detected() -> None:
    value = TABLE.arrays["agent.q"].tobytes()
    data = bytearray(FILE)
    data[FILE.index(value) + 3] ^= 16
    with pytest.raises(DamagedFile, match=r"worn.npz"):
        from_bytes(bytes(data), "worn.npz")


@pytest.mark.test
def test_zip_bomb_is_refused_before_unpacking() -> None:
    bomb = npz({"q": np.zeros(20_000_000)}, compressed=True)  # 160 MB in 160 kB
    assert len(bomb) < 1_000_000
    with pytest.raises(DamagedFile, match=r"boom.npz .* compressed"):
        from_bytes(bomb, "boom.npz")


def test_overlapping_members_are_refused() -> None:
    """Several entries of a zip's central directory may refer to the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("a.npy", np.zeros(2000).tobytes())
        for name in ("b.npy", "c.npy"):
            again = copy(archive.filelist[0])
            again.filename = again.orig_filename = name
            archive.filelist.append(again)
    with pytest.raises(DamagedFile, match=r"boom.npz .* claim to be larger than the file"):
        from_bytes(buffer.getvalue(), "boom.npz")


class Bomb:
    """Object that writes a file when it is unpickled."""

    def __init__(self, target: Path) -> None:
        self._target = target

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.write_text, (self._target, "boom")


def test_pickle_in_a_file_is_refused_and_not_executed(tmp_path: Path) -> None:
    target = tmp_path / "boom"
    data = npz({**members(), "agent.q": np.array([Bomb(target)], object)})
    with pytest.raises(DamagedFile, match=r"worn.npz is not a Q-table"):
        from_bytes(data, "worn.npz")

    assert not target.exists()


@pytest.mark.parametrize("version", [1, 3])
def test_another_format_is_refused_with_the_supported_one(version: int) -> None:
    data = to_bytes(Checkpoint({**TABLE.meta, "format": version}, TABLE.arrays))
    with pytest.raises(OtherFormat, match=rf"q\.npz has format {version}; this version reads 2"):
        from_bytes(data, "q.npz")


@pytest.mark.parametrize("state", ["", "[]", "{}", '{"bit_generator": "MT19937"}', 3])
def test_invalid_generator_state_is_refused(state: object) -> None:
    checkpoint = Checkpoint({**TABLE.meta, "rng": state}, TABLE.arrays)
    learner = build_learner(CONFIG)
    with pytest.raises(DamagedFile, match="does not hold its generator's state"):
        continue_from(learner.walker.agent, learner.rng, checkpoint)


def test_invalid_table_in_a_well_formed_file_is_refused() -> None:
    huge = Checkpoint(TABLE.meta, {**TABLE.arrays, "agent.shape": np.array([10**9, 5])})
    with pytest.raises(TableMismatch, match="this problem's"):
        table_of(huge)
