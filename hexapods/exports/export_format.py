"""Declaration of an export format, and the arguments of its function."""

import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import DeclaredSetting, declared_fields
from hexapods.exports.options import ExportOptions
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.extras import install_command, is_installed
from hexapods.runs.clocks import CLOCK_SENTENCES, Clock
from hexapods.shows.replay import ReplayView
from hexapods.version import __version__

Load = Literal["stream", "encode", "render"]
"""Cost of an export for a server.

- `stream`: little; it is computed chunk by chunk while a client reads it.
- `encode`: seconds to minutes before its first byte.
- `render`: minutes of all cores, so only operators may have one, one at a time.
"""
WriteFile = Callable[[Callable[[Path], None], str], bytes]
"""Calls a function that writes a file, which has a given name, and returns the file's content."""


class StagePicture(NamedTuple):
    """A picture of a moment of a run, as `hexapods.exports.stage_picture` draws it."""

    png: bytes
    description: str
    """The moment, names and distances, for who does not see it."""


class EncodedReplay(NamedTuple):
    """The encoded frames of a run; `hexapods.drawing.replay_encoding` has their form."""

    plan: ReplayView
    scene: Callable[[], bytes]
    segment: Callable[[int, int], bytes]
    """Returns a segment, by its level and number."""
    picture: Callable[[], StagePicture]
    """Returns a picture of the end of the run."""


@dataclass(frozen=True)
class ExportSource:
    """A run that has ended, from which exports are made.

    Attributes:
        run_id: id of the run.
        title: title of the run.
        walks: returns the recorded walks of the run. Called again for each chunk of a long file.
        replay: returns the frames of the run, of a race as timed by a clock.
    """

    run_id: str
    title: str
    walks: Callable[[], RecordedWalks]
    replay: Callable[[Clock], EncodedReplay]

    def about(self, clock: Clock) -> dict[str, str]:
        """Return what a file's metadata say: its run, its clock, and what wrote it."""
        name = self.walks().clock_of(clock)
        return {
            "run": self.run_id,
            "title": self.title,
            "clock": name,
            "time": CLOCK_SENTENCES[name],
            "written_by": f"Racing Hexapods {__version__}",
        }


def _write_here(write: Callable[[Path], None], name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / name
        write(file)
        return file.read_bytes()


@dataclass(frozen=True)
class Execution:
    """Limits of an export, and the process that writes it; by default this one without limits.

    Attributes:
        max_frames: maximum number of recorded frames, or pictures; None for that of the format.
        check: raises once the file is no longer needed; called between the parts of long work.
        write_file: calls a function that writes a file, possibly in another process.
    """

    max_frames: int | None = None
    check: Callable[[], None] = lambda: None
    write_file: WriteFile = _write_here


@dataclass(frozen=True)
class FileType:
    """A type of file that a format has.

    Attributes:
        ending: ending of the file's name, without the point; the value of `format` in a request.
        title: label of its download.
        media_type: media type of an answer with the file.
        extra: name in `[project.optional-dependencies]`, if it needs one.
    """

    ending: str
    title: str
    media_type: str
    extra: str | None = None

    @property
    def install(self) -> str | None:
        """The command that installs the missing extra; None if nothing is missing."""
        return (
            None if self.extra is None or is_installed(self.extra) else install_command(self.extra)
        )


NO_METADATA: Mapping[str, str] = MappingProxyType({})
IN_PROCESS = Execution()
"""Without limits, in this process."""

Write = Callable[[ExportSource, FileType, Any, Execution], Iterable[bytes] | Iterable[str]]
"""Yields a file in chunks; all that can be refused is refused at the call."""


@dataclass(frozen=True, kw_only=True)
class ExportFormat:
    """An export format, as the registry declares it.

    Attributes:
        title: name of the files, to follow "Export".
        files: the types of file, the default first.
        write: writes a file.
        note: further sentences for the description of its route.
        options: declaration of its options.
        flags: shorter names of options on the command line.
        load: cost of an export for a server.
        max_served_frames: see `Execution.max_frames`, over REST.
    """

    title: str
    files: tuple[FileType, ...]
    write: Write
    note: str
    options: type[ExportOptions] = ExportOptions
    flags: Mapping[str, str] = field(default_factory=dict)
    load: Load = "stream"
    max_served_frames: int | None = None

    @property
    def settings(self) -> Mapping[str, DeclaredSetting]:
        """Its options, by name."""
        return declared_fields(self.options)  # type: ignore[arg-type]  # as of any class

    @property
    def method(self) -> Literal["GET", "POST"]:
        """The method of its route; what only operators may have is no GET."""
        return "POST" if self.load == "render" else "GET"

    def address(self, name: str, file: FileType) -> str:
        """Return the address of a type of file below that of a run; `name` is the format's."""
        return name if len(self.files) == 1 else f"{name}?format={file.ending}"

    @property
    def endings(self) -> tuple[str, ...]:
        """The endings of its types of file."""
        return tuple(file.ending for file in self.files)

    def file(self, ending: str) -> FileType:
        """Return the type of file with an ending.

        Raises:
            InvalidInput: if there is none.
        """
        for file in self.files:
            if file.ending == ending:
                return file
        valid = " or ".join(f".{name}" for name in self.endings)
        raise InvalidInput(f"the name of the file must end with {valid}")


def as_bytes(chunks: Iterable[bytes] | Iterable[str]) -> Iterator[bytes]:
    """Yield chunks of a file as bytes; text as UTF-8."""
    for chunk in chunks:
        yield chunk.encode() if isinstance(chunk, str) else chunk
