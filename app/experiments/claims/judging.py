"""Which of the paper's claims hold over many seeds, as far as the intervals say."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple

from app.experiments.claims.cases import Case, cases
from app.experiments.formatting import listed
from app.experiments.statistics import Verdict

Judgement = Literal["holds", "does not hold", "not established", "depends"]
"""`depends`: one thing in one case, another in another."""
_AS_JUDGEMENT: Mapping[Verdict, Judgement] = {
    "yes": "holds",
    "no": "does not hold",
    "not established": "not established",
}

_SAID: Mapping[Judgement, str] = {
    "holds": "holds",
    "does not hold": "does not hold",
    "not established": "is not established",
    "depends": "depends",
}


class Finding(NamedTuple):
    """What one case says of a claim."""

    verdict: Judgement
    evidence: str

    @classmethod
    def of(cls, verdict: Verdict, evidence: str) -> "Finding":
        """Where a claim is that a number is over its threshold."""
        return cls(_AS_JUDGEMENT[verdict], evidence)


class Claim(NamedTuple):
    """Something that the paper says.

    Attributes:
        id: for links.
        claim: the paper's words, and where they stand.
        criterion: what we take them to mean, so that a number can decide.
        find: None where the case has no trials that could answer.
    """

    id: str
    claim: str
    criterion: str
    find: Callable[[Case], Finding | None]


def judge(summary: Mapping[str, Any], claims: Sequence[Claim]) -> list[dict[str, Any]]:
    """Every claim that these trials can answer, over all cases and in each.

    Where the cases disagree it depends, since the paper does not say which of them is its own;
    the evidence then says where what holds.
    """
    places = cases(summary)
    judged = []
    for one in claims:
        found = [(case, one.find(case)) for case in places]
        where = [(case, finding) for case, finding in found if finding is not None]
        if where:
            judged.append(_judged(one, where))
    return judged


def _judged(claim: Claim, where: Sequence[tuple[Case, Finding]]) -> dict[str, Any]:
    verdicts = {finding.verdict for _, finding in where}
    overall = verdicts.pop() if len(verdicts) == 1 else "depends"
    return {
        "id": claim.id,
        "claim": claim.claim,
        "criterion": claim.criterion,
        "verdict": overall,
        "evidence": _together(where),
        "where": [
            {
                "observation": case.observation,
                "robot": case.robot,
                "label": case.label,
                **finding._asdict(),
            }
            for case, finding in where
        ],
    }


def _together(where: Sequence[tuple[Case, Finding]]) -> str:
    """One or two sentences for all cases: the numbers if they agree, else who says what."""
    said: dict[Judgement, list[str]] = {}
    for case, finding in where:
        said.setdefault(finding.verdict, []).append(case.label)
    first, finding = where[0]
    if len(said) > 1:
        parts = (f"{_SAID[verdict]} with {listed(labels)}" for verdict, labels in said.items())
        return f"It depends: it {'; it '.join(parts)}."
    if len(where) == 1:
        return finding.evidence
    cases = "both" if len(where) == 2 else f"all {len(where)}"
    return f"The same in {cases} cases. With {first.label}: {finding.evidence}"
