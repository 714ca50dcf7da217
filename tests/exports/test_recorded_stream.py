"""Export of a race as a `.viser` file."""

import msgspec
import pytest
import viser
import zstandard

from app.jobs.stopping import Stopping
from app.stage.playback import original_of
from app.storage.errors import Busy
from hexapods.exports.recorded_stream import MAX_LENGTH_S, recorded_stream
from hexapods.runs.race_config import Branch, RaceConfig
from tests.stage.stage_parts import StageParts


def decoded_header(data: bytes) -> dict[str, object]:
    """Decode the msgpack in front of the arrays, as viser's player does."""
    inner = zstandard.ZstdDecompressor().decompressobj().decompress(data[8:])
    size = int.from_bytes(inner[:8], "little")
    body: dict[str, object] = msgspec.msgpack.decode(inner[8 : 8 + size])
    return body


def node_names(data: bytes) -> set[str]:
    """Return the names of all scene nodes in a file."""
    messages = decoded_header(data)["messages"]
    assert isinstance(messages, list)
    return {message.get("name", "") for _, message in messages}


def test_a_server_that_stops_renders_no_more(parts: StageParts) -> None:
    run, stopping = parts.finished_race(steps=6), Stopping()
    assert isinstance(run.config, RaceConfig)
    stopping.set()
    with pytest.raises(Busy, match="stopping"):
        recorded_stream(run.config, parts.recordings.race(run.id) or [], check=stopping.check)


def test_file_has_the_whole_race_and_visers_version(parts: StageParts) -> None:
    run = parts.finished_race(steps=6)
    assert isinstance(run.config, RaceConfig)
    lanes = parts.recordings.race(run.id) or []

    data = recorded_stream(run.config, lanes)
    header = decoded_header(data)

    assert header["viserVersion"] == viser.__version__
    assert header["durationSeconds"] == pytest.approx(3 + 5.8, abs=2.5)
    assert len(data) < 1_000_000
    messages = header["messages"]
    assert isinstance(messages, list)
    texts = [m["updates"]["text"] for _, m in messages if "text" in m.get("updates", {})]
    assert any(text.endswith("done") for text in texts)


def test_recorded_stream_of_a_branch_has_the_original_as_ghosts(parts: StageParts) -> None:
    original = parts.finished_race(("greedy",), steps=3)
    run = parts.finished_race(("q-learning",), steps=3, branch_from=Branch(original.id, 1))
    config, lanes = run.config, parts.recordings.race(run.id) or []
    assert isinstance(config, RaceConfig)

    with_ghosts = recorded_stream(
        config, lanes, original=original_of(config, parts.store, parts.recordings)
    )

    assert "/world/run/ghost-robots/0" in node_names(with_ghosts)
    assert "/world/run/ghost-robots/0" not in node_names(recorded_stream(config, lanes))


def test_long_race_is_played_faster(parts: StageParts) -> None:
    run = parts.finished_race(("two-step",), steps=150)
    assert isinstance(run.config, RaceConfig)

    data = recorded_stream(run.config, parts.recordings.race(run.id) or [])
    length_s = decoded_header(data)["durationSeconds"]

    assert isinstance(length_s, float)
    assert length_s < MAX_LENGTH_S + 10
