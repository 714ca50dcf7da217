"""Repeats the experiment of the paper and writes its figures and captions: `make paper-results`.

Nothing of a result is typed: captions come from `hexapods figure`, with the statistics in them.
"""

import io
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import NamedTuple

PAPER = Path(__file__).parent
RESULTS = PAPER / "results"
FIGURES = PAPER / "figures"
SWEEP = (
    *("sweep", "--agent", "q-learning", "--gait", "left-right-origin"),
    *("--observation", "measured,commanded", "--alpha", "0.05,0.3", "--steps", "500"),
    *("--seeds", "30", "--seed", "0"),
)
"""The experiment, as arguments of `hexapods`: thirty seeds of each of four settings."""
_BLOCK = re.compile(r"(?<=<!-- computed -->\n).*?(?=<!-- end -->)", re.DOTALL)
_SETTING = "left-right-origin/{}/stiff/q-learning/500"


class Figure(NamedTuple):
    """A figure of the paper: two settings, compared.

    Attributes:
        name: of its files, and of its label in the text.
        title: first sentence of its caption.
        settings: keys of the settings.
    """

    name: str
    title: str
    settings: tuple[str, str]


PAPER_FIGURES = (
    Figure(
        "observation",
        "How the state is read.",
        (_SETTING.format("measured"), _SETTING.format("commanded")),
    ),
    Figure(
        "alpha",
        "The learning rate.",
        (f"{_SETTING.format('measured')}/alpha=0.05", _SETTING.format("measured")),
    ),
)


def hexapods(*arguments: str | Path) -> None:
    """Run a command of Racing Hexapods, which must succeed."""
    subprocess.run([sys.executable, "-m", "hexapods", *arguments], check=True)


def draw(figure: Figure, results: Path, folder: Path) -> dict[str, bytes]:
    """Return the files of a figure by their names: pictures, caption, data, statistics.

    Args:
        figure: what is drawn.
        results: folder of the experiment.
        folder: for the archive.
    """
    archive = folder / f"{figure.name}.zip"
    shown = [argument for key in figure.settings for argument in ("--setting", key)]
    look = ("--kind", "comparison", "--columns", "2", "--unit", "greedy")
    hexapods("figure", results, *look, *shown, "--out", archive)
    with zipfile.ZipFile(io.BytesIO(archive.read_bytes())) as files:
        return {name: files.read(name) for name in files.namelist()}


def block(captions: dict[str, str]) -> str:
    """Return the Markdown of the figures.

    Args:
        captions: by the figures' names.
    """
    paragraphs = [
        f"![{figure.title} {captions[figure.name]}\\label{{fig:{figure.name}}}]"
        f"(figures/{figure.name}.png){{width=100%}}\n"
        for figure in PAPER_FIGURES
    ]
    return "\n" + "\n".join(paragraphs) + "\n"


def with_block(paper: str, text: str) -> str:
    """Return the paper with a text in place of what was computed before."""
    if not _BLOCK.search(paper):
        raise ValueError("paper.md has no line <!-- computed -->, or none <!-- end --> after it")
    return _BLOCK.sub(lambda _: text, paper)


def main() -> None:
    """Run what is not there of the experiment, draw, and write into the paper."""
    hexapods(*SWEEP, "--out", RESULTS)
    FIGURES.mkdir(exist_ok=True)
    captions = {}
    for figure in PAPER_FIGURES:
        files = draw(figure, RESULTS, FIGURES)
        (FIGURES / f"{figure.name}.zip").unlink()
        (FIGURES / f"{figure.name}.png").write_bytes(files["figure.png"])
        (FIGURES / f"{figure.name}.csv").write_bytes(files["statistics.csv"])
        captions[figure.name] = files["caption.txt"].decode().strip()
    paper = PAPER / "paper.md"
    paper.write_text(with_block(paper.read_text("utf-8"), block(captions)), "utf-8")


if __name__ == "__main__":
    main()
