"""The film of a race."""

import msgspec
import pytest
import viser
import zstandard

from app.runs.config import RaceConfig
from app.viewer.recorded_stream import LONGEST_S, recorded_stream
from tests.stage.stage_parts import StageParts


def opened(data: bytes) -> dict[str, object]:
    """What viser's player reads: the msgpack in front of the arrays."""
    inner = zstandard.ZstdDecompressor().decompressobj().decompress(data[8:])
    size = int.from_bytes(inner[:8], "little")
    read: dict[str, object] = msgspec.msgpack.decode(inner[8 : 8 + size])
    return read


def test_it_has_the_whole_race_and_names_its_version() -> None:
    parts = StageParts()
    run = parts.finished_race(steps=6)
    assert isinstance(run.config, RaceConfig)
    lanes = parts.recordings.race(run.id) or []

    data = recorded_stream(run.config, lanes)
    inside = opened(data)

    assert inside["viserVersion"] == viser.__version__
    assert inside["durationSeconds"] == pytest.approx(3 + 5.8, abs=2.5)
    assert len(data) < 1_000_000
    messages = inside["messages"]
    assert isinstance(messages, list)
    texts = [m["updates"]["text"] for _, m in messages if "text" in m.get("updates", {})]
    assert any(text.endswith("done") for text in texts)


def test_a_long_race_is_shown_faster() -> None:
    parts = StageParts()
    run = parts.finished_race(("two-step",), steps=150)
    assert isinstance(run.config, RaceConfig)

    data = recorded_stream(run.config, parts.recordings.race(run.id) or [])
    length_s = opened(data)["durationSeconds"]

    assert isinstance(length_s, float)
    assert length_s < LONGEST_S + 10
