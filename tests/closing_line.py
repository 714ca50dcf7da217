"""Print the sum of several test runs as pytest's closing line, from their JUnit files.

Needs no environment: `.ci/run` calls it after whatever has failed.
"""

import sys
from collections import Counter
from collections.abc import Iterable
from datetime import timedelta
from pathlib import Path
from xml.etree import ElementTree

_WORDS = {"failed": "failed", "passed": "passed", "skipped": "skipped", "error": "errors"}
"""Outcomes in pytest's order, each with its plural."""
_OUTCOMES = {"failure": "failed", "error": "error", "skipped": "skipped"}
"""Of an element below that of a test the outcome."""


def main(files: Iterable[str]) -> int:
    """Print the line; return 1 if a test failed or a file is missing, else 0."""
    outcomes, duration_s = Counter[str](), 0.0
    missing = [file for file in files if not Path(file).is_file()]
    for file in files:
        if file not in missing:
            of_file, file_s = read(Path(file))
            outcomes += of_file
            duration_s += file_s
    for file in missing:
        print(f"{file} is not there: these tests did not run to their end")
    print(closing_line(outcomes, duration_s))
    return 1 if missing or outcomes["failed"] or outcomes["error"] else 0


def read(file: Path) -> tuple[Counter[str], float]:
    """Return how many tests of a JUnit file had each outcome, and how long they took [s]."""
    outcomes, duration_s = Counter[str](), 0.0
    for suite in ElementTree.parse(file).getroot().iter("testsuite"):
        duration_s += float(suite.get("time", 0))
        for case in suite.iter("testcase"):
            tags = [child.tag for child in case if child.tag in _OUTCOMES]
            outcomes.update(_OUTCOMES[tag] for tag in tags)
            outcomes["passed"] += not tags
    return outcomes, duration_s


def closing_line(outcomes: Counter[str], duration_s: float) -> str:
    """Return how many tests had each outcome, and how long it took, as pytest says it."""
    parts = [
        f"{count} {plural if count > 1 else outcome}"
        for outcome, plural in _WORDS.items()
        if (count := outcomes[outcome])
    ]
    time = f"{duration_s:.2f}s"
    if duration_s >= 60:
        time += f" ({timedelta(seconds=int(duration_s))})"
    return f" {', '.join(parts) or 'no tests ran'} in {time} ".center(80, "=")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
