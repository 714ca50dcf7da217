"""What is missing before this version can be published: `make release-missing TAG=v0.3.0`."""

import re
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parent.parent
_HEADING = re.compile(r"^## \[(?P<name>.*?)\](?: - (?P<day>\S+))?$", re.MULTILINE)
_VERSION = re.compile(r'^__version__ = "(.*)"$', re.MULTILINE)
_BASE_IMAGE = re.compile(r"^FROM (\S+)", re.MULTILINE)
_WITH_DIGEST = re.compile(r".+@sha256:[0-9a-f]{64}")


def missing(root: Path, tag: str | None = None) -> Iterator[str]:
    """Yield a sentence on each thing that must be done first.

    Args:
        root: folder of the repository.
        tag: that is to be published; None if it is not set yet.
    """
    text = {
        name: (root / name).read_text("utf-8")
        for name in ("CHANGELOG.md", "CITATION.cff", "Dockerfile", "hexapods/version.py")
    }
    version = _declared_version(text["hexapods/version.py"])
    if tag is not None and tag != f"v{version}":
        yield f"The tag is {tag}, but hexapods/version.py declares {version}: tag it v{version}."
    yield from _missing_in_changelog(text["CHANGELOG.md"], version)
    citation = import_module("yaml").safe_load(text["CITATION.cff"])
    if citation.get("version") != version:
        yield f"CITATION.cff has version {citation.get('version')}, not {version}."
    if not citation.get("repository-code"):
        yield (
            "No address of the repository is stated: add the line `repository-code: "
            '"https://HOST/OWNER/NAME"` to CITATION.cff.'
        )
    for image in dict.fromkeys(_BASE_IMAGE.findall(text["Dockerfile"])):
        if not _WITH_DIGEST.fullmatch(image):
            yield (
                f"The Dockerfile's base image {image} has no digest: put `@` after it, and what "
                f"`docker buildx imagetools inspect {image} --format '{{{{.Manifest.Digest}}}}'` "
                "prints."
            )


def _declared_version(module: str) -> str:
    match = _VERSION.search(module)
    if match is None:
        raise ValueError("hexapods/version.py declares no __version__")
    return match[1]


def _missing_in_changelog(changelog: str, version: str) -> Iterator[str]:
    headings = list(_HEADING.finditer(changelog))
    names = [heading["name"] for heading in headings]
    if names[:2] != ["Unreleased", version] or headings[1]["day"] is None:
        yield (
            f"CHANGELOG.md must begin with [Unreleased] and then [{version}] with its date; "
            f"it begins with {', '.join(names[:2]) or 'no version'}."
        )
    elif "\n- " in changelog[headings[0].end() : headings[1].start()]:
        yield (
            "CHANGELOG.md has changes below [Unreleased]: move them below a new version, and "
            "declare that in hexapods/version.py and CITATION.cff."
        )


def main() -> int:
    """Print what is missing, and return 1 if anything is."""
    sentences = list(missing(ROOT, *sys.argv[1:2]))
    for sentence in sentences:
        print(f"Missing: {sentence}")
    if not sentences:
        print("Nothing is missing: set the tag and push it, as docs/releasing.md says.")
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main())
