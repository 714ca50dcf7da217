"""Judge the paper's claims over many seeds by their confidence intervals."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple

from hexapods.experiments.claims.cases import Case, cases_of
from hexapods.experiments.formatting import listed
from hexapods.experiments.statistics import Verdict

Judgement = Literal["holds", "does not hold", "not established", "depends"]
"""`depends`: the cases disagree."""
_AS_JUDGEMENT: Mapping[Verdict, Judgement] = {
    "yes": "holds",
    "no": "does not hold",
    "not established": "not established",
}

_PHRASES: Mapping[Judgement, str] = {
    "holds": "holds",
    "does not hold": "does not hold",
    "not established": "is not established",
    "depends": "depends",
}


class CaseFinding(NamedTuple):
    """The verdict on a claim in one case, with its evidence as a sentence."""

    verdict: Judgement
    evidence: str

    @classmethod
    def of(cls, verdict: Verdict, evidence: str) -> "CaseFinding":
        """Build the finding of a claim that a number exceeds its threshold."""
        return cls(_AS_JUDGEMENT[verdict], evidence)


class Claim(NamedTuple):
    """A claim of the paper.

    Attributes:
        id: identifier, for links.
        claim: quotation from the paper with its section.
        criterion: our interpretation as a criterion that a number can decide.
        find: function that judges it in a case; it returns None without the trials for it.
    """

    id: str
    claim: str
    criterion: str
    find: Callable[[Case], CaseFinding | None]


def judge(summary: Mapping[str, Any], claims: Sequence[Claim]) -> list[dict[str, Any]]:
    """Judge every claim for which there are trials, in each case and over all cases.

    Where the cases disagree the overall verdict is `depends`, since the paper does not say which
    case is its own; the evidence then lists the cases by verdict.
    """
    cases = cases_of(summary)
    judged = []
    for claim in claims:
        results = [(case, claim.find(case)) for case in cases]
        findings = [(case, finding) for case, finding in results if finding is not None]
        if findings:
            judged.append(_judged(claim, findings))
    return judged


def _judged(claim: Claim, findings: Sequence[tuple[Case, CaseFinding]]) -> dict[str, Any]:
    verdicts = {finding.verdict for _, finding in findings}
    overall = verdicts.pop() if len(verdicts) == 1 else "depends"
    return {
        "id": claim.id,
        "claim": claim.claim,
        "criterion": claim.criterion,
        "verdict": overall,
        "evidence": _overall_evidence(findings),
        "where": [
            {
                "observation": case.observation,
                "robot": case.robot,
                "label": case.label,
                **finding._asdict(),
            }
            for case, finding in findings
        ],
    }


def _overall_evidence(findings: Sequence[tuple[Case, CaseFinding]]) -> str:
    """Return the evidence over all cases: the numbers if they agree, else the cases by verdict."""
    labels_by_verdict: dict[Judgement, list[str]] = {}
    for case, finding in findings:
        labels_by_verdict.setdefault(finding.verdict, []).append(case.label)
    first, finding = findings[0]
    if len(labels_by_verdict) > 1:
        parts = (
            f"{_PHRASES[verdict]} with {listed(labels)}"
            for verdict, labels in labels_by_verdict.items()
        )
        return f"It depends: it {'; it '.join(parts)}."
    if len(findings) == 1:
        return finding.evidence
    which = "both" if len(findings) == 2 else f"all {len(findings)}"
    return f"The same in {which} cases. With {first.label}: {finding.evidence}"
