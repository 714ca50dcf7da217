"""A figure as files: pictures, caption, data as CSV, and the command that repeats it."""

import csv
import io
import os
import shlex
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hexapods.domain.errors import InvalidInput
from hexapods.domain.short_repr import short_repr
from hexapods.domain.text import text_cell
from hexapods.experiments.figures.caption import caption_of
from hexapods.experiments.figures.config import FigureConfig
from hexapods.experiments.figures.content import FigureContent, content_of
from hexapods.experiments.figures.drawing import ENDINGS, draw
from hexapods.experiments.report.command import command as experiment_command
from hexapods.files import path_of, write_atomically

ARCHIVE = "zip"
FILE_ENDINGS = (ARCHIVE, *ENDINGS)
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""Of all members, so that the same figure is the same archive."""
_COMMAND = """\
# Repeats the experiment, then the figure. The same versions give the same numbers.
{experiment} --out {folder}
{figure}
"""


@dataclass(frozen=True)
class PaperFigure:
    """A figure for a paper.

    Attributes:
        pictures: by ending: `pdf`, `svg` and `png`.
        caption: its text.
        data: every seed of it as CSV.
        statistics: the numbers that are drawn as CSV: interquartile means with their intervals,
            and a difference, or performance profiles.
        command: lines of a shell that repeat it.
    """

    __repr__ = short_repr

    pictures: Mapping[str, bytes]
    caption: str
    data: str
    statistics: str
    command: str

    @property
    def files(self) -> dict[str, bytes]:
        """All files by name."""
        return {
            **{f"figure.{ending}": picture for ending, picture in self.pictures.items()},
            "caption.txt": self.caption.encode(),
            "data.csv": self.data.encode(),
            "statistics.csv": self.statistics.encode(),
            "command.sh": self.command.encode(),
        }

    def to_bytes(self, ending: str = ARCHIVE) -> bytes:
        """Return the picture of an ending, or with `zip` all files in an archive.

        Raises:
            InvalidInput: if there is no such file.
        """
        if ending in self.pictures:
            return self.pictures[ending]
        if ending != ARCHIVE:
            raise InvalidInput(
                f"a figure is saved as one of {', '.join(f'.{name}' for name in FILE_ENDINGS)}, "
                f"not {f'.{ending}' if ending else 'a name without an ending'}"
            )
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in self.files.items():
                archive.writestr(zipfile.ZipInfo(name, _ZIP_DATE), content, zipfile.ZIP_DEFLATED)
        return out.getvalue()

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the picture that a path's ending names, or with `.zip` all files.

        Returns:
            the path.

        Raises:
            InvalidInput: if the ending is none of `.zip`, `.pdf`, `.svg` and `.png`.
            OSError: if the file cannot be written.
        """
        target = path_of(path, "a file")
        write_atomically(target, self.to_bytes(target.suffix.removeprefix(".").lower()))
        return target

    def _repr_png_(self) -> bytes:
        return self.pictures["png"]


def paper_figure(summary: Mapping[str, Any], config: FigureConfig) -> PaperFigure:
    """Return a figure of an experiment; the same summary and versions give the same bytes.

    Args:
        summary: of the experiment.
        config: of the figure.

    Raises:
        MissingExtra: if Matplotlib is not installed.
        UnknownName, InvalidInput: if settings are unknown, too many, or without a distance.
    """
    content = content_of(summary, config)
    return PaperFigure(
        draw(content), caption_of(content), _data(content), _statistics(content), _command(content)
    )


def _command(content: FigureContent) -> str:
    config, keys = content.config, [row.entry["key"] for row in content.rows]
    folder = f"{content.summary['experiment']}-results"
    words = ["hexapods", "figure", folder, "--kind", config.kind, "--columns", str(config.columns)]
    for name, usual in (("distance", "total"), ("unit", "m")):
        if getattr(config, name) != usual:
            words += [f"--{name}", getattr(config, name)]
    if config.settings:
        words += [word for key in keys for word in ("--setting", key)]
    figure = shlex.join([*words, "--out", "figure.zip"])
    experiment = experiment_command(content.summary["config"])
    return _COMMAND.format(experiment=experiment, folder=folder, figure=figure)


def _data(content: FigureContent) -> str:
    rows = [
        (row.entry["key"], row.group.name, number, point)
        for row in content.rows
        for number, point in zip(
            row.numbers or [None] * len(row.group.points), row.group.points, strict=True
        )
    ]
    return _csv(("setting", "name", "seed_number", _column(content)), rows)


def _column(content: FigureContent) -> str:
    unit = {"m": "m", "h": "half_grid_sides", "greedy": "share_of_greedy"}[content.config.unit]
    return f"{content.config.distance}_distance_{unit}"


def _statistics(content: FigureContent) -> str:
    column = _column(content)
    if content.config.kind == "profile":
        steps = [
            (row.entry["key"], profile.name, *step)
            for row, profile in zip(content.rows, content.profiles, strict=True)
            for step in zip(profile.at, profile.share, profile.low, profile.high, strict=True)
        ]
        head = ("setting", "name", f"at_least_{column}", "share", "low", "high")
        return _csv(head, steps)
    rows: list[tuple[Any, ...]] = [
        (row.entry["key"], row.group.name, len(row.group.points), *row.typical)
        for row in content.rows
    ]
    comparison = content.comparison
    if comparison is not None:
        name = f"{comparison.a.name} minus {comparison.b.name}"
        rows.append(("difference", name, None, *comparison.difference))
        chance = f"{comparison.a.name} over {comparison.b.name}"
        rows.append(("probability of improvement", chance, None, *comparison.improvement))
    return _csv(("setting", "name", "seeds", f"iqm_{column}", "low", "high"), rows)


def _csv(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow(head)
    for row in rows:
        writer.writerow(text_cell(value) if isinstance(value, str) else value for value in row)
    return out.getvalue()
