"""Assemble the explanatory text of a report from an experiment's summary."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hexapods.domain.text import counted
from hexapods.experiments.claims.cases import Case, cases_of
from hexapods.experiments.failures import failures_text
from hexapods.experiments.narrative.figure4 import FIGURE4_NARRATIVE
from hexapods.experiments.narrative.sweep import SWEEP_NARRATIVE
from hexapods.experiments.narrative.table1 import TABLE1_NARRATIVE
from hexapods.experiments.presets import Preset

Paragraph = Callable[[Sequence[Case]], str | None]
FEW_SEEDS = 10
NARRATIVES: Mapping[str, Sequence[tuple[str, Paragraph]]] = {
    "table1": TABLE1_NARRATIVE,
    "figure4": FIGURE4_NARRATIVE,
    "sweep": SWEEP_NARRATIVE,
}
"""Paragraphs with their headings, by the name that presets refer to."""


def narrate(summary: Mapping[str, Any], preset: Preset) -> list[dict[str, str]]:
    """Return texts with headings, one paragraph per line.

    Texts whose trials are not complete yet are omitted.
    """
    cases = cases_of(summary)
    paragraphs = NARRATIVES[preset.narrative] if preset.narrative else ()
    written = [(heading, write(cases)) for heading, write in paragraphs]
    texts = [{"heading": heading, "text": text} for heading, text in written if text]
    caution = _caution(summary, preset)
    return [*texts, {"heading": "Uncertainty", "text": caution}] if texts else []


def _caution(summary: Mapping[str, Any], preset: Preset) -> str:
    trials, config = summary["trials"], summary["config"]
    sentences = [
        "A number in brackets after a value is its 95 % interval: from other seeds, the value "
        "would mostly fall in there. Where such an interval leaves a question open, this report "
        "says “not established” and not what looks likely."
    ]
    if preset.is_published:
        sentences.append(
            "The intervals know of our seeds only. A printed value is one run, and nobody knows "
            "which robot, servos and reading made it."
        )
    if config["seeds"] < FEW_SEEDS:
        sentences.append(
            f"{counted(config['seeds'], 'seed')} a setting is few: the intervals are rough, and "
            "often too narrow. Thirty are the default."
        )
    if config["simulator"] == "kinematic":
        sentences.append(
            "These are runs of the kinematic simulator: feet never slip, servos are never soft, "
            "and all gaits and robots walk alike. What depends on physics needs MuJoCo."
        )
    succeeded = trials["done"] + len(trials["set_aside"]) - trials["failed"]
    if succeeded < trials["total"]:
        # Count the trials of this summary: since it was written, more may have been done.
        why = f": {failures_text(trials)}" if trials["failed"] else ""
        sentences.append(
            f"What is said here is of {succeeded:,} of {trials['total']:,} trials{why}."
        )
    return " ".join(sentences)
