"""Result of an experiment, as answers, archives and the database have it."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import MaxLen

from hexapods.runs.results import Count

Name = Annotated[str, MaxLen(100)]


@dataclass(frozen=True, kw_only=True)
class TrialCounts:
    """Number of trials by outcome; `failed` are all without a distance, `set_aside` among them."""

    done: Count
    total: Count
    failed: Count
    set_aside: Count


@dataclass(frozen=True, kw_only=True)
class ClaimVerdict:
    """Verdict on one of the paper's claims."""

    id: Name
    verdict: Literal["holds", "does not hold", "not established", "depends"]


@dataclass(frozen=True, kw_only=True)
class ExperimentResult:
    """Result of an experiment; `files` are those of its report.

    `shared_machine`: whether other runs computed beside it, which slows what is timed. `finding`:
    what came of it, in a sentence; empty where its claims say it.
    """

    trials: TrialCounts
    claims: Annotated[tuple[ClaimVerdict, ...], MaxLen(1_000)]
    files: Annotated[tuple[Name, ...], MaxLen(128)]
    shared_machine: bool = False
    finding: Annotated[str, MaxLen(1_000)] = ""
