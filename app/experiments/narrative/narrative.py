"""What the numbers show, in words for the reader; every number is of this run."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from app.experiments.claims.cases import Case, cases
from app.experiments.formatting import counted, listed
from app.experiments.narrative.figure4 import FIGURE4_STORY
from app.experiments.narrative.sweep import SWEEP_STORY
from app.experiments.narrative.table1 import TABLE1_STORY

Telling = Callable[[Sequence[Case]], str | None]
FEW = 10
_STORIES: Mapping[str, Sequence[tuple[str, Telling]]] = {
    "table1": TABLE1_STORY,
    "figure4": FIGURE4_STORY,
    "sweep": SWEEP_STORY,
}


def tell(summary: Mapping[str, Any]) -> list[dict[str, str]]:
    """A few short texts under headings, a paragraph a line; what cannot be said yet is left out."""
    places = cases(summary)
    told = [(heading, telling(places)) for heading, telling in _STORIES[summary["experiment"]]]
    texts = [{"heading": heading, "text": text} for heading, text in told if text]
    caution = _caution(summary)
    return [*texts, {"heading": "How sure this is", "text": caution}] if texts else []


def _caution(summary: Mapping[str, Any]) -> str:
    trials, config = summary["trials"], summary["config"]
    said = [
        "A number in brackets after a value is its 95 % interval: from other seeds, the value "
        "would mostly fall in there. Where such an interval leaves a question open, this report "
        "says “not established” and not what looks likely."
    ]
    if summary["experiment"] == "table1":
        said.append(
            "The intervals know of our seeds only. A printed value is one run, and nobody knows "
            "which robot, servos and reading made it."
        )
    if config["seeds"] < FEW:
        said.append(
            f"{counted(config['seeds'], 'seed')} a setting is few: the intervals are rough, and "
            "often too narrow. Thirty are the default."
        )
    if config["simulator"] == "kinematic":
        said.append(
            "These are runs of the kinematic simulator: feet never slip, servos are never soft, "
            "and all gaits and robots walk alike. What depends on physics needs MuJoCo."
        )
    left = trials["total"] - trials["done"] - len(trials["set_aside"])
    missing = [
        counted(number, one, many)
        for number, one, many in (
            (left, "trial is missing", "trials are missing"),
            (trials["failed"], "trial failed", "trials failed"),
            (len(trials["set_aside"]), "trial was set aside", "trials were set aside"),
        )
        if number > 0
    ]
    if missing:
        said.append(f"{listed(missing)}; what is said here is of the others.")
    return " ".join(said)
