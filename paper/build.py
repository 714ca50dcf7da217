"""Builds the paper as HTML and PDF, with its references: `make paper`.

The journal builds it anew from the same files, in its own layout.
"""

import re
import subprocess
import sys
from pathlib import Path

import pypandoc
import typst

PAPER = Path(__file__).parent
_LABEL = re.compile(r"\\label\{(fig:\w+)\}")
_REFERENCE = re.compile(r"\\autoref\{(fig:\w+)\}")


def with_numbers(text: str, *, has_captions_numbered: bool) -> str:
    """Return the paper with numbers of figures in place of LaTeX's labels and references.

    Args:
        text: of the paper, in Pandoc's Markdown.
        has_captions_numbered: whether what it is written as numbers captions by itself.

    Raises:
        ValueError: if a reference leads to no figure.
    """
    numbers = {label: number for number, label in enumerate(_LABEL.findall(text), 1)}
    unknown = sorted(set(_REFERENCE.findall(text)) - numbers.keys())
    if unknown:
        raise ValueError(f"no figure has the label {', '.join(unknown)}; there are {[*numbers]}")
    if has_captions_numbered:
        text = _LABEL.sub("", text)
    for label, number in numbers.items():
        text = re.sub(
            rf"!\[([^]]*)\\label\{{{label}\}}", rf"![Figure {number}. \1", text, flags=re.DOTALL
        )
    return _REFERENCE.sub(lambda match: f"Figure {numbers[match[1]]}", text)


def build(folder: Path) -> tuple[Path, Path]:
    """Write the paper into a folder, and return its HTML and its PDF.

    Raises:
        subprocess.CalledProcessError: if a citation, a picture or the text is not as it must be.
        ValueError: if a reference leads to no figure.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = (PAPER / "paper.md").read_text("utf-8")
    html, source, pdf = (folder / f"paper.{ending}" for ending in ("html", "typ", "pdf"))
    pandoc = [pypandoc.get_pandoc_path(), "--from", "markdown", "--citeproc", "--standalone"]
    pandoc += ["--fail-if-warnings", "--resource-path", str(PAPER)]
    pandoc += ["--bibliography", str(PAPER / "paper.bib")]
    for is_typst, options in (
        (False, ("--embed-resources", "--to", "html5", "--output", html)),
        (True, ("--to", "typst", "--output", source)),
    ):
        shown = with_numbers(text, has_captions_numbered=is_typst)
        subprocess.run([*pandoc, *options], input=shown, text=True, check=True, cwd=PAPER)
    # Pictures are named from the folder of the paper, which is the compiler's root too.
    written = source.read_text("utf-8").replace('image("', 'image("/')
    beside = PAPER / ".paper.typ"
    beside.write_text(written, "utf-8")
    try:
        typst.compile(beside, output=pdf, root=PAPER)
    finally:
        beside.unlink()
    source.unlink()
    return html, pdf


def main() -> None:
    """Write the paper into build/paper."""
    for file in build(PAPER.parent / "build" / "paper"):
        print(f"The paper is in {file} ({file.stat().st_size // 1000} kB).")


if __name__ == "__main__":
    sys.exit(main())
