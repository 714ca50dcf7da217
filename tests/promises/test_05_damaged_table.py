"""Promise 5: a damaged Q-table is refused, in full: 1,000 bit flips and truncations.

A stored table is verified against its SHA-256 in the database, so that damage to any byte is
detected.
"""

import random
from pathlib import Path

import pytest

from app.storage.run import TABLE
from app.storage.stored_tables import load_table
from hexapods.assembly import build_learner
from hexapods.domain.errors import DamagedFile
from hexapods.runs.config import training_config
from hexapods.runs.tables import from_bytes, snapshot, to_bytes
from hexapods.runs.training import train
from tests.storage.stores import opened, training

pytestmark = pytest.mark.test

DAMAGES = 1000


def make_table() -> bytes:
    config = training_config(gait="left-right-origin", simulator="kinematic", steps=50)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    return to_bytes(snapshot(learner, config))


def damage(data: bytes, chance: random.Random) -> bytes:
    """Return the data with one bit flipped, or truncated."""
    if chance.random() < 0.5:
        return data[: chance.randrange(len(data))]
    flipped = bytearray(data)
    flipped[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return bytes(flipped)


def test_a_damaged_stored_table_is_always_refused_by_name(tmp_path: Path) -> None:
    chance, table = random.Random(5), make_table()
    with opened(tmp_path, None) as store:
        store.create(training("a", state="finished"))
        store.put_artifact("a", TABLE, table)
        (file,) = (path for path in tmp_path.glob("artifacts/*/*") if path.is_file())
        for _ in range(DAMAGES):
            file.write_bytes(damage(table, chance))
            with pytest.raises(DamagedFile) as error:
                load_table(store, "a")
            assert TABLE in str(error.value)
            assert "run a" in str(error.value)
        file.write_bytes(table)
        assert load_table(store, "a").meta["step"] == 50


def test_a_damaged_imported_table_is_refused_or_reads_the_written_values() -> None:
    """Without a stored hash, damage that the file's own checksums miss must not change a value."""
    chance, table = random.Random(6), make_table()
    whole = from_bytes(table, "it")
    refused = 0
    for _ in range(DAMAGES):
        try:
            read = from_bytes(damage(table, chance), "q.npz")
        except DamagedFile:
            refused += 1
        else:
            assert read.meta == whole.meta
            assert read.arrays.keys() == whole.arrays.keys()
            assert all((read.arrays[k].tobytes() == a.tobytes()) for k, a in whole.arrays.items())
    assert refused > 0.9 * DAMAGES
